/// Keys of the turf: patch, layers, carpet, materials.
#include "core/scene_schema.h"

namespace tuft::schema {
namespace {

constexpr std::string_view element_kinds[] = {"one_point", "fully_integrated"};
constexpr std::string_view hourglass_controls[] = {"stiffness", "viscous"};

void describe_shell_material(KeyVisitor& keys, ShellMaterial& material) {
  keys.quantity(required("young_modulus", "Young's modulus"), material.young_modulus, "Pa", positive);
  keys.number(required("poisson_ratio", "Poisson's ratio"), material.poisson_ratio, {0, 0.5, false, true});
  keys.quantity(required("density", "density of the solid"), material.density, "kg/m^3", positive);
  keys.number(
      {"failure_strain", "largest principal strain (logarithmic) at which a shell fails; 0: none does"},
      material.failure_strain, non_negative);
  keys.list<PronyTerm>(
      {"relaxation", "viscoelastic: parts of the instantaneous shear modulus that relax"},
      material.relaxation, [](KeyVisitor& inside, PronyTerm& term) {
        inside.quantity(required("modulus", "shear modulus of the term"), term.modulus, "Pa", positive);
        inside.quantity(required("decay", "rate at which it relaxes"), term.decay, "Hz", non_negative);
      });
}

void describe_orthotropic(KeyVisitor& keys, ShellMaterial& material) {
  keys.quantity({"across_young_modulus", "orthotropic: Young's modulus across the rows; 0: isotropic"},
                material.across_young_modulus, "Pa", non_negative);
  keys.quantity({"shear_modulus", "orthotropic: shear modulus in the plane"}, material.shear_modulus, "Pa",
                non_negative);
}

void describe_shell_section(KeyVisitor& keys, ShellSection& section) {
  keys.enumeration({"element", "one_point: one point in the plane; fully_integrated: 2 x 2 points"},
                   section.element, element_kinds);
  keys.integer({"thickness_points", "through the thickness; 1: forces and moments, exact for these laws"},
               section.thickness_points, {1, 5, false, false});
  keys.enumeration({"hourglass", "one_point: what resists the modes that its point does not see"},
                   section.hourglass, hourglass_controls);
  keys.number({"hourglass_coefficient",
               "stiffness: over the fully integrated element's; viscous: over critical damping"},
              section.hourglass_coefficient, {0, 1, false, false});
}

constexpr double right_angle = 1.5707963267948966;

/// Tables that stand in place of other keys, and those of effects: there or not.
void describe_continuum_options(KeyVisitor& keys, SoilFoamMaterial& material) {
  keys.optional_table<ExponentialCompression>(
      {"pressure_exponential",
       "virgin compression (modulus/growth) (exp(growth e) - 1), in place of pressure"},
      material.pressure_exponential, [](KeyVisitor& inside, ExponentialCompression& law) {
        inside.quantity(required("modulus", "bulk modulus of first loading at no pressure"), law.modulus,
                        "Pa", positive);
        inside.number(required("growth", "growth of that modulus with pressure"), law.growth, positive);
      });
  keys.optional_table<MohrCoulombStrength>(
      {"mohr_coulomb",
       "yield surface by cohesion and friction angle, in place of yield_a0, yield_a1, yield_a2"},
      material.mohr_coulomb, [](KeyVisitor& inside, MohrCoulombStrength& law) {
        static constexpr std::string_view matches[] = {"pure_shear", "plane_strain", "triaxial_compression"};
        inside.quantity(required("cohesion", "shear strength under no stress"), law.cohesion, "Pa",
                        non_negative);
        inside.quantity(required("friction_angle", "phi"), law.friction_angle, "rad",
                        {0, right_angle, false, true});
        inside.enumeration(
            {"match",
             "where sqrt(J2) = k + alpha p agrees: alpha = tan(phi), 3 tan/sqrt(9 + 12 tan^2), or "
             "6 sin/(sqrt(3) (3 - sin))"},
            law.match, matches);
      });
  keys.optional_table<DensityHardening>(
      {"density_hardening",
       "effect density_hardening: powers of the largest density so far over the density"},
      material.density_hardening, [](KeyVisitor& inside, DensityHardening& law) {
        inside.number({"modulus_exponent", "of unloading and shear modulus"}, law.modulus_exponent,
                      non_negative);
        inside.number({"cohesion_exponent", "of the cohesion sqrt(a0)"}, law.cohesion_exponent, non_negative);
        inside.number({"friction_exponent", "of the slope sqrt(a2)"}, law.friction_exponent, non_negative);
      });
  keys.optional_table<StrengthSoftening>(
      {"strength_softening", "effect strength_softening: strength lost as exp(-plastic shear strain/strain)"},
      material.strength_softening, [](KeyVisitor& inside, StrengthSoftening& law) {
        inside.number(required("strain", "plastic shear strain in which 63 % of what can be lost is lost"),
                      law.strain, positive);
        inside.number({"residual_cohesion", "share of the cohesion that stays"}, law.residual_cohesion,
                      {0, 1, false, false});
        inside.number({"residual_friction", "share of the slope sqrt(a2) that stays"}, law.residual_friction,
                      share);
      });
  keys.optional_table<StrengthRecovery>(
      {"strength_recovery", "effect strength_recovery: how lost strength comes back"},
      material.strength_recovery, [](KeyVisitor& inside, StrengthRecovery& law) {
        inside.quantity({"time", "in which 63 % come back; 0: not with time"}, law.time, "s", non_negative);
        inside.number({"compression", "volumetric strain in which 63 % come back; 0: not with compression"},
                      law.compression, non_negative);
      });
  keys.optional_table<StrengthRate>(
      {"strength_rate", "effect strength_rate: strength times 1 + coefficient ln(1 + rate/reference)"},
      material.strength_rate, [](KeyVisitor& inside, StrengthRate& law) {
        inside.number(required("coefficient", "growth of strength"), law.coefficient, positive);
        inside.quantity(required("reference", "shear strain rate from which on strength grows"),
                        law.reference, "Hz", positive);
      });
  keys.optional_table<InertialFriction>(
      {"inertial_friction",
       "effect inertial_friction: strength times 1 + increase I/(I + inertial_number), I the inertial "
       "number"},
      material.inertial_friction, [](KeyVisitor& inside, InertialFriction& law) {
        inside.number(required("increase", "the most that fast flow adds, mu_2/mu_s - 1"), law.increase,
                      positive);
        inside.number(required("inertial_number", "where half of that is reached"), law.inertial_number,
                      positive);
        inside.quantity(required("grain_diameter", "of the grains that flow"), law.grain_diameter, "m",
                        positive);
        inside.quantity(required("grain_density", "of their solid"), law.grain_density, "kg/m^3", positive);
      });
}

void describe_continuum(KeyVisitor& keys, SoilFoamMaterial& material) {
  keys.quantity({"density", "bulk density in the reference state; left out: material.bulk_density"},
                material.density, "kg/m^3", non_negative);
  keys.curve({"pressure",
              "virgin compression: pressure against compressive volumetric strain ln(rho/rho0); or "
              "pressure_exponential"},
             material.pressure, {"strain", "", "values", "Pa", non_negative});
  keys.curve({"unloading", "bulk modulus for unloading and reloading against pressure; or unloading_ratio"},
             material.unloading, {"pressure", "Pa", "modulus", "Pa", positive});
  keys.number(
      {"unloading_ratio",
       "that modulus over the slope of first loading at the same pressure, at least 1; 0: by unloading"},
      material.unloading_ratio, non_negative);
  keys.number({"shear_ratio", "shear modulus over unloading bulk modulus"}, material.shear_ratio, positive);
  keys.quantity({"yield_a0", "yield surface J2 <= a0 + a1 p + a2 p^2; or mohr_coulomb"}, material.yield_a0,
                "Pa^2", non_negative);
  keys.quantity({"yield_a1", "see yield_a0"}, material.yield_a1, "Pa", non_negative);
  keys.number({"yield_a2", "see yield_a0"}, material.yield_a2, non_negative);
  keys.quantity({"tension_cutoff", "largest tension, above which pressure and shear are let go"},
                material.tension_cutoff, "Pa", non_negative);
  keys.quantity(
      {"dilation_angle", "effect dilation: its tangent is plastic expansion over plastic shear strain"},
      material.dilation_angle, "rad", {0, right_angle, false, true});
  describe_continuum_options(keys, material);
}

void describe_grain_sizes(KeyVisitor& keys, GrainSizes& sizes) {
  static constexpr std::string_view laws[] = {"uniform", "lognormal", "sieve"};
  static constexpr std::string_view shares[] = {"number", "mass"};
  keys.enumeration(
      {"law", "uniform, or lognormal cut off, from diameter_min to diameter_max; sieve: a curve"}, sizes.law,
      laws);
  keys.enumeration({"by", "what shares count: number of grains, or mass; lognormal and sieve need it given"},
                   sizes.by, shares);
  keys.quantity({"median", "lognormal: median before it is cut off"}, sizes.median, "m", non_negative);
  keys.number({"geometric_deviation", "lognormal: geometric standard deviation, above 1"},
              sizes.geometric_deviation, non_negative);
  keys.curve({"sieve", "sieve: share that passes each opening, from 0 to 1"}, sizes.sieve,
             {"opening", "m", "passing", "", {0, 1, false, false}});
}

void describe_clump(KeyVisitor& keys, Clump& clump) {
  static constexpr std::string_view shapes[] = {"pair", "triangle", "tetrahedron", "spheres"};
  keys.enumeration(
      {"shape", "two, three or four equal spheres that all touch each other, or those of spheres"},
      clump.shape, shapes);
  keys.number({"overlap", "pair, triangle, tetrahedron: depth that neighbours share over their diameter"},
              clump.overlap, {0, 1, false, true});
  keys.list<ClumpSphere>(
      {"spheres", "spheres: the clump in any unit of length, it is scaled to the grain's size"},
      clump.spheres, [](KeyVisitor& inside, ClumpSphere& sphere) {
        inside.number({"x", "centre"}, sphere.x, any);
        inside.number({"y", "centre"}, sphere.y, any);
        inside.number({"z", "centre"}, sphere.z, any);
        inside.number(required("radius", "of the sphere"), sphere.radius, positive);
      });
}

void describe_grain(KeyVisitor& keys, GrainMaterial& grain) {
  keys.quantity(required("density", "density of the solid"), grain.density, "kg/m^3", positive);
  keys.quantity(required("young_modulus", "Young's modulus"), grain.young_modulus, "Pa", positive);
  keys.number(required("poisson_ratio", "Poisson's ratio"), grain.poisson_ratio, {0, 0.5, true, true});
  keys.number(required("restitution", "coefficient of restitution"), grain.restitution, liggghts_restitution);
  keys.number(required("friction", "sliding friction with its own kind"), grain.friction, non_negative);
  keys.number({"rolling_friction", "coefficient of the rolling resistance"}, grain.rolling_friction,
              non_negative);
  keys.quantity({"cohesion_energy_density", "effect grain_cohesion: cohesive force over contact area"},
                grain.cohesion_energy_density, "J/m^3", non_negative);
  keys.quantity({"diameter_min", "smallest grain, true size; of law sieve: left out"}, grain.diameter_min,
                "m", non_negative);
  keys.quantity({"diameter_max", "largest grain, true size; of law sieve: left out"}, grain.diameter_max, "m",
                non_negative);
  keys.table({"sizes", "distribution of diameters; left out: uniform in number"},
             [&](KeyVisitor& inside) { describe_grain_sizes(inside, grain.sizes); });
  keys.optional_table<Clump>(
      {"clump",
       "effect clumps: a rigid body of spheres; sizes are then diameters of spheres of equal volume"},
      grain.clump, describe_clump);
}

void describe_grain_share(KeyVisitor& keys, GrainShare& share_of) {
  keys.material(required("material", "grain material"), share_of.material);
  keys.number(required("mass_fraction", "share of the layer's mass; shares add up to 1"),
              share_of.mass_fraction, share);
}

void describe_mesh_file(KeyVisitor& keys, CarpetMeshFile& mesh) {
  static constexpr std::string_view choices[] = {"refuse", "leave_out", "backing", "fibre"};
  keys.text({"mesh", "a mesh file instead of a generated carpet: Gmsh .msh, LS-DYNA .k, .key or .dyn"},
            mesh.file);
  keys.text({"mesh_unit", "unit of lengths in the mesh file"}, mesh.unit);
  keys.quantity({"mesh_shift_z", "added to heights of the mesh file"}, mesh.shift_z, "m", any);
  keys.enumeration({"mesh_undecided_parts",
                    "parts of the mesh file whose names say neither backing nor fibre: refuse, leave_out, "
                    "backing, fibre"},
                   mesh.undecided_parts, choices);
  keys.text({"mesh_content", "hash of the mesh file, which it must have; left out: the one it has"},
            mesh.content);
}

void describe_roller(KeyVisitor& keys, ConditioningRoller& roller) {
  keys.quantity({"diameter", "of the cylinder"}, roller.diameter, "m", positive);
  keys.integer({"studs_around", "studs on the circumference; 0: none"}, roller.studs_around,
               {0, 100, false, false});
  keys.quantity({"stud_spacing", "between rings of studs along the axis"}, roller.stud_spacing, "m",
                positive);
  keys.quantity({"stud_length", "of studs beyond the cylinder"}, roller.stud_length, "m", positive);
  keys.quantity({"stud_diameter", "of the studs' round tips"}, roller.stud_diameter, "m", positive);
  keys.quantity({"speed", "of rolling"}, roller.speed, "m/s", positive);
  keys.integer({"passes", "to and fro in turn, the last to conditioning.depth"}, roller.passes,
               {1, 1000, false, false});
}

void describe_conditioning(KeyVisitor& keys, Conditioning& conditioning) {
  static constexpr std::string_view methods[] = {"none", "compaction", "roller"};
  static constexpr std::string_view states[] = {"auto", "initial", "compacted"};
  keys.choice({"method",
               "none; compaction: a plate presses the infill and is lifted; roller: a studded "
               "cylinder rolls over it (dem)"},
              conditioning.method, methods);
  keys.quantity({"depth", "of the plate's or roller's lowest place below the infill's surface as placed"},
                conditioning.depth, "m", positive);
  keys.quantity({"press_time", "in which the plate comes down from the fibres' tips"},
                conditioning.press_time, "s", positive);
  keys.quantity({"lift_time", "in which it goes back up"}, conditioning.lift_time, "s", positive);
  keys.quantity({"settle_time", "gravity settling after it"}, conditioning.settle_time, "s", non_negative);
  keys.integer(
      {"presses", "largest number; above 1: again, deeper by what is missing, until the bed stays at depth"},
      conditioning.presses, {1, 1000, false, false});
  keys.quantity({"tolerance", "presses above 1: how far above depth the bed may stay"},
                conditioning.tolerance, "m", positive);
  keys.table({"roller", "the cylinder of method = \"roller\""},
             [&](KeyVisitor& inside) { describe_roller(inside, conditioning.roller); });
  keys.number({"sphere_diameter",
               "sph: of the rigid spheres meanwhile, over the edge of the cube that a particle fills"},
              conditioning.sphere_diameter, positive);
  keys.number({"sphere_friction", "sph: of these spheres on each other"}, conditioning.sphere_friction,
              non_negative);
  keys.enumeration(
      {"state",
       "sph: at the density reached; initial: the material's own, with that density as its "
       "reference; compacted: as pressed beyond it and released; auto: compacted for materials with "
       "density_hardening"},
      conditioning.state, states);
  keys.quantity({"frames", "time between frames meanwhile"}, conditioning.frames, "s", positive);
}

void describe_layer(KeyVisitor& keys, Layer& layer) {
  keys.material(required("material", "a file of materials/, or a table [materials.NAME]"), layer.material);
  keys.quantity(required("depth", "depth as placed"), layer.depth, "m", positive);
}

}  // namespace

void describe_friction(KeyVisitor& keys, FrictionLaw& law) {
  keys.number(required("static", "coefficient at rest"), law.static_coefficient, non_negative);
  keys.number(required("dynamic", "coefficient at high speed; may exceed the one at rest"),
              law.dynamic_coefficient, non_negative);
  keys.quantity({"decay", "mu(v) = dynamic + (static - dynamic) exp(-decay v)"}, law.decay, "s/m",
                non_negative);
}

void describe_carpet(KeyVisitor& keys, CarpetDesign& carpet) {
  keys.quantity(required("gauge", "distance of rows of tufts (y)"), carpet.gauge, "m", positive);
  keys.quantity(required("stitch_spacing", "distance of tufts along a row (x)"), carpet.stitch_spacing, "m",
                positive);
  keys.integer(required("strands_per_tuft", "strands rising from one tuft"), carpet.strands_per_tuft,
               at_least_one);
  keys.quantity(required("pile_length", "strand length from the backing"), carpet.pile_length, "m", positive);
  keys.quantity(required("strand_width", "width of a strand"), carpet.strand_width, "m", positive);
  keys.quantity(required("strand_thickness", "thickness of a strand"), carpet.strand_thickness, "m",
                positive);
  keys.quantity({"lean", "mean tilt of a strand from the vertical"}, carpet.lean, "rad",
                {0, 1.5, false, false});
  keys.quantity({"fan_out", "standard deviation of the tilt within a tuft"}, carpet.fan_out, "rad",
                {0, 1.0, false, false});
  static constexpr std::string_view yarns[] = {"slit_film", "monofilament"};
  keys.enumeration({"yarn", "a tape split above its root, or separate filaments"}, carpet.yarn, yarns);
  keys.integer({"legs_per_tuft", "both ends of a stitch (2), or one leg for all strands"},
               carpet.legs_per_tuft, {1, 2, false, false});
  keys.quantity(
      {"leg_spacing", "distance of a tuft's two legs along the row; 0: a quarter of stitch_spacing"},
      carpet.leg_spacing, "m", non_negative);
  keys.quantity(
      {"leg_width", "root of a leg across the row, its strands folded to fit; 0: side by side, flat"},
      carpet.leg_width, "m", non_negative);
  keys.quantity({"unsplit_length", "height from the root over which a slit-film tape is whole"},
                carpet.unsplit_length, "m", non_negative);
  keys.quantity({"curl", "turn of a strand's direction over a pile length, on a helix"}, carpet.curl, "rad",
                {0, 3.2, false, false});
  keys.number({"length_scatter", "standard deviation of strand length over pile_length"},
              carpet.length_scatter, {0, 0.3, false, false});
  keys.quantity(required("element_length", "shell length along a strand"), carpet.element_length, "m",
                positive);
  keys.quantity(required("backing_thickness", "thickness of the backing"), carpet.backing_thickness, "m",
                positive);
  keys.quantity(required("backing_element", "largest shell side of the backing"), carpet.backing_element, "m",
                positive);
  keys.quantity({"damping", "mass-proportional damping of the carpet"}, carpet.damping, "Hz", non_negative);
  keys.number({"contact_restitution", "of carpet nodes on rig bodies and the tray"},
              carpet.contact_restitution, share);
  describe_mesh_file(keys, carpet.mesh);
  keys.table({"body_friction", "of fibres and backing on rig bodies and the tray"},
             [&](KeyVisitor& inside) { describe_friction(inside, carpet.body_friction); });
  keys.table({"fibre", "material and shells of the strands"}, [&](KeyVisitor& inside) {
    // The list of relaxation terms comes last: keys behind it would belong to its last item when written.
    describe_shell_section(inside, carpet.fibre_section);
    describe_shell_material(inside, carpet.fibre);
  });
  keys.table({"backing", "material and shells of the backing"}, [&](KeyVisitor& inside) {
    describe_shell_section(inside, carpet.backing_section);
    describe_orthotropic(inside, carpet.backing);
    describe_shell_material(inside, carpet.backing);
  });
}

void describe_material(KeyVisitor& keys, Material& material) {
  keys.table({"material", "the material as a whole"}, [&](KeyVisitor& inside) {
    inside.text({"name", "its name, the same as the file's"}, material.name);
    inside.quantity(required("bulk_density", "bulk density as placed: mass of a layer for both approaches"),
                    material.bulk_density, "kg/m^3", positive);
    inside.quantity({"contact_modulus", "sets the contact stiffness; 0: from the infill's own law"},
                    material.contact_modulus, "Pa", non_negative);
    inside.number({"contact_restitution", "normal damping of contact with carpet and bodies"},
                  material.contact_restitution, share);
  });
  keys.table({"friction", "friction of the infill"}, [&](KeyVisitor& inside) {
    inside.table({"fibre", "against fibres and backing"},
                 [&](KeyVisitor& law) { describe_friction(law, material.fibre_friction); });
    inside.table({"body", "against rig bodies and the tray"},
                 [&](KeyVisitor& law) { describe_friction(law, material.body_friction); });
  });
  keys.optional_table<SoilFoamMaterial>({"continuum", "the infill as a continuum (sph)"}, material.continuum,
                                        describe_continuum);
  keys.optional_table<GrainMaterial>({"grain", "one kind of grain (dem)"}, material.grain, describe_grain);
  keys.list<GrainShare>({"grain_shares", "what a layer is made of in dem; left out: grains of its own"},
                        material.grain_shares, describe_grain_share);
}

void describe_scene(KeyVisitor& keys, Scene& scene,
                    const std::function<void(KeyVisitor&, CarpetDesign&)>& carpet) {
  // Of a component rig and of a specimen the test itself says how long it takes, and there is no patch.
  const RigKind kind = keys.of_all_rigs()         ? RigKind::turf
                       : scene.rig.is_component() ? RigKind::component
                       : scene.rig.is_specimen()  ? RigKind::specimen
                                                  : RigKind::turf;
  const bool turf = kind == RigKind::turf, infill = kind != RigKind::component;
  keys.table({"scene", "the scene as a whole"}, [&](KeyVisitor& inside) {
    inside.text({"name", "a name for reports; left out: the file's"}, scene.info.name);
    if (turf)
      inside.quantity(required("duration", "time to simulate from the release of the rig"),
                      scene.info.duration, "s", positive);
  });
  const bool strand = kind == RigKind::specimen && scene.rig.has_strand();
  if (kind != RigKind::specimen || strand)
    keys.table({"turf", "carpet, patch and layers"}, [&](KeyVisitor& inside) {
      inside.text({"design", "a file of turfs/; or give [turf.carpet]"}, scene.turf.design);
      if (turf) {
        inside.quantities(required("size", "x and y of the patch"), scene.turf.size, "m", positive);
        inside.quantity({"tray_depth", "height of the tray's walls; left out: infill depth + 20 mm"},
                        scene.turf.tray_depth, "m", non_negative);
      }
      inside.table({"carpet", "the carpet itself; with a design: keys that differ from it"},
                   [&](KeyVisitor& keys_of_carpet) { carpet(keys_of_carpet, scene.turf.carpet); });
      if (turf)
        inside.list<Layer>(required("layers", "infill, bottom to top"), scene.turf.layers, describe_layer);
    });
  if (infill)
    keys.table({"infill", "how the infill is described"},
               [&](KeyVisitor& inside) { describe_infill(inside, scene.infill); });
  if (turf)
    keys.table({"conditioning", "what the turf went through before"},
               [&](KeyVisitor& inside) { describe_conditioning(inside, scene.conditioning); });
  keys.table({"rig", "what loads the turf"}, [&](KeyVisitor& inside) { describe_rig(inside, scene.rig); });
  if (infill)
    keys.table({"effects", "physics to switch: true, false, or \"auto\": on where the scene needs it"},
               [&](KeyVisitor& inside) { describe_effects(inside, scene.effects); });
  keys.table({"numerics", "steps and limits"},
             [&](KeyVisitor& inside) { describe_numerics(inside, scene.numerics, kind); });
  if (infill)
    keys.table({"output", "what is recorded"},
               [&](KeyVisitor& inside) { describe_output(inside, scene.output, kind); });
}

}  // namespace tuft::schema

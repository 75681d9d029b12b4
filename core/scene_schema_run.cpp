/// Keys of how a scene is run: infill approach, rig, effects, numerics, output.
#include "core/effect_names.h"
#include "core/scene_schema.h"

namespace tuft::schema {
namespace {

constexpr std::string_view approaches[] = {"sph", "dem"};
constexpr std::string_view presets[] = {"accurate", "fast", "paper", "specimen", "custom"};
constexpr std::string_view kernels[] = {"cubic_spline", "wendland_c2"};
constexpr std::string_view rigs[] = {"clegg",     "strand_tension", "backing_tension",
                                     "oedometer", "direct_shear",   "pull_out"};
constexpr std::string_view grain_contacts[] = {"hertz", "hooke", "hooke_hysteresis"};
constexpr std::string_view rolling_models[] = {"epsd2", "cdt"};
constexpr std::string_view strip_directions[] = {"along", "across"};
constexpr std::string_view strain_bases[] = {"length", "height"};
constexpr std::string_view body_contacts[] = {"half_row", "penalty"};
constexpr std::string_view strip_grips[] = {"hold_width", "let_contract"};

constexpr double largest_integer = 9.2e18;  // TOML's integers have 64 bits and a sign

void describe_sph(KeyVisitor& keys, SphOptions& sph) {
  keys.choice(
      {"preset",
       "accurate: Wendland C2, h = 1.3 pitch; fast: cubic spline, h = pitch; paper: cubic spline, h = 0.71 "
       "pitch; specimen (of oedometer, direct_shear and pull_out where left out): cubic spline, h = 0.9 "
       "pitch; custom"},
      sph.preset, presets);
  keys.quantity({"pitch", "lattice spacing"}, sph.pitch, "m", positive);
  keys.quantity({"smoothing_length", "h, half the kernel's support; left out: by the preset"},
                sph.smoothing_length, "m", non_negative);
  keys.enumeration({"kernel", "with any preset, h as the preset has it; left out: by the preset"}, sph.kernel,
                   kernels);
  keys.number({"viscosity_linear", "artificial viscosity, Monaghan's alpha"}, sph.viscosity_linear,
              non_negative);
  keys.number({"viscosity_quadratic", "artificial viscosity, Monaghan's beta"}, sph.viscosity_quadratic,
              non_negative);
  keys.number({"zero_energy_viscosity",
               "against motion of neighbours that no velocity gradient sees; left out: 0 with preset paper"},
              sph.zero_energy_viscosity, non_negative);
}

void describe_dem(KeyVisitor& keys, DemOptions& dem) {
  keys.number({"coarse_graining", "factor on grain diameters; material properties kept (theory/dem.md)"},
              dem.coarse_graining, at_least_one);
  keys.numbers_by_name({"material_coarse_graining", "own factor of a grain material, by its name"},
                       dem.material_coarse_graining, at_least_one);
  keys.enumeration(
      {"contact",
       "springs of contacts: hertz (stiffen with overlap), hooke (constant), hooke_hysteresis (plastic: "
       "grains keep dents)"},
      dem.contact, grain_contacts);
  keys.quantity({"characteristic_velocity",
                 "hooke, hooke_hysteresis: two grains meeting at it overlap as under Hertz's law; 0: the "
                 "missile's speed"},
                dem.characteristic_velocity, "m/s", non_negative);
  keys.number(
      {"unloading_ratio", "hooke_hysteresis: stiffness of unloading and reloading over first loading"},
      dem.unloading_ratio, {1, unbounded, true, false});
  keys.number({"plastic_depth", "hooke_hysteresis: deepest dent over twice the effective radius"},
              dem.plastic_depth, positive);
  keys.number({"adhesion_ratio", "hooke_hysteresis: stiffness of the pull on parting over first loading"},
              dem.adhesion_ratio, non_negative);
  keys.enumeration(
      {"rolling", "effect rolling_resistance: epsd2 (elastic-plastic spring), cdt (constant torque)"},
      dem.rolling, rolling_models);
  keys.text(
      {"host", "path of liggghts_host; tcp://machine:port of one that listens; empty: beside the program"},
      dem.host);
  keys.integer({"ranks", "MPI processes of liggghts_host, all on its machine"}, dem.ranks, Range{1, 256});
  keys.number({"overlap_limit",
               "of two grains over the smaller radius, looked at with each history row from the release of "
               "the rig on: beyond it the run stops; 0: none"},
              dem.overlap_limit, non_negative);
  keys.quantity({"answer_timeout", "without an answer for so long the host counts as hung"},
                dem.answer_timeout, "s", positive);
  keys.number(
      {"packing_friction",
       "share of their friction, on each other, strands and tray, that grains have while they are laid: "
       "1 a bed as poured, 0 the densest, as tamped"},
      dem.packing_friction, Range{0, 1});
  keys.quantity({"settle_time", "packing dynamics after the geometric packing, at least"}, dem.settle_time,
                "s", non_negative);
  keys.quantity({"settle_time_limit",
                 "laying of grains ends when they hardly sink, and coming to rest when they are at rest; "
                 "each at the latest after so long"},
                dem.settle_time_limit, "s", non_negative);
  keys.number(
      {"rest_tolerance",
       "share of their weight that nothing bears, below which grains count as at rest; twice that while they "
       "are packed among fibres, for there the run settles them again"},
      dem.rest_tolerance, positive);
  keys.flag({"use_cache", "reuse a settled packing of an earlier run with the same inputs"}, dem.use_cache);
  keys.list<GrainPair>(
      {"pairs", "what unlike grains have between them; left out: mean of the two"}, dem.pairs,
      [](KeyVisitor& inside, GrainPair& pair) {
        inside.materials(required("materials", "the two grain materials"), pair.materials);
        inside.optional_number({"friction", "sliding friction; left out: mean"}, pair.friction, non_negative);
        inside.optional_number({"restitution", "coefficient of restitution; left out: mean"},
                               pair.restitution, liggghts_restitution);
        inside.optional_number({"rolling_friction", "of the rolling resistance; left out: mean"},
                               pair.rolling_friction, non_negative);
        inside.optional_quantity(
            {"cohesion_energy_density", "cohesive force over contact area; left out: mean"},
            pair.cohesion_energy_density, "J/m^3", non_negative);
      });
}

void describe_clegg(KeyVisitor& keys, CleggRig& clegg) {
  keys.quantity({"mass", "mass of the missile"}, clegg.mass, "kg", positive);
  keys.quantity({"diameter", "diameter of the missile"}, clegg.diameter, "m", positive);
  keys.quantity({"height", "height of the missile"}, clegg.height, "m", positive);
  keys.quantity({"speed", "speed at first contact, downwards"}, clegg.speed, "m/s", positive);
  keys.quantities({"position", "axis relative to the middle of the patch"}, clegg.position, "m", any);
  keys.quantity({"filter_cutoff", "low-pass of the acceleration"}, clegg.filter_cutoff, "Hz", positive);
  keys.quantity({"touch_force", "force that counts as first contact"}, clegg.touch_force, "N", positive);
}

void describe_tension(KeyVisitor& keys, TensionRig& tension, bool of_backing) {
  keys.quantity_list({"rates", "tension: nominal strain rates, a test each"}, tension.rates, "Hz", positive);
  keys.quantity_list(
      {"gauge_lengths", "tension: length between the grips, one for all rates or one for each"},
      tension.gauge_lengths, "m", positive);
  keys.quantity({"width",
                 "tension: width of the strip; 0: turf.carpet.strand_width, or of backing 16 mm along, 21 mm "
                 "across"},
                tension.width, "m", non_negative);
  if (of_backing)
    keys.enumeration({"direction", "backing_tension: strip cut along or across the stitch"},
                     tension.direction, strip_directions);
  keys.enumeration({"grips", "tension: grips hold the ends' width, or let them contract"}, tension.grips,
                   strip_grips);
  keys.number({"strain_limit", "tension: engineering strain at which a test ends"}, tension.strain_limit,
              {0, 5, true, false});
  keys.integer({"samples", "tension: rows recorded over a test"}, tension.samples, {10, 1e6, false, false});
  keys.number(
      {"mass_factor", "tension: on the density, for longer steps; the kinetic share says what is allowed"},
      tension.mass_factor, at_least_one);
}

void describe_pull_out(KeyVisitor& keys, SpecimenRig& specimen) {
  keys.quantity_list({"speeds", "pull_out: of the grip that draws the strand, a test each"}, specimen.speeds,
                     "m/s", positive);
  keys.quantity({"run_speed",
                 "pull_out: all tests run at this speed, with the friction of their own; 0: each at its own"},
                specimen.run_speed, "m/s", non_negative);
  keys.quantity({"normal_stress", "pull_out: to which the platens are pressed together before they are held"},
                specimen.normal_stress, "Pa", positive);
  keys.quantity({"embedded_length", "pull_out: of the strand, from its free end; 0: through the whole box"},
                specimen.embedded_length, "m", non_negative);
  keys.quantity({"travel", "pull_out: of the grip, at which a test ends"}, specimen.travel, "m", positive);
}

void describe_specimen(KeyVisitor& keys, SpecimenRig& specimen, bool ring, bool box, bool pull) {
  keys.material(required("material", "oedometer, direct_shear, pull_out: the infill that is tested"),
                specimen.material);
  keys.quantity(
      {"height", "specimen: height as placed; 0: 12.7 mm in the ring, 19.5 mm in shear, 20 mm in pull_out"},
      specimen.height, "m", non_negative);
  if (ring || box) {
    keys.quantity(
        {"speed", "specimen: of the upper plate (0: 1 mm/s) or the lower half of the box (0: 0.1 mm/s)"},
        specimen.speed, "m/s", non_negative);
    keys.number(
        {"speed_factor", "specimen: tests run so many times faster; inertia_share says what is allowed"},
        specimen.speed_factor, at_least_one);
  }
  keys.number({"wall_friction", "specimen: friction of the infill on ring or side walls"},
              specimen.wall_friction, non_negative);
  keys.quantity(
      {"sample_travel",
       "specimen: travel between rows at full speed; 0: 2 um in the ring, 10 um in shear, 20 um in pull_out"},
      specimen.sample_travel, "m", non_negative);
  keys.integer({"frame_rows", "specimen: rows between frames"}, specimen.frame_rows, {1, 1e9, false, false});
  keys.integer({"checkpoint_rows", "specimen: rows between checkpoints"}, specimen.checkpoint_rows,
               {1, 1e9, false, false});
  if (ring) {
    keys.quantity({"diameter", "oedometer: inner diameter of the ring"}, specimen.diameter, "m", positive);
    keys.quantity_list({"preloads", "oedometer: force at which the plate turns back, a test each"},
                       specimen.preloads, "N", positive);
    keys.integer({"cycles", "oedometer: loadings and unloadings"}, specimen.cycles, {1, 1000, false, false});
    keys.quantity({"seating_force", "oedometer: force at which unloading ends"}, specimen.seating_force, "N",
                  positive);
  }
  if (box || pull) {
    keys.quantities({"size", "direct_shear, pull_out: the box, along what is moved and across"},
                    specimen.size, "m", positive);
    keys.quantity(
        {"load_time", "direct_shear, pull_out: time in which the normal load rises, and again is held"},
        specimen.load_time, "s", positive);
    keys.number(
        {"platen_friction", "direct_shear, pull_out: friction of the infill on the plates above and below"},
        specimen.platen_friction, non_negative);
  }
  if (pull) describe_pull_out(keys, specimen);
  if (box) {
    keys.quantity_list(
        {"normal_stresses", "direct_shear: load on the upper plate over the box's area, a test each"},
        specimen.normal_stresses, "Pa", positive);
    keys.number({"yield_strain", "direct_shear: shear strain at which the yield is read and the test ends"},
                specimen.yield_strain, {0, 0.5, true, false});
    keys.enumeration(
        {"strain_basis", "direct_shear: shear strain is displacement over the length, or the height"},
        specimen.strain_basis, strain_bases);
  }
}

}  // namespace

void describe_infill(KeyVisitor& keys, InfillChoice& infill) {
  keys.enumeration({"approach", "sph: continuum; dem: grains"}, infill.approach, approaches);
  keys.table({"sph", "infill as a continuum"}, [&](KeyVisitor& inside) { describe_sph(inside, infill.sph); });
  keys.table({"dem", "infill as grains"}, [&](KeyVisitor& inside) { describe_dem(inside, infill.dem); });
}

void describe_rig(KeyVisitor& keys, Rig& rig) {
  keys.choice(required("type", "which rig"), rig.type, rigs);
  if (rig.type == "clegg" || keys.of_all_rigs()) describe_clegg(keys, rig.clegg);
  if (rig.is_component() || keys.of_all_rigs())
    describe_tension(keys, rig.tension, rig.type == "backing_tension" || keys.of_all_rigs());
  if (rig.is_specimen() || keys.of_all_rigs())
    describe_specimen(keys, rig.specimen, rig.type == "oedometer" || keys.of_all_rigs(),
                      rig.type == "direct_shear" || keys.of_all_rigs(),
                      rig.has_strand() || keys.of_all_rigs());
}

void describe_effects(KeyVisitor& keys, Effects& effects) {
  for (const std::string_view name : effect_names) {
    Switch& choice = effects.choice.try_emplace(std::string(name), Switch::automatic).first->second;
    keys.toggle({name, effect_meaning(name)}, choice);
  }
}

void describe_numerics(KeyVisitor& keys, Numerics& numerics, RigKind kind) {
  keys.number({"step_safety", "share of every part's stable step"}, numerics.step_safety, share);
  if (kind != RigKind::turf) {
    keys.number({"energy_error_limit", "relative energy error that stops the run"},
                numerics.energy_error_limit, positive);
    if (kind == RigKind::specimen) {
      keys.quantity({"contact_pressure", "highest expected: sets the contact stiffness of the continuum"},
                    numerics.contact_pressure, "Pa", positive);
      keys.number({"contact_stiffness_factor", "contact stiffness over constrained modulus x pitch"},
                  numerics.contact_stiffness_factor, positive);
    }
    keys.integer({"threads", "0: all cores"}, numerics.threads, {0, 4096, false, false});
    return;
  }
  keys.number({"mass_scaling_limit",
               "share of the carpet's mass that may be added to the shells that bound its step"},
              numerics.mass_scaling_limit, {0, 1, false, true});
  keys.flag(
      {"subcycle_carpet", "backing or fibres, whichever bears it, stepped at a multiple of the other's step"},
      numerics.subcycle_carpet);
  keys.number(
      {"sleep_tolerance", "strain of waves under which SPH infill at rest is not computed; 0: all is"},
      numerics.sleep_tolerance, {0, 1, false, true});
  keys.integer(
      {"individual_steps",
       "steps of the run, 2, 4, 8 or 16, that a step of SPH particles in soft layers may last; 1: one"},
      numerics.individual_steps, {1, 16, false, false});
  keys.quantity(
      {"coupling_window", "time between exchanges; 0: the larger of the carpet's and the infill's step"},
      numerics.coupling_window, "s", non_negative);
  keys.number({"energy_error_limit", "relative energy error that stops the run"}, numerics.energy_error_limit,
              positive);
  keys.quantity({"contact_pressure", "highest expected: sets the contact stiffness of the continuum"},
                numerics.contact_pressure, "Pa", positive);
  keys.number({"contact_stiffness_factor", "contact stiffness over constrained modulus x pitch"},
              numerics.contact_stiffness_factor, positive);
  keys.enumeration(
      {"body_contact",
       "spring of SPH particles against bodies: half_row, the infill between centre and face, or penalty"},
      numerics.body_contact, body_contacts);
  keys.number({"shell_contact_radius", "contact radius of SPH particles at strands over half their diameter"},
              numerics.shell_contact_radius, share);
  keys.quantity({"contact_release_time", "time over which initial overlap is let go"},
                numerics.contact_release_time, "s", non_negative);
  keys.quantity({"settle_time", "gravity settling before the rig is released; of grains at least"},
                numerics.settle_time, "s", non_negative);
  keys.quantity({"settle_time_limit",
                 "grains settle on until they are at rest (infill.dem.rest_tolerance), at most so long"},
                numerics.settle_time_limit, "s", non_negative);
  keys.quantity({"settle_damping", "mass-proportional damping while settling"}, numerics.settle_damping, "Hz",
                non_negative);
  keys.integer({"seed", "of everything random"}, numerics.seed, {0, largest_integer, false, false});
  keys.integer({"threads", "0: all cores"}, numerics.threads, {0, 4096, false, false});
}

void describe_output(KeyVisitor& keys, Output& output, RigKind kind) {
  if (kind == RigKind::turf) {
    keys.quantity({"frames", "time between frames"}, output.frames, "s", positive);
    keys.quantity({"histories", "time between rows of histories"}, output.histories, "s", positive);
    keys.quantity({"checkpoint_every", "time between checkpoints; 0: only at the end and on interruption"},
                  output.checkpoint_every, "s", non_negative);
  }
  keys.table({"micro", "contacts and coarse-grained fields with each frame"}, [&](KeyVisitor& inside) {
    inside.flag({"contacts", "record the contact network, its statistics and spins"}, output.micro.contacts);
    inside.flag({"fields", "record density, velocity, stress and porosity on a grid"}, output.micro.fields);
    inside.quantity({"cell", "edge of a cell of the grid"}, output.micro.cell, "m", positive);
    inside.quantity({"width", "coarse-graining width, half the cutoff of the kernel; 0: a cell"},
                    output.micro.width, "m", non_negative);
  });
}

}  // namespace tuft::schema

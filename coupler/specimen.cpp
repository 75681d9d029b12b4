#include "coupler/specimen.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "coupler/build_simulation.h"
#include "coupler/packing_cache.h"
#include "coupler/settled_packing.h"
#include "dem_bridge/effective_medium.h"
#include "fe_carpet/carpet.h"
#include "sph_infill/specimen_lattice.h"

namespace tuft::coupler {
namespace {

/// What holds grains while they come to rest: walls without friction, so that they settle evenly.
std::vector<RigidBody> container(const SpecimenRoom& room) {
  std::vector<RigidBody> bodies = tray(room.size);
  if (room.round) {
    bodies.resize(1);  // the floor
    bodies.emplace_back();
    bodies.back().name = "ring";
    bodies.back().shape = Bore{0.5 * room.size[0]};
  }
  for (std::size_t b = 1; b < bodies.size(); ++b) bodies[b].friction = FrictionLaw{0, 0, 0};
  return bodies;
}

/// LIGGGHTS' box: a specimen may be pushed sideways by its own length, and stand several times as high as
/// placed before it comes to rest.
std::array<Vec3, 2> grain_box(const SpecimenRoom& room) {
  return {Vec3(-1.5 * room.size[0], -1.5 * room.size[1], -room.height),
          Vec3(1.5 * room.size[0], 1.5 * room.size[1], 5 * room.height)};
}

dem::Grains packed_grains(const Scene& scene, const std::vector<EffectDecision>& effects,
                          const SpecimenRoom& room, const SpecimenStrand* strand) {
  Turf one_layer;
  one_layer.layers = {{room.material, room.height}};
  dem::PackingRequest packing;
  packing.size = room.size;
  packing.round = room.round;
  packing.turf = &one_layer;
  packing.materials = &scene.materials;
  packing.options = &scene.infill.dem;
  packing.seed = scene.numerics.seed;
  packing.clumps = effect_on(effects, "clumps");
  std::vector<dem::ThinQuad> obstacles;
  if (strand != nullptr) obstacles = thin_quads(strand->mesh);
  packing.obstacles = obstacles;
  return dem::pack_grains(packing);
}

dem::Grains settled_grains(const Scene& scene, const std::vector<EffectDecision>& effects,
                           const SpecimenRoom& room, const SpecimenStrand* strand, PackingReport& report) {
  Scene still = packing_scene(scene);
  still.infill.dem.packing_friction = DemOptions{}.packing_friction;  // they are not laid among fibres
  const PackingCache cache(
      still, effects,
      fmt::format("{} {:.17g} x {:.17g} x {:.17g} m{}", room.round ? "ring" : "box", room.size[0],
                  room.size[1], room.height, strand != nullptr ? strand->description() : ""));
  Packing packing;
  const auto of_grains_alone = [](const Packing& kept) {
    if (kept.carpet.position.size() > 0) throw_run_error("it has strands");
  };
  if (cache.load(packing, of_grains_alone)) {
    report = packing.report;
    return packing.grains;
  }
  Specimen loose;
  loose.room = room;
  loose.grains = packed_grains(scene, effects, room, strand);
  still.infill.dem.ranks = packing_ranks(scene, loose.grains);
  SpecimenRequest request;
  request.scene = &still;
  request.effects = effects;
  request.specimen = &loose;
  request.bodies = container(room);
  request.strand = strand;
  const auto simulation = build_specimen(request);
  simulation->freeze_carpet(true);
  report = come_to_rest(*simulation, scene.infill.dem, Bed::placed, [](double) {});
  report.moved = static_cast<double>(loose.grains.moved);
  report.cache_trouble = packing.report.cache_trouble;
  loose.grains.position = positions(simulation->infill());
  cache.store({loose.grains, {}, report});
  return loose.grains;
}

/// A lattice's particle at a wall stands for less of it where walls meet. Rows lie on the walls: there is no
/// half row between.
std::vector<NormalSpring> wall_springs(const sph::Lattice& lattice, const std::vector<double>& stiffness) {
  constexpr double of_wall_row = 2.0 / 3;  // about the volume of a particle at a wall over that of one inside
  std::vector<NormalSpring> springs;
  for (std::size_t i = 0; i < lattice.volume.size(); ++i) {
    const double edge = 2 * lattice.radius.at(i);
    const double share = std::min(1.0, lattice.volume[i] / (of_wall_row * edge * edge * edge));
    springs.push_back({share * stiffness[i]});
  }
  return springs;
}

std::unique_ptr<fe::Carpet> carpet_of(const SpecimenStrand* strand) {
  if (strand == nullptr)
    return std::make_unique<fe::Carpet>(fe::ShellMesh{}, std::vector<ShellMaterial>{}, fe::CarpetOptions{});
  fe::CarpetOptions options;
  options.gravity = gravity;
  options.section = strand->section;
  auto carpet = std::make_unique<fe::Carpet>(strand->mesh, std::vector{strand->material}, options);
  for (const std::size_t node : strand->driven) carpet->drive(node, Vec3(0, 0, 0));
  return carpet;
}

void add_strand(SimulationParts& parts, const SpecimenStrand& strand, const PointContact& contact) {
  parts.particle_shell.stiffness = contact.stiffness;
  parts.particle_shell.damping_ratio = contact.damping_ratio;
  parts.particle_shell.friction = contact.fibre_friction;
  parts.nodes_touch_bodies = false;
  parts.node_radius.assign(strand.mesh.nodes.size(), 0.5 * strand.mesh.thickness.front());
  const std::size_t nodes = strand.mesh.nodes.size();
  parts.node_body = {std::vector<NormalSpring>(nodes, {1.0}), std::vector<double>(nodes, 0),
                     std::vector<FrictionLaw>(nodes)};
}

/// Share of its radius with which a particle reaches the strand: the nearest rows just touch it as placed.
double reach_at_strand(const sph::Lattice& lattice, const SpecimenStrand& strand) {
  const double height = strand.mesh.nodes.z.front();
  double nearest = std::numeric_limits<double>::infinity();
  for (const double z : lattice.position.z) nearest = std::min(nearest, std::abs(z - height));
  return (nearest - 0.5 * strand.mesh.thickness.front()) / lattice.radius.front();
}

}  // namespace

std::string SpecimenStrand::description() const {
  std::string text = fmt::format(" around {} shells", mesh.quads.size());
  for (const std::size_t n : {std::size_t{0}, mesh.nodes.size() - 1}) {
    const Vec3 x = mesh.nodes[n];
    text += fmt::format(" ({:.17g} {:.17g} {:.17g})", x.x(), x.y(), x.z());
  }
  return text + fmt::format(" {:.17g} m thick", mesh.thickness.front());
}

Specimen fill_room(const Scene& scene, const std::vector<EffectDecision>& effects, const SpecimenRoom& room,
                   const SpecimenStrand* strand) {
  Specimen specimen;
  specimen.room = room;
  if (scene.infill.approach == Approach::sph) {
    const SphOptions& sph = scene.infill.sph;
    specimen.lattice = room.round ? sph::fill_ring({0.5 * room.size[0], room.height}, room.material, sph)
                                  : sph::fill_box({room.size, room.height}, room.material, sph);
    specimen.reach = specimen.lattice.radius.front();
    specimen.top = room.height + specimen.reach;
    return specimen;
  }
  specimen.grains = settled_grains(scene, effects, room, strand, specimen.packing.emplace());
  for (std::size_t i = 0; i < specimen.grains.size(); ++i)
    specimen.top = std::max(specimen.top, specimen.grains.position.z[i] + specimen.grains.radius[i]);
  return specimen;
}

double placed_density(const Scene& scene, Index material) {
  const Material& infill = scene.materials.at(static_cast<std::size_t>(material));
  return scene.infill.approach == Approach::sph ? infill.continuum->density : infill.bulk_density;
}

double placed_modulus(const Scene& scene, Index material, double pressure) {
  const Material& infill = scene.materials.at(static_cast<std::size_t>(material));
  if (scene.infill.approach == Approach::sph) return sph::constrained_modulus(*infill.continuum, pressure);
  constexpr double contacts_of_a_grain = 6;
  double solid = 0;  // share of the room
  for (const GrainShare& share : infill.grain_shares)
    solid += infill.bulk_density * share.mass_fraction /
             scene.materials[static_cast<std::size_t>(share.material)].grain->density;
  double compliance = 0;
  for (const GrainShare& share : infill.grain_shares) {
    const GrainMaterial& grain = *scene.materials[static_cast<std::size_t>(share.material)].grain;
    const double of_solid = infill.bulk_density * share.mass_fraction / grain.density / solid;
    compliance += of_solid / dem::packing_constrained_modulus(grain.young_modulus, grain.poisson_ratio, solid,
                                                              contacts_of_a_grain, pressure);
  }
  return 1 / compliance;
}

std::unique_ptr<Simulation> build_specimen(const SpecimenRequest& request) {
  const Scene& scene = *request.scene;
  const Specimen& specimen = *request.specimen;
  SimulationParts parts;
  if (scene.infill.approach == Approach::sph) {
    parts.infill = build_sph(scene, request.effects, specimen.lattice, {});
  } else {
    parts.infill = build_dem(scene, request.effects, specimen.grains, grain_box(specimen.room));
  }
  parts.carpet = carpet_of(request.strand);
  parts.bodies = request.bodies;
  const ParticleView particles = parts.infill->particles();
  const PointContact contact = particle_contact(scene, request.effects, particles);
  parts.particle_body = {{}, contact.damping_ratio, contact.body_friction};
  if (scene.infill.approach == Approach::sph)
    parts.particle_body.spring = wall_springs(specimen.lattice, contact.stiffness);
  else
    for (const double k : contact.stiffness) parts.particle_body.spring.push_back({k});
  if (request.strand != nullptr) {
    add_strand(parts, *request.strand, contact);
    if (scene.infill.approach == Approach::sph)
      parts.particle_shell.strand_radius_factor = reach_at_strand(specimen.lattice, *request.strand);
  }
  parts.gravity = gravity;
  parts.numerics = scene.numerics;
  parts.skin = search_skin(scene.infill.approach, particles.radius);
  parts.energy_scale = request.energy_scale;
  parts.release_overlap = false;
  parts.separated_at_fibres = effect_on(request.effects, "fibre_separation");
  return std::make_unique<Simulation>(std::move(parts));
}

}  // namespace tuft::coupler

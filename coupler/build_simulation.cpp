#include "coupler/build_simulation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>

#include "core/error.h"
#include "coupler/conditioned_infill.h"
#include "coupler/roller.h"
#include "coupler/settled_packing.h"
#include "fe_carpet/mesh_import.h"

namespace tuft::coupler {
namespace {

/// What a friction law comes to when its dependence on speed is switched off: the value of fast sliding.
FrictionLaw friction_of(const FrictionLaw& law, bool with_rate) {
  return with_rate ? law : FrictionLaw{law.dynamic_coefficient, law.dynamic_coefficient, 0};
}

double penalty_of(const Scene& scene, const std::vector<EffectDecision>& effects, const Material& material,
                  double radius) {
  return scene.infill.approach == Approach::sph
             ? sph_contact_stiffness(material, scene.numerics, radius, sph::soil_effects_of(effects))
             : dem_contact_stiffness(material, radius);
}

/// What is found once for all particles of one material and shape: rows of a lattice have few shapes, and a
/// soil law takes time to make.
template <class Value>
class FoundOnce {
 public:
  template <class Find>
  const Value& of(Index material, double width, double height, Find&& find) {
    const std::array<double, 3> key{static_cast<double>(material), width, height};
    const auto known = values_.find(key);
    return known != values_.end() ? known->second : values_.emplace(key, find()).first->second;
  }

 private:
  std::map<std::array<double, 3>, Value> values_;
};

/// Half the thickness of the thickest shell at each node.
std::vector<double> node_radii(const fe::ShellMesh& mesh) {
  std::vector<double> radius(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    for (const Index node : mesh.quads[e]) radius[node] = std::max(radius[node], 0.5 * mesh.thickness[e]);
  return radius;
}

/// Just above all particles and nodes, m.
double top_of(const ParticleView& particles, const fe::NodeView& nodes, std::span<const double> node_radius) {
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < particles.size(); ++i)
    top = std::max(top, particles.z[i] + particles.radius_upwards(i));
  for (std::size_t n = 0; n < nodes.z.size(); ++n) top = std::max(top, nodes.z[n] + node_radius[n]);
  constexpr double clearance = 1e-4;
  return top + clearance;
}

}  // namespace

std::unique_ptr<sph::SphInfill> build_sph(const Scene& scene, const std::vector<EffectDecision>& effects,
                                          const sph::Lattice& lattice, const sph::TurfBox& box) {
  sph::SphSettings settings = sph_settings(scene, effects);
  settings.box = box;
  return std::make_unique<sph::SphInfill>(lattice, scene.materials, settings);
}

std::unique_ptr<dem::DemInfill> build_dem(const Scene& scene, const std::vector<EffectDecision>& effects,
                                          const dem::Grains& grains, const std::array<Vec3, 2>& box) {
  dem::DemSettings settings;
  settings.options = scene.infill.dem;
  settings.gravity = gravity;
  settings.rolling_resistance = effect_on(effects, "rolling_resistance");
  settings.cohesion = effect_on(effects, "grain_cohesion");
  settings.box = box;
  return std::make_unique<dem::DemInfill>(grains, scene.materials, settings);
}

std::vector<double> damping_ratios(const Scene& scene, const std::vector<EffectDecision>& effects) {
  const bool damped = effect_on(effects, "contact_damping");
  std::vector<double> ratios;
  for (const Material& material : scene.materials)
    ratios.push_back(damped ? damping_ratio_of_restitution(material.contact_restitution) : 0);
  return ratios;
}

PointContact particle_contact(const Scene& scene, const std::vector<EffectDecision>& effects,
                              const ParticleView& particles) {
  const bool with_rate = effect_on(effects, "friction_rate");
  PointContact result;
  FoundOnce<double> known;
  const std::vector<double> damping_ratio = damping_ratios(scene, effects);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Index m = particles.material[i];
    const Material& material = scene.materials[static_cast<std::size_t>(m)];
    const double radius = particles.mean_radius(i);
    const auto penalty = [&] { return penalty_of(scene, effects, material, radius); };
    // Radii of grains are all different.
    result.stiffness.push_back(scene.infill.approach == Approach::dem ? penalty()
                                                                      : known.of(m, radius, radius, penalty));
    result.damping_ratio.push_back(damping_ratio[static_cast<std::size_t>(m)]);
    result.fibre_friction.push_back(friction_of(material.fibre_friction, with_rate));
    result.body_friction.push_back(friction_of(material.body_friction, with_rate));
  }
  return result;
}

double search_skin(Approach approach, std::span<const double> radius) {
  if (approach == Approach::sph) return 0.5 * *std::min_element(radius.begin(), radius.end());
  double sum = 0;
  for (const double r : radius) sum += r;
  return 0.5 * sum / static_cast<double>(radius.size());
}

std::vector<NormalSpring> body_springs(const Scene& scene, const std::vector<EffectDecision>& effects,
                                       const ParticleView& particles, bool rigid) {
  const sph::SoilEffects soil_effects = sph::soil_effects_of(effects);
  const bool half_rows = scene.infill.approach == Approach::sph && !rigid &&
                         scene.numerics.body_contact == BodyContactKind::half_row;
  std::vector<NormalSpring> springs;
  FoundOnce<NormalSpring> known;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Index m = particles.material[i];
    const Material& material = scene.materials[static_cast<std::size_t>(m)];
    const double width = 2 * particles.radius[i], height = particles.radius_upwards(i);
    const auto spring = [&] {
      return half_rows ? half_row_spring(material, scene.numerics, width * width, height, soil_effects)
                       : NormalSpring{penalty_of(scene, effects, material, particles.mean_radius(i))};
    };
    springs.push_back(scene.infill.approach == Approach::dem ? spring() : known.of(m, width, height, spring));
  }
  return springs;
}

std::vector<NormalSpring> wall_springs(const Scene& scene, const std::vector<EffectDecision>& effects,
                                       const ParticleView& particles) {
  std::vector<NormalSpring> springs;
  if (scene.numerics.body_contact != BodyContactKind::half_row || particles.half_height.empty())
    return springs;
  const sph::SoilEffects soil_effects = sph::soil_effects_of(effects);
  FoundOnce<NormalSpring> known;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Index m = particles.material[i];
    const double radius = particles.radius[i], half_height = particles.half_height[i];
    springs.push_back(known.of(m, radius, half_height, [&] {
      return half_row_spring(scene.materials[static_cast<std::size_t>(m)], scene.numerics,
                             4 * radius * half_height, radius, soil_effects);
    }));
  }
  return springs;
}

double sph_contact_stiffness(const Material& material, const Numerics& numerics, double radius,
                             const sph::SoilEffects& effects) {
  const double modulus =
      material.contact_modulus > 0
          ? material.contact_modulus
          : sph::constrained_modulus(*material.continuum, numerics.contact_pressure, effects);
  return numerics.contact_stiffness_factor * modulus * 2 * radius;
}

NormalSpring half_row_spring(const Material& material, const Numerics& numerics, double area,
                             double thickness, const sph::SoilEffects& effects) {
  if (material.contact_modulus > 0) return {material.contact_modulus * area / thickness};
  const double pressure = numerics.contact_pressure,
               modulus = sph::constrained_modulus(*material.continuum, 0, effects),
               growth =
                   (sph::constrained_modulus(*material.continuum, pressure, effects) - modulus) / pressure;
  NormalSpring spring{modulus * area / thickness};
  if (!(growth > 0)) return spring;
  spring.stiffening = growth / thickness;
  spring.end = std::log1p(growth * pressure / modulus) / spring.stiffening;
  return spring;
}

double dem_contact_stiffness(const Material& material, double radius) {
  if (material.contact_modulus > 0) return material.contact_modulus * radius;
  const GrainMaterial& grain = *material.grain;
  return grain.young_modulus / (1 - grain.poisson_ratio * grain.poisson_ratio) * radius;
}

double floor_height(const Scene& scene, const std::vector<EffectDecision>& effects) {
  return effect_on(effects, "backing") ? 0 : scene.turf.carpet.backing_thickness;
}

std::vector<RigidBody> tray(std::array<double, 2> size, double floor) {
  const auto wall = [](std::string name, const Vec3& position, const Vec3& normal) {
    RigidBody body;
    body.name = std::move(name);
    body.shape = HalfSpace{normal};
    body.position = position;
    return body;
  };
  const double x = 0.5 * size[0], y = 0.5 * size[1];
  return {wall("floor", Vec3(0, 0, floor), Vec3(0, 0, 1)), wall("wall_x_low", Vec3(-x, 0, 0), Vec3(1, 0, 0)),
          wall("wall_x_high", Vec3(x, 0, 0), Vec3(-1, 0, 0)),
          wall("wall_y_low", Vec3(0, -y, 0), Vec3(0, 1, 0)),
          wall("wall_y_high", Vec3(0, y, 0), Vec3(0, -1, 0))};
}

fe::ShellMesh build_carpet_mesh(const Scene& scene, bool with_fibres) {
  if (!scene.turf.carpet.mesh.file.empty())
    return fe::import_carpet(scene.turf.carpet, scene.turf.size, with_fibres).mesh;
  return fe::generate_carpet(scene.turf.carpet, scene.turf.size, scene.numerics.seed, with_fibres);
}

fe::ShellMesh build_carpet_mesh(const Scene& scene, const std::vector<EffectDecision>& effects) {
  return effect_on(effects, "backing") ? build_carpet_mesh(scene, effect_on(effects, "fibres"))
                                       : fe::ShellMesh{};
}

fe::CarpetOptions carpet_options(const Scene& scene) {
  fe::CarpetOptions options;
  options.sections = {scene.turf.carpet.backing_section, scene.turf.carpet.fibre_section};
  options.damping = scene.turf.carpet.damping;
  options.gravity = gravity;
  options.mass_scaling_limit = scene.numerics.mass_scaling_limit;
  options.subcycle = scene.numerics.subcycle_carpet;
  return options;
}

std::vector<std::string> carpet_mesh_notes(const Scene& scene) {
  if (scene.turf.carpet.mesh.file.empty()) return {};
  return fe::import_carpet(scene.turf.carpet, scene.turf.size, true).notes;
}

namespace {

std::unique_ptr<Infill> build_continuum(const BuildRequest& request, BuiltSimulation& built) {
  const Scene& scene = *request.scene;
  const sph::Lattice lattice = scene_lattice(scene);
  if (!request.before_conditioning) return build_sph(scene, request.effects, lattice, turf_box(scene));
  auto spheres = build_spheres(scene, request.effects, lattice);
  built.spheres = spheres.get();
  return spheres;
}

std::unique_ptr<Infill> build_grains(const BuildRequest& request, const fe::ShellMesh& mesh,
                                     BuiltSimulation& built, std::optional<fe::CarpetShape>& carpet) {
  const Scene& scene = *request.scene;
  dem::Grains settled;
  if (request.grains != nullptr) {
    settled = *request.grains;
  } else {
    const auto start = std::chrono::steady_clock::now();
    SettledGrains packed = settle_grains(scene, request.effects, mesh, request.on_progress);
    settled = std::move(packed.grains);
    carpet = std::move(packed.carpet);
    built.packing = packed.report;
    built.packing_from_cache = packed.from_cache;
    built.packing_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const sph::TurfBox box = turf_box(scene);
  auto dem = build_dem(scene, request.effects, settled, {box.low, box.high});
  built.dem = dem.get();
  return dem;
}

/// Tray, the rig's, and what conditions.
void add_bodies(const BuildRequest& request, SimulationParts& parts, BuiltSimulation& built) {
  const Scene& scene = *request.scene;
  std::vector<RigidBody>& bodies = parts.bodies;
  bodies = tray(scene.turf.size, floor_height(scene, request.effects));
  bodies.front().is_carpet = !effect_on(request.effects, "backing");
  built.first_rig_body = bodies.size();
  bodies.insert(bodies.end(), request.rig_bodies.begin(), request.rig_bodies.end());
  if (!scene.conditioning.on()) return;
  built.plate = bodies.size();
  if (scene.conditioning.method == "roller") {
    const std::vector<RigidBody> roller = Roller(scene).bodies();
    bodies.insert(bodies.end(), roller.begin(), roller.end());
  } else {
    bodies.push_back(
        conditioning_plate(top_of(parts.infill->particles(), parts.carpet->nodes(), parts.node_radius)));
  }
}

void set_contact(const BuildRequest& request, SimulationParts& parts) {
  const Scene& scene = *request.scene;
  const ParticleView particles = parts.infill->particles();
  const PointContact contact = particle_contact(scene, request.effects, particles);
  parts.particle_shell.stiffness = contact.stiffness;
  parts.particle_shell.damping_ratio = contact.damping_ratio;
  parts.particle_shell.friction = contact.fibre_friction;
  // A sheet inside a continuum takes no room in it: with a particle's whole radius the strands would press
  // the lattice apart as they are let in. The share is numerics.shell_contact_radius.
  if (scene.infill.approach == Approach::sph)
    parts.particle_shell.strand_radius_factor = scene.numerics.shell_contact_radius;
  parts.particle_body = {body_springs(scene, request.effects, particles, request.before_conditioning),
                         contact.damping_ratio,
                         contact.body_friction,
                         wall_springs(scene, request.effects, particles),
                         contact.fibre_friction,
                         scene.infill.approach == Approach::sph ? 1.0 : 0.0};

  const std::size_t nodes = parts.node_radius.size();
  for (const double k : parts.carpet->node_contact_stiffness())
    parts.node_body.spring.push_back({parts.particle_shell.shell_share * k});
  const double restitution = scene.turf.carpet.contact_restitution;
  parts.node_body.damping_ratio.assign(
      nodes, effect_on(request.effects, "contact_damping") ? damping_ratio_of_restitution(restitution) : 0);
  parts.node_body.friction.assign(
      nodes, friction_of(scene.turf.carpet.body_friction, effect_on(request.effects, "friction_rate")));
}

}  // namespace

std::unique_ptr<fe::Carpet> build_carpet(const Scene& scene, const std::vector<EffectDecision>& effects,
                                         fe::ShellMesh mesh) {
  ShellMaterial backing = scene.turf.carpet.backing, fibre = scene.turf.carpet.fibre;
  if (!effect_on(effects, "erosion")) backing.failure_strain = fibre.failure_strain = 0;
  return std::make_unique<fe::Carpet>(std::move(mesh), std::vector<ShellMaterial>{backing, fibre},
                                      carpet_options(scene));
}

BuiltSimulation build_simulation(const BuildRequest& request) {
  const Scene& scene = *request.scene;
  BuiltSimulation built;
  SimulationParts parts;
  fe::ShellMesh mesh = build_carpet_mesh(scene, request.effects);
  parts.node_radius = node_radii(mesh);
  std::optional<fe::CarpetShape> carpet;
  if (request.carpet != nullptr) carpet = *request.carpet;
  parts.infill = scene.infill.approach == Approach::sph ? build_continuum(request, built)
                                                        : build_grains(request, mesh, built, carpet);
  parts.carpet = build_carpet(scene, request.effects, std::move(mesh));
  if (carpet) parts.carpet->take_shape(*carpet);
  add_bodies(request, parts, built);
  set_contact(request, parts);

  parts.gravity = gravity;
  parts.numerics = scene.numerics;
  parts.skin = search_skin(scene.infill.approach, parts.infill->particles().radius);
  parts.energy_scale = request.energy_scale;
  parts.release_overlap = effect_on(request.effects, "overlap_release");
  parts.separated_at_fibres = effect_on(request.effects, "fibre_separation");
  parts.time = request.start_time;
  built.simulation = std::make_unique<Simulation>(std::move(parts));
  return built;
}

}  // namespace tuft::coupler

#include "coupler/conditioned_infill.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "coupler/build_simulation.h"
#include "coupler/fastest.h"
#include "sph_infill/soil_law.h"
#include "sph_infill/sphere_placing.h"

namespace tuft::coupler {
namespace {

constexpr double most_overlap = 0.01;  // of the diameter, at numerics.contact_pressure

sph::LatticeBox lattice_box(const Scene& scene) {
  return {scene.turf.size, scene.turf.carpet.backing_thickness};
}

/// A law that cannot be left as dense as the bed will be is better known before the bed is pressed. Local
/// compression has been seen up to twice the mean one.
void check_state(const Scene& scene, const sph::SphSettings& settings) {
  if (scene.conditioning.state == ConditionedState::initial) return;
  const double depth = scene.infill_depth(), mean = std::log(depth / (depth - scene.conditioning.depth));
  for (const Layer& layer : scene.turf.layers) {
    const Material& material = scene.materials.at(static_cast<std::size_t>(layer.material));
    const sph::SoilLaw law =
        sph::make_soil_law(*material.continuum, settings.tension_cutoff, settings.soil_effects);
    if (!sph::is_left_compacted(law, scene.conditioning.state)) continue;
    try {
      (void)sph::compacted_state(law, 2 * mean);
    } catch (const InputError& error) {
      throw_input_error("{}: conditioning.state: {} cannot be left so dense: {}; or set it to \"initial\"",
                        scene.file, material.name, error.what());
    }
  }
}

/// Mean and standard deviation by layer.
void measure_densities(const std::vector<double>& ratio, std::span<const Index> layer, std::size_t layers,
                       SwitchReport& report) {
  std::vector<double> count(layers, 0), sum(layers, 0), square(layers, 0);
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    const auto k = static_cast<std::size_t>(layer[i]);
    const double reached = std::max(1.0, ratio[i]);  // what the continuum starts with
    count[k] += 1, sum[k] += reached, square[k] += reached * reached;
  }
  for (std::size_t k = 0; k < layers; ++k) {
    const double mean = sum[k] / count[k];
    report.density_mean.push_back(mean);
    report.density_deviation.push_back(std::sqrt(std::max(0.0, square[k] / count[k] - mean * mean)));
  }
}

}  // namespace

/// As given, but that presets which name a ratio of smoothing length to spacing keep it as whole numbers of
/// rows and columns make the spacing: else results would drift with the pitch until the next row, and jump
/// back.
SphOptions bed_options(const Scene& scene) {
  SphOptions options = scene.infill.sph;
  const bool by_ratio = options.preset == "accurate" || options.preset == "fast";
  if (by_ratio && !scene.turf.layers.empty())
    options.smoothing_length *=
        sph::mean_spacing(scene.turf, lattice_box(scene), options.pitch) / options.pitch;
  return options;
}

sph::Lattice scene_lattice(const Scene& scene) {
  sph::Lattice lattice = sph::make_bed(scene.turf, lattice_box(scene), bed_options(scene));
  // Where spheres press the bed its rows are gone, and particles touch as the cubes that the spheres stand
  // for.
  if (scene.conditioning.on()) lattice.radius.clear(), lattice.half_height.clear();
  return lattice;
}

sph::TurfBox turf_box(const Scene& scene) {
  constexpr double margin = 0.02;  // m
  const double x = 0.5 * scene.turf.size[0] + margin, y = 0.5 * scene.turf.size[1] + margin;
  const double height = std::max(2 * scene.turf.tray_depth, 4 * scene.infill_depth());
  return {Vec3(-x, -y, -margin), Vec3(x, y, height)};
}

sph::SphSettings sph_settings(const Scene& scene, const std::vector<EffectDecision>& effects) {
  return {bed_options(scene),
          Vec3(0, 0, -9.81),
          effect_on(effects, "artificial_viscosity"),
          effect_on(effects, "tension_cutoff"),
          effect_on(effects, "zero_energy_control"),
          scene.numerics.sleep_tolerance,
          scene.numerics.individual_steps,
          scene.numerics.step_safety,
          sph::soil_effects_of(effects),
          turf_box(scene),
          sph::KickLength::step_begun};
}

RigidBody conditioning_plate(double height) {
  RigidBody plate;
  plate.name = plate_name;
  plate.shape = HalfSpace{Vec3(0, 0, -1)};
  plate.position = Vec3(0, 0, height);
  plate.driven = true;
  return plate;
}

std::unique_ptr<sph::SphereInfill> build_spheres(const Scene& scene,
                                                 const std::vector<EffectDecision>& effects,
                                                 const sph::Lattice& lattice) {
  sph::SphereSettings settings;
  const sph::SphSettings continuum = sph_settings(scene, effects);
  check_state(scene, continuum);
  settings.options = continuum.options;
  settings.gravity = continuum.gravity;
  settings.diameter_ratio = scene.conditioning.sphere_diameter;
  settings.modulus = scene.numerics.contact_pressure / most_overlap;
  settings.friction = scene.conditioning.sphere_friction;
  settings.damping_ratio = damping_ratios(scene, effects);
  settings.lost_strength = continuum.soil_effects.strength_softening;

  sph::PlacingRequest placing;
  placing.sphere_radius = sph::sphere_radii(lattice, settings.diameter_ratio);
  placing.wall_radius = sph::sphere_radii(lattice, 1);
  placing.box = lattice_box(scene);
  placing.seed = scene.numerics.seed;
  return std::make_unique<sph::SphereInfill>(lattice, scene.materials,
                                             sph::place_spheres(lattice, placing).position, settings);
}

std::unique_ptr<Infill> take_over(const Scene& scene, const std::vector<EffectDecision>& effects,
                                  sph::SphereInfill& spheres, SwitchReport& report) {
  const sph::CompactedBed bed = spheres.hand_over();
  report.kinetic = bed.energy.kinetic;
  report.let_go = bed.energy.let_go;
  report.fastest = fastest(bed.velocity.x, bed.velocity.y, bed.velocity.z);
  report.largest_overlap = spheres.largest_overlap();
  measure_densities(bed.density_ratio, spheres.particles().layer, scene.turf.layers.size(), report);
  const sph::Lattice lattice = scene_lattice(scene);
  for (std::size_t i = 0; i < lattice.volume.size(); ++i)
    report.volume += lattice.volume[i] / std::max(1.0, bed.density_ratio[i]);
  auto continuum = std::make_unique<sph::SphInfill>(lattice, scene.materials, sph_settings(scene, effects),
                                                    bed, scene.conditioning.state);
  report.started_as_placed =
      static_cast<double>(continuum->loosest_started()) / static_cast<double>(bed.density_ratio.size());
  return continuum;
}

}  // namespace tuft::coupler

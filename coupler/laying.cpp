#include "coupler/laying.h"

#include <cmath>
#include <limits>

#include "coupler/build_simulation.h"
#include "coupler/packing_cache.h"

namespace tuft::coupler {
namespace {

/// Grains' moduli among each other are divided by it: steps are 3 times as long, overlaps some per cent.
constexpr double softness = 10;
constexpr double acceleration = 20;       ///< g
constexpr double damping = 200;           ///< 1/s: grains fall with 1 m/s at most
constexpr double interval = 1e-4;         ///< s
constexpr std::uint64_t look_every = 10;  ///< intervals
/// The bed is laid when its mean height sinks by less than this share of itself between two looks. Of 5700
/// grains among coarse strands that is after 14 ms, without friction after 25 (and 25 ms more let it sink by
/// another 2 %).
constexpr double slow = 0.002;
constexpr std::uint64_t springing_back = 50;  ///< intervals, at 1 g

FrictionLaw share_of(const FrictionLaw& law, double share) {
  return {share * law.static_coefficient, share * law.dynamic_coefficient, law.decay};
}

/// The scene's grains, softer and smoother.
Scene smooth_scene(const Scene& scene) {
  Scene smooth = scene;
  DemOptions& dem = smooth.infill.dem;
  const double share = dem.packing_friction;
  dem.contact = GrainContact::hertz;
  dem.characteristic_velocity = 0;
  for (GrainPair& pair : dem.pairs) {
    if (pair.friction) *pair.friction *= share;
    if (pair.rolling_friction) *pair.rolling_friction *= share;
  }
  for (Material& material : smooth.materials) {
    material.fibre_friction = share_of(material.fibre_friction, share);
    material.body_friction = share_of(material.body_friction, share);
    if (!material.grain) continue;
    material.grain->young_modulus /= softness;
    material.grain->friction *= share;
    material.grain->rolling_friction *= share;
  }
  return smooth;
}

std::vector<EffectDecision> without(std::vector<EffectDecision> effects, std::string_view name) {
  for (EffectDecision& effect : effects)
    if (effect.name == name) effect.on = false;
  return effects;
}

double mean_height(const Infill& infill) {
  const std::span<const double> z = infill.particles().z;
  double sum = 0;
  for (const double height : z) sum += height;
  return sum / static_cast<double>(z.size());
}

}  // namespace

LaidBed lay(const Scene& scene, const std::vector<EffectDecision>& effects, const dem::Grains& grains,
            const std::function<void(double)>& report) {
  const Scene smooth = smooth_scene(scene);
  BuildRequest request;
  request.scene = &smooth;
  request.effects = without(without(effects, "grain_cohesion"), "erosion");
  if (scene.infill.dem.packing_friction == 0)
    request.effects = without(std::move(request.effects), "rolling_resistance");
  request.grains = &grains;
  const BuiltSimulation built = build_simulation(request);
  Simulation& simulation = *built.simulation;
  simulation.set_damping(damping, damping);
  simulation.set_infill_acceleration((acceleration - 1) * gravity);

  const auto most = static_cast<std::uint64_t>(std::llround(scene.infill.dem.settle_time_limit / interval));
  const double floor = scene.turf.carpet.backing_thickness;
  std::uint64_t done = 0;
  double before = std::numeric_limits<double>::infinity();
  LaidBed bed;
  while (done < most && !bed.lies) {
    simulation.advance_interval(interval);
    report(static_cast<double>(++done) / static_cast<double>(most));
    if (done % look_every != 0) continue;
    const double height = mean_height(simulation.infill()) - floor;
    // What overlaps as placed parts first, and the bed rises: only then does it sink.
    bed.lies = std::abs(before - height) < slow * height && done > 3 * look_every;
    before = height;
  }
  // Pressed together by that weight grains would spring apart, once they are as stiff as they are.
  simulation.set_infill_acceleration(Vec3(0, 0, 0));
  for (std::uint64_t i = 0; i < springing_back; ++i) simulation.advance_interval(interval);
  done += springing_back;
  bed.position = positions(simulation.infill());
  bed.carpet = simulation.carpet().shape();
  bed.time = static_cast<double>(done) * interval;
  return bed;
}

}  // namespace tuft::coupler

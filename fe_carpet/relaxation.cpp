#include "fe_carpet/relaxation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tuft::fe {
namespace {

void zero(Vec3Array& values) {
  for (std::vector<double>* component : {&values.x, &values.y, &values.z})
    std::fill(component->begin(), component->end(), 0.0);
}

/// The stable step follows the shape, which changes slowly against it.
constexpr std::uint64_t steps_between_looks = 200;

constexpr int quiet_swings_at_rest = 3;

/// Under a full load swings have to last ever longer: stopped at every peak of a fast mode, the slow ones
/// would never move and a carpet far from rest would seem quiet. A stop off a mode's own peak takes half of
/// its energy on average. While the load rises every peak is stopped, which holds the carpet to its path.
struct Swing {
  std::uint64_t steps = 0;  ///< since the last stop
  double shortest = least;  ///< steps before the next stop
  double longest = 0;
  void end(bool ramping) {
    if (!ramping) {
      longest = std::max(longest, static_cast<double>(steps));
      shortest = std::max(growth * shortest, share_of_longest * longest);
    }
    steps = 0;
  }
  static constexpr double least = 4, growth = 1.05, share_of_longest = 0.5;
};

}  // namespace

RelaxationResult relax(Carpet& carpet, const LoadAtShare& load, const RelaxationOptions& options) {
  if (!(options.step_safety > 0 && options.step_safety < 1) || !(options.tolerance > 0) ||
      !(options.ramp_time >= 0))
    throw std::logic_error("relaxation: options out of range");
  const std::size_t nodes = carpet.nodes().x.size();
  Vec3Array force, moment;
  force.assign(nodes, 0.0);
  moment.assign(nodes, 0.0);
  RelaxationResult result;
  double dt = 0, time = 0, kinetic_before = 0, kinetic_peak = 0;
  Swing swing;
  int quiet_swings = 0;
  while (result.steps < options.most_steps) {
    if (result.steps % steps_between_looks == 0) dt = options.step_safety * carpet.stable_step();
    const bool ramping = time < options.ramp_time;
    const double progress = ramping ? time / options.ramp_time : 1.0;
    zero(force);
    zero(moment);
    load(carpet.nodes(), options.from + progress * (options.to - options.from), force, moment);
    carpet.step(dt, force, moment);
    time += dt;
    ++result.steps;
    ++swing.steps;
    const double kinetic = carpet.kinetic_energy();
    const bool past_peak = kinetic<kinetic_before&& static_cast<double>(swing.steps)> swing.shortest;
    kinetic_peak = std::max(kinetic_peak, kinetic);
    if (!past_peak) {
      kinetic_before = kinetic;
      // Nothing to move: no load, or none any more.
      if (!ramping && kinetic_peak == 0 && swing.steps == steps_between_looks) {
        result.at_rest = true;
        return result;
      }
      continue;
    }
    const CarpetEnergy energy = carpet.energy();
    result.kinetic_share = kinetic_peak / std::max(energy.strain + energy.hourglass, 1e-300);
    carpet.stop();
    ++result.swings;
    swing.end(ramping);
    kinetic_before = kinetic_peak = 0;
    quiet_swings = !ramping && result.kinetic_share < options.tolerance ? quiet_swings + 1 : 0;
    if (quiet_swings == quiet_swings_at_rest) {
      result.at_rest = true;
      return result;
    }
  }
  return result;
}

}  // namespace tuft::fe

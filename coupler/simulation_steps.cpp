/// How long Simulation's steps are.
#include <algorithm>
#include <cmath>

#include "coupler/simulation.h"

namespace tuft::coupler {
namespace {

/// Of the limits that lengthens steps at once: longer steps that fit just now are likely to be too long soon.
constexpr double at_once = 0.85;
/// Intervals in a row that have to bear longer steps otherwise.
constexpr int patience = 50;

}  // namespace

StableSteps Simulation::stable_steps(double interval) const {
  const double infill = parts_.infill->stable_step();
  const double touching =
      particle_body_.stable_step(parts_.infill->particles(), parts_.bodies, interval, !has_carpet());
  if (!has_carpet())  // the infill alone sets the window
    return {1 / std::hypot(1 / infill, 1 / touching), infill, touching, 1};
  const double contact = std::min(touching, particle_shell_.stable_step(parts_.infill->particles()));
  return {parts_.carpet->stable_step(), infill, contact, parts_.carpet->subcycle_ratio()};
}

/// Steps are shortened at once, but lengthened only where they are likely to stay so: each change costs
/// accuracy.
StepPlan Simulation::next_plan(double interval) {
  const auto plan_for = [&](const StableSteps& stable) {
    return plan_steps(stable, parts_.numerics.step_safety, parts_.numerics.coupling_window, interval);
  };
  StableSteps stable = stable_steps(interval);
  const StepPlan plan = plan_for(stable);
  const bool same_interval = std::abs(plan_.windows * plan_.window - interval) < 1e-9 * interval;
  if (!same_interval || plan.windows >= plan_.windows || plan.carpet_subcycle != plan_.carpet_subcycle) {
    bears_longer_steps_ = 0;
    return plan;
  }
  stable.carpet *= at_once, stable.infill *= at_once, stable.contact *= at_once;
  if (plan_for(stable).windows >= plan_.windows && ++bears_longer_steps_ < patience) return plan_;
  bears_longer_steps_ = 0;
  return plan;
}

void Simulation::tell_contact_rates(double interval) {
  if (!parts_.infill->has_individual_steps()) return;
  const ScopedPhase phase(timers_, Phase::contact);
  // They hold until the next interval, and a step begun in it may last longer.
  const double horizon = interval + parts_.numerics.individual_steps * plan_.window;
  const ParticleView particles = parts_.infill->particles();
  contact_rates_.assign(particles.size(), 0);
  particle_body_.raise_rates(particles, parts_.bodies, horizon, !has_carpet(), contact_rates_);
  particle_shell_.raise_rates(contact_rates_);
  parts_.infill->set_contact_rates(contact_rates_);
}

}  // namespace tuft::coupler

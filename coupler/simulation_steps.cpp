/// How long Simulation's steps are, and what the infill is told before them.
#include <algorithm>
#include <cmath>

#include "coupler/fastest.h"
#include "coupler/simulation.h"
#include "sph_infill/individual_steps.h"

namespace tuft::coupler {
namespace {

/// Of the limits that lengthens steps at once: longer steps that fit just now are likely to be too long soon.
constexpr double at_once = 0.85;
/// Intervals in a row that have to bear longer steps otherwise.
constexpr int patience = 50;

}  // namespace

StableSteps Simulation::stable_steps(double interval) const {
  std::vector<BodyContact::Approach> approaches;
  particle_body_.look(parts_.infill->particles(), parts_.bodies, approaches);
  return stable_steps(interval, approaches);
}

StableSteps Simulation::stable_steps(double interval,
                                     std::span<const BodyContact::Approach> approaches) const {
  const double infill = parts_.infill->stable_step();
  const ParticleView particles = parts_.infill->particles();
  if (!has_carpet()) {  // the infill alone sets the window
    const double touching = particle_body_.least_stable_step(particles, approaches, interval, true);
    return {1 / std::hypot(1 / infill, 1 / touching), infill, touching, 1};
  }
  std::vector<double> steps = particle_body_.stable_steps(particles, approaches, interval, false);
  double touching = *std::min_element(steps.begin(), steps.end());
  particle_body_.leave_near(steps);  // of what touches both the springs add up
  particle_shell_.shorten_steps(particles, steps);
  touching = std::min(touching, *std::min_element(steps.begin(), steps.end()));
  return {parts_.carpet->stable_step(), infill, touching, parts_.carpet->subcycle_ratio()};
}

/// Steps are shortened at once, but lengthened only where they are likely to stay so: each change costs
/// accuracy.
StepPlan Simulation::next_plan(double interval) {
  const double safety = parts_.numerics.step_safety, asked = parts_.numerics.coupling_window;
  const StableSteps stable = stable_steps(interval, approaches_);
  const StepPlan plan = plan_steps(stable, safety, asked, interval);
  if (!(plan.window > (1 + 1e-9) * plan_.window) || plan_.window == 0) {
    bears_longer_steps_ = 0;
    return plan;
  }
  StableSteps less = stable;
  less.carpet *= at_once, less.infill *= at_once, less.contact *= at_once;
  const bool bears_margin = plan_steps(less, safety, asked, interval).window > (1 + 1e-9) * plan_.window;
  // Windows stay as long as they are; steps within them follow what each part bears now.
  if (!bears_margin && ++bears_longer_steps_ < patience)
    return plan_steps(stable, safety, plan_.window, interval);
  bears_longer_steps_ = 0;
  return plan;
}

bool Simulation::shorten_rest(double rest) {
  // Slow elements of the carpet are evaluated in the last of its steps, which are counted from the interval's
  // start.
  if (plan_.carpet_subcycle > 1) return false;
  look_at_bodies();
  const StepPlan plan = plan_steps(stable_steps(rest, approaches_), parts_.numerics.step_safety,
                                   parts_.numerics.coupling_window, rest);
  if (!(plan.window < (1 - 1e-9) * plan_.window)) return false;
  plan_ = plan;
  tell_contact_rates(rest);
  return true;
}

void Simulation::look_at_bodies() {
  const ScopedPhase phase(timers_, Phase::contact);
  particle_body_.look(parts_.infill->particles(), parts_.bodies, approaches_);
}

void Simulation::tell_contact_rates(double interval) {
  if (!parts_.infill->has_individual_steps()) return;
  const ScopedPhase phase(timers_, Phase::contact);
  // They hold until the next interval, and a step begun in it may last longer.
  const double horizon = interval + parts_.numerics.individual_steps * plan_.window;
  const ParticleView particles = parts_.infill->particles();
  contact_rates_.assign(particles.size(), 0);
  // What a gauge at a body reads follows its kicks: less than two intervals of the history apart, even where
  // a period takes as much of the stable step as it may.
  const double most_of_step = std::max(parts_.numerics.step_safety, sph::IndividualSteps::most_of_step);
  const double of_readings = (0.5 + 1e-4) * most_of_step / interval_;
  particle_body_.raise_rates(particles, parts_.bodies, approaches_, horizon, !has_carpet(), of_readings,
                             contact_rates_);
  particle_shell_.raise_rates(contact_rates_);
  parts_.infill->set_contact_rates(contact_rates_);
}

/// When they, or the infill, may have moved as far as the infill bears. Speeds may grow within an interval.
void Simulation::show_sheets(double interval) {
  const ScopedPhase phase(timers_, Phase::search);
  constexpr double growth = 2;
  const ParticleView particles = parts_.infill->particles();
  const fe::NodeView nodes = parts_.carpet->nodes();
  const double on_the_way =
      growth * interval *
      std::max(fastest(particles.vx, particles.vy, particles.vz), fastest(nodes.vx, nodes.vy, nodes.vz));
  const std::size_t failed = parts_.carpet->eroded_count();
  sheets_hold_ -= on_the_way;
  if (sheets_hold_ >= 0 && failed == sheets_failed_) return;
  sheets_failed_ = failed;
  const fe::ShellMesh& mesh = parts_.carpet->mesh();
  const std::span<const std::uint8_t> eroded = parts_.carpet->eroded();
  sheets_.clear();
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (mesh.surface[e] == fe::ShellMesh::backing_surface || (!eroded.empty() && eroded[e] != 0)) continue;
    std::array<Vec3, 4>& sheet = sheets_.emplace_back();
    for (std::size_t c = 0; c < 4; ++c) {
      const auto n = static_cast<std::size_t>(mesh.quads[e][c]);
      sheet[c] = Vec3(nodes.x[n], nodes.y[n], nodes.z[n]);
    }
  }
  sheets_hold_ = parts_.infill->set_sheets(sheets_) - on_the_way;
}

}  // namespace tuft::coupler

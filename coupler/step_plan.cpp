#include "coupler/step_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"

namespace tuft::coupler {
namespace {

/// Smallest whole number of equal parts none of which is longer than `longest`. Rounding must not add a part
/// when it fits.
int parts(double whole, double longest) {
  return std::max(1, static_cast<int>(std::ceil(whole / longest * (1 - 1e-12))));
}

/// Steps of the carpet in an interval must be a multiple of m: adds windows, or steps in each, whichever
/// makes fewer steps in all.
StepPlan with_subcycle(StepPlan plan, int m, double interval) {
  const auto up = [](int count, int to) { return (count + to - 1) / to * to; };
  const int substeps = up(plan.carpet_substeps, m / std::gcd(m, plan.windows));
  const int windows = up(plan.windows, m / std::gcd(m, plan.carpet_substeps));
  plan.carpet_subcycle = m;
  if (plan.windows * substeps < windows * plan.carpet_substeps)
    plan.carpet_substeps = substeps;
  else
    plan.windows = windows;
  plan.window = interval / plan.windows;
  return plan;
}

/// The largest m up to `ratio` that adds few windows and steps: contact, infill and fast shells pay for each.
StepPlan fit_subcycle(const StepPlan& plan, int ratio, double interval) {
  constexpr double most_added = 0.05;
  const int steps = plan.windows * plan.carpet_substeps;
  for (int m = std::min(ratio, steps); m > 1; --m)
    if (const StepPlan fitted = with_subcycle(plan, m, interval);
        fitted.windows * fitted.carpet_substeps <= (1 + most_added) * steps)
      return fitted;
  return plan;
}

}  // namespace

StepPlan plan_steps(const StableSteps& stable, double safety, double requested_window, double interval) {
  if (!(stable.carpet > 0) || !(stable.infill > 0) || !(stable.contact > 0))
    throw_run_error("no stable step: carpet {:.3g} s, infill {:.3g} s, contact {:.3g} s", stable.carpet,
                    stable.infill, stable.contact);
  const double carpet = safety * stable.carpet;
  const double infill = safety / std::hypot(1 / stable.infill, 1 / stable.contact);
  double window = requested_window > 0 ? requested_window : std::max(infill, carpet);
  window = std::min(window, std::max(infill, safety * stable.contact / std::sqrt(2.0)));
  StepPlan plan;
  plan.windows = parts(interval, window);
  plan.window = interval / plan.windows;
  plan.carpet_substeps = parts(plan.window, carpet);
  if (stable.carpet_ratio > 1) plan = fit_subcycle(plan, stable.carpet_ratio, interval);
  plan.infill_substeps = parts(plan.window, infill);
  return plan;
}

}  // namespace tuft::coupler

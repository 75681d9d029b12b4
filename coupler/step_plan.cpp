#include "coupler/step_plan.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace tuft::coupler {
namespace {

/// Smallest whole number of equal parts none of which is longer than `longest`. Rounding must not add a part
/// when it fits.
int parts(double whole, double longest) {
  return std::max(1, static_cast<int>(std::ceil(whole / longest * (1 - 1e-12))));
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
  plan.infill_substeps = parts(plan.window, infill);
  return plan;
}

}  // namespace tuft::coupler

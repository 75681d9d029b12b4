#include "sph_infill/stable_step.h"

namespace tuft::sph {

StepLimit make_step_limit(const SphOptions& options, bool artificial_viscosity) {
  StepLimit limit;
  limit.smoothing_length = options.smoothing_length;
  limit.elastic_factor = 0.5;
  if (artificial_viscosity) {
    limit.viscosity_linear = options.viscosity_linear;
    limit.viscosity_quadratic = options.viscosity_quadratic;
  }
  return limit;
}

}  // namespace tuft::sph

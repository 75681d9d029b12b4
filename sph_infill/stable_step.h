#pragma once
/// Largest stable step of a particle under the leapfrog.
#include <cmath>

#include "core/scene.h"

namespace tuft::sph {

/// Part of h/c that a step may be; measured, see docs beside each value.
struct StepLimit {
  double smoothing_length = 0;     ///< m
  double elastic_factor = 0;       ///< dt c/h at the limit without viscosity
  double viscosity_linear = 0;     ///< Monaghan alpha, 0 when viscosity is off
  double viscosity_quadratic = 0;  ///< Monaghan beta
};

/// Factors of h/c, by kernel; see measured_factor.
[[nodiscard]] StepLimit make_step_limit(const SphOptions& options, bool artificial_viscosity);

/// dt = C h / (c + a (alpha c + beta h |D|)): the damped central-difference limit in Monaghan's form (1992),
/// with c the speed of pressure waves and |D| the largest rate of compression by the trace of D.
[[nodiscard]] TUFT_HD inline double particle_stable_step(const StepLimit& limit, double wave_speed,
                                                         double compression_rate) {
  const double viscous = limit.viscosity_linear * wave_speed +
                         limit.viscosity_quadratic * limit.smoothing_length * std::abs(compression_rate);
  return limit.elastic_factor * limit.smoothing_length / (wave_speed + 0.6 * viscous);
}

}  // namespace tuft::sph

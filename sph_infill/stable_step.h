#pragma once
/// Largest stable step of the leapfrog, estimated particle by particle.
///
/// The leapfrog is stable for dt <= 2/omega, omega the highest frequency of the particles. Stress power is
/// P = sum_i V_i M |L_i|^2 at most (M the constrained modulus), and in mass-scaled velocities sqrt(m_j) v_j
/// row i of L has the squared length R_i = sum_j V_j^2 |B_i g_ij|^2/m_j + |B_i sum_j V_j g_ij|^2/m_i, so
/// omega_i^2 = V_i M_i R_i is a frequency of the order of omega. It follows disorder, free surfaces and
/// corners, compression, layers of unlike density and any kernel, which a fixed share of h/c does not: there
/// the limit itself varies from 0.66 to 1.25 h/c.
///
/// Measured (elastic cube of 8^3 particles with free faces and random velocities, no viscosity, 1200 steps,
/// dt bisected to 2 % until the kinetic energy triples): omega/max omega_i = 1.11-1.16 for h = 1.3 pitch,
/// Wendland C2, and 0.91-1.05 for h = 0.71 pitch, cubic spline; regular, jittered by 0.1 and 0.25 pitch,
/// squeezed by 20 %. So dt = 2/(1.16 omega_i), rounded down, is below the limit by 2-6 % and by 11-23 %.
#include <cmath>
#include <type_traits>

#include "core/scene.h"

namespace tuft::sph {

/// dt omega_i that is still stable.
inline constexpr double stable_phase = 1.7;

struct StepLimit {
  double smoothing_length = 0;       ///< m
  double viscosity_linear = 0;       ///< Monaghan alpha, 0 when viscosity is off
  double viscosity_quadratic = 0;    ///< Monaghan beta
  double zero_energy_viscosity = 0;  ///< zeta, 0 when zero-energy modes are not controlled
};

[[nodiscard]] inline StepLimit make_step_limit(const SphOptions& options, bool artificial_viscosity,
                                               bool zero_energy_control = false) {
  StepLimit limit{options.smoothing_length};
  if (artificial_viscosity) {
    limit.viscosity_linear = options.viscosity_linear;
    limit.viscosity_quadratic = options.viscosity_quadratic;
  }
  if (zero_energy_control) limit.zero_energy_viscosity = options.zero_energy_viscosity;
  return limit;
}

/// frequency: omega_i, 1/s. wave_speed: c, m/s. strain_rate: |D| = sqrt(D : D), 1/s.
///
/// Viscosity acts with the velocity half a step behind, as a damping ratio xi would:
/// dt = (2/omega)(sqrt(1 + xi^2) - xi). Measured: xi = 0.10-0.12 alpha; its quadratic term has alpha c + beta
/// h |D| in place of alpha c; 0.38 zeta of the control of zero-energy modes. |D| is added to the frequency,
/// for the geometry behind omega_i changes by |D| dt within the step.
template <class Real>
[[nodiscard]] TUFT_HD Real particle_stable_step(const StepLimit& limit, const Real& frequency,
                                                const std::type_identity_t<Real>& wave_speed,
                                                const std::type_identity_t<Real>& strain_rate) {
  using std::sqrt;
  const Real speed_ratio = limit.smoothing_length * strain_rate / wave_speed;
  const Real xi = 0.12 * (limit.viscosity_linear + limit.viscosity_quadratic * speed_ratio) +
                  0.4 * limit.zero_energy_viscosity;
  return stable_phase / (frequency + strain_rate) * (sqrt(1.0 + xi * xi) - xi);
}

}  // namespace tuft::sph

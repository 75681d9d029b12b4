#pragma once
/// Largest stable step of the leapfrog, estimated particle by particle.
///
/// The leapfrog is stable for dt <= 2/omega, omega the highest frequency of the particles. Stress power is
/// P = sum_i V_i M |L_i|^2 at most (M the constrained modulus). In mass-scaled velocities sqrt(m_j) v_j the
/// squared length of row i of L has the parts
///
///   R = sum_j V_j^2 |B_i g_ij|^2 / m_j   of its neighbours and   S = |B_i sum_j V_j g_ij|^2 / m_i
///
/// of its own: 0 where the neighbourhood is full, the larger of the two at a free surface. The row alone says
/// V_i M (R + S). But inside a body neighbouring rows act together: a plane wave, of which a row sees
/// |sum_j V_j B g_ij sin(k.x_ij)|, drives kappa times as fast as the row alone, kappa = 2.05 with 80
/// neighbours and 1.41 with 18; at a surface or an edge they hardly do. So
///
///   omega_i^2 = V_i M (kappa^2 max(1, V_0/V_i) R / (1 + S/R)^2 + 2.05 S)
///
/// with kappa of the perfect lattice, which is exact there, and V_0/V_i for what is squeezed: the wave is as
/// short as the kernel allows, the lattice finer, and R less. The rest is fitted to the highest frequencies
/// of 7^3 particles, elastic (G/K 0.5 and 1.5): periodic, between two free faces, and free all round; on the
/// lattice and thrown off it by 0.1 and 0.2 pitch; squeezed by 20 and 40 %; uniform, and with a layer of 50
/// times the stiffness in the middle or on top. omega/max omega_i = 0.57-1.00 (h = 1.3 pitch, Wendland C2),
/// 0.61-1.03 (h = pitch, cubic spline), 0.52-1.01 (h = 0.71 pitch): the low ones are thin stiff layers. The
/// row alone, with one factor for all, is off by 0.73-2.21 (all presets): what was stable at a free surface shook the
/// inside of a bed apart. docs/theory/sph.md, tests/verification/sph_infill/stability_test.cpp.
#include <cmath>
#include <type_traits>

#include "core/scene.h"

namespace tuft::sph {

struct StepLimit {
  double smoothing_length = 0;       ///< m
  double viscosity_linear = 0;       ///< Monaghan alpha, 0 when viscosity is off
  double viscosity_quadratic = 0;    ///< Monaghan beta
  double zero_energy_viscosity = 0;  ///< zeta, 0 when zero-energy modes are not controlled
  double coherence_squared = 0;      ///< kappa^2
  double damping_inside = 0;         ///< xi inside a body, of the linear viscosity and zeta
  double damping_per_alpha = 0;      ///< and of the quadratic one, over what it adds to alpha
  double lattice_volume = 0;         ///< m^3, V_0: pitch cubed; 0: each particle's as placed
};

/// Plane waves of a cubic lattice. pitch: m, > 0.
struct LatticeWaves {
  /// kappa: the largest |sum_j V_j B g_0j sin(k.x_j)| of all wave vectors, over the root of
  /// sum_j |V_j B g_0j|^2.
  double coherence = 1;
  /// xi such that (2/omega)(sqrt(1 + xi^2) - xi), omega the highest frequency, is the longest step that all
  /// waves bear: omega(k)^2 dt^2 + 2 c(k) dt <= 4, c (1/s) the rate at which viscosity damps them, on all
  /// pairs as when all approach.
  double damping = 0;
};
[[nodiscard]] LatticeWaves lattice_waves(const SphOptions& options, double pitch, double alpha, double zeta);

[[nodiscard]] StepLimit make_step_limit(const SphOptions& options, double pitch, bool artificial_viscosity,
                                        bool zero_energy_control = false);

/// 1/(1 + S/R)^2: 1 inside a body, towards 0 at its edges.
template <class Real>
[[nodiscard]] TUFT_HD Real share_inside(const Real& neighbours, const std::type_identity_t<Real>& own) {
  using std::max;
  const Real share = neighbours / max(Real(1e-300), neighbours + own);
  return share * share;
}

/// omega_i^2 over V_i M, 1/(kg m^2). neighbours: R. own: S. volume, as_placed: V_i and its reference, m^3.
template <class Real>
[[nodiscard]] TUFT_HD Real largest_mobility(const StepLimit& limit, const Real& neighbours,
                                            const std::type_identity_t<Real>& own,
                                            const std::type_identity_t<Real>& volume,
                                            const std::type_identity_t<Real>& as_placed) {
  constexpr double of_own = 2.05;
  using std::max;
  const Real squeezed = max(Real(1), max(Real(limit.lattice_volume), as_placed) / volume);
  return limit.coherence_squared * squeezed * neighbours * share_inside(neighbours, own) + of_own * own;
}

/// frequency: omega_i, 1/s. wave_speed: c, m/s. strain_rate: |D| = sqrt(D : D), 1/s. inside: see
/// share_inside.
///
/// Viscosity acts with the velocity half a step behind, as a damping ratio xi would:
/// dt = (2/omega)(sqrt(1 + xi^2) - xi). At edges, measured on free cubes: xi = 0.10-0.12 alpha and 0.38 zeta
/// of the control of zero-energy modes; inside, that of lattice_waves. The quadratic term has alpha c + beta
/// h |D| in place of alpha c. |D| is added to the frequency, for the geometry behind omega_i changes by |D|
/// dt within the step.
template <class Real>
[[nodiscard]] TUFT_HD Real particle_stable_step(const StepLimit& limit, const Real& frequency,
                                                const std::type_identity_t<Real>& wave_speed,
                                                const std::type_identity_t<Real>& strain_rate,
                                                const std::type_identity_t<Real>& inside) {
  using std::sqrt;
  const Real quadratic = limit.viscosity_quadratic * limit.smoothing_length * strain_rate / wave_speed;
  const Real edge = 0.12 * (limit.viscosity_linear + quadratic) + 0.4 * limit.zero_energy_viscosity,
             full = limit.damping_inside + limit.damping_per_alpha * quadratic;
  const Real xi = edge + inside * (full - edge);
  return 2.0 / (frequency + strain_rate) * (sqrt(1.0 + xi * xi) - xi);
}

}  // namespace tuft::sph

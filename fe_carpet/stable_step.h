#pragma once
/// How fast one shell element can swing, as pure functions of its shape and section. The largest frequency of
/// any mesh is at most that of its stiffest element taken alone with its own share of the lumped mass
/// (Rayleigh's quotient; Irons & Treharne 1971; Hughes 1987, section 9.3), whatever elements share its nodes
/// and wherever it is clamped. So min(2 / frequency) over the elements is a safe central-difference step,
/// shared nodes of different thickness included.
#include <cmath>

#include "fe_carpet/plane_stress.h"

namespace tuft::fe {

/// Rotary inertia over mass, m^2, of a node's share of an element: max(t^2/12, A/5).
///
/// Hughes, Cohen & Haroun (Nucl. Eng. Des. 46, 1978) raise the true t^2/12 of a thin plate to the order of
/// A/8, so that transverse shear, whose frequency grows as 1/inertia, does not govern the step. The one-point
/// element with the ratio a has shear frequency^2 = (kappa G/rho)(4 g + 1/a) against membrane >= (E'/rho) 4
/// g, where g is the larger eigenvalue of sum_I B_aI B_bI and at least 1/A; E'/(kappa G) = 2.4/(1 - nu)
/// >= 2.4, so that a >= A/5.6 is enough for every shape and every nu >= 0. Bending needs a >= t^2/12. The
/// surplus lowers the frequency of a wave of number k by about k^2 a / 2 relative.
TUFT_HD inline double rotary_inertia_ratio(double area, double thickness) {
  const double true_ratio = thickness * thickness / 12, scaled = area / 5;
  return true_ratio > scaled ? true_ratio : scaled;
}

/// Upper bound of the largest angular frequency squared (1/s^2) of a free element about a state without
/// stress. mass: kg, of the element; inertia_ratio: rotary_inertia_ratio at the shape the inertia was made
/// for.
///
/// Families of modes, each exact for a rectangle, from K = A B^T C B with nodal mass m/4 and g1 >= g2 the
/// eigenvalues of sum_I B_aI B_bI:
///   membrane  A t E' / (m/4) * ((g1 + g2) + sqrt((g1 - g2)^2 + 4 nu^2 g1 g2)) / 2, bending the same times
///   t^2/12 / inertia shear     A t kappa G / (m/4) * (g1 + 1/(4 inertia)) hourglass k |gamma|^2 / (m/4),
///   with gamma = h + delta, delta in the span of B: gamma gamma^T <= 2 h h^T + 2 delta
///             delta^T splits it from the modes above (h is orthogonal to B).
template <class Real>
TUFT_HD inline Real frequency_squared_bound(const ShellGeometry<Real>& g, const PlaneStressLaw& law,
                                            const Real& t, const Real& mass, const Real& inertia_ratio) {
  using std::max;
  using std::sqrt;
  const Real g11 = Real(2.0) * (g.b1a * g.b1a + g.b1b * g.b1b),
             g22 = Real(2.0) * (g.b2a * g.b2a + g.b2b * g.b2b);
  const Real g12 = Real(2.0) * (g.b1a * g.b2a + g.b1b * g.b2b);
  const Real half_sum = Real(0.5) * (g11 + g22), half_difference = Real(0.5) * (g11 - g22);
  const Real radius = sqrt(half_difference * half_difference + g12 * g12);
  const Real g1 = half_sum + radius, g2 = half_sum - radius;
  const double nu = law.coupled / law.direct;
  const Real stretch =
      law.direct * (half_sum + sqrt(radius * radius + (nu * nu) * g1 * g2));  // eigenvalue of C B B^T
  const Real per_mass = Real(4.0) / mass, per_inertia = per_mass / inertia_ratio;

  const Real membrane = per_mass * g.area * t * stretch;
  const Real bending = per_inertia * g.area * t * t * t * (1.0 / 12.0) * stretch;
  const Real shear = per_mass * g.area * t * law.transverse_shear * (g1 + Real(0.25) / inertia_ratio);

  const ShellHourglass<Real> one{Real(1.0), Real(1.0), Real(1.0), Real(1.0), Real(1.0)};
  const ShellHourglass<Real> k = hourglass_resistance<Real>(law, t, g, one);
  const Real delta_squared = (g.hx * g.hx + g.hy * g.hy) * g1;
  const Real membrane_hourglass = per_mass * k.mx, deflection_hourglass = per_mass * k.w;
  const Real rotation_hourglass = per_inertia * k.tx;
  const Real plate = max(bending + Real(2.0) * rotation_hourglass * delta_squared,
                         shear + Real(2.0) * deflection_hourglass * delta_squared);
  const Real pure_hourglass =
      Real(8.0) * max(membrane_hourglass, max(deflection_hourglass, rotation_hourglass));
  const Real warp_squared = g.hz * g.hz * g.gradient_norm;
  return max(max(membrane, plate) + Real(2.0) * membrane_hourglass * (delta_squared + warp_squared),
             pure_hourglass);
}

}  // namespace tuft::fe

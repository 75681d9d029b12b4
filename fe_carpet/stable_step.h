#pragma once
/// How fast one shell element can swing, as pure functions of its shape and section. The largest frequency of
/// any mesh is at most that of its stiffest element taken alone with its own share of the lumped mass
/// (Rayleigh's quotient; Irons & Treharne 1971; Hughes 1987, section 9.3), whatever elements share its nodes
/// and wherever it is clamped. So min(2 / frequency) over the elements is a safe central-difference step,
/// shared nodes of different thickness included.
#include <cmath>

#include "fe_carpet/shell_section.h"

namespace tuft::fe {

/// Rotary inertia over mass, m^2, of a node's share of an element: A/5 + 1.4 t^2/12.
///
/// Hughes, Cohen & Haroun (Nucl. Eng. Des. 46, 1978) raise the true t^2/12 of a thin plate to the order of
/// A/8, so that transverse shear, whose frequency grows as 1/inertia, does not govern the step. The element's
/// mean shear has frequency^2 = (kappa G/rho)(4 g + 1/a) with the ratio a, against membrane >= (E'/rho) 4 g,
/// where g is the larger eigenvalue of sum_I B_aI B_bI and at least 1/A; E'/(kappa G) = 2.4/(1 - nu) >= 2.4,
/// so that a >= A/5.6 is enough for every shape and every nu >= 0. Bending has t^2/12a of the membrane's
/// frequency^2, and the slopes of shear, which share its modes, at most 0.28 (1 + A/4a): 1.4 t^2/12 leaves
/// room for them in thick elements too. The surplus lowers the frequency of a wave of number k by about
/// k^2 a / 2 relative.
TUFT_HD inline double rotary_inertia_ratio(double area, double thickness) {
  return area / 5 + 1.4 * thickness * thickness / 12;
}

/// Hourglass viscosity, in N m s and N s/m: the share `ratio` of what would damp each mode critically. In
/// `spin` and its deviations there is none.
template <class Real>
TUFT_HD inline ModeStiffness<Real> mode_damping(const ShellFrame<Real>& f, const ModeStiffness<Real>& k,
                                                const Real& mass, const Real& inertia_ratio, double ratio) {
  using std::sqrt;
  const auto damping = [ratio](const Real& stiffness, const Real& modal_mass) {
    return Real(2 * ratio) * sqrt(stiffness * modal_mass);
  };
  const Real zero(0.0), inertia = mass * inertia_ratio;
  return {damping(k.fibre_xi, mass * (f.x_xi * f.x_xi + f.y_xi * f.y_xi)),
          damping(k.fibre_eta, mass * (f.x_eta * f.x_eta + f.y_eta * f.y_eta)),
          damping(k.turn_xx, inertia),
          zero,
          damping(k.turn_yy, inertia),
          damping(k.shear_xi_eta, mass),
          damping(k.shear_eta_xi, mass),
          zero,
          zero};
}

/// Upper bound of the largest angular frequency squared (1/s^2) of a free element about a state without
/// stress. mass: kg, of the element; inertia_ratio: rotary_inertia_ratio at the shape the inertia was made
/// for; k: of the element's modes beyond the centre's strains.
///
/// In modes (xi, eta, h, mean) of the nodal values the mass matrix is m (inertia: m a) times the unit matrix,
/// and a stiffness c row^T row has the eigenvalue c |row|^2 / m. For a flat parallelogram the families
///
///   {u_xi, u_eta}: membrane     {u_h}: fibres          {r_z, u_xi, u_eta}: drilling
///   {w_xi, w_eta, r_mean}: mean shear                  {r_xi, r_eta, w_h}: bending and shear's slopes
///   {r_h}: hourglass of the rotations
///
/// do not share a mode, but for drilling, which is added. Other shapes mix them: a row a + b with its parts
/// in two families has c (a + b)(a + b)^T <= c (|a|^2 + |a||b|) on the one and c (|b|^2 + |a||b|) on the
/// other.
template <class Real>
TUFT_HD inline Real frequency_squared_bound(const ShellFrame<Real>& f, const IsotropicLaw& law, const Real& t,
                                            const Real& mass, const Real& inertia_ratio,
                                            const ModeStiffness<Real>& k) {
  using std::max;
  using std::min;
  using std::sqrt;
  // Eigenvalues of the squared gradient.
  const Real g11 = f.xi_x * f.xi_x + f.eta_x * f.eta_x, g22 = f.xi_y * f.xi_y + f.eta_y * f.eta_y;
  const Real g12 = f.xi_x * f.xi_y + f.eta_x * f.eta_y;
  const Real half_sum = Real(0.5) * (g11 + g22), half_difference = Real(0.5) * (g11 - g22);
  const Real radius = sqrt(half_difference * half_difference + g12 * g12);
  const Real g1 = half_sum + radius, g2 = half_sum - radius;
  const Real per_mass = Real(1.0) / mass, per_inertia = per_mass / inertia_ratio;
  const Real over_ratio = Real(1.0) / inertia_ratio;
  const double nu = law.poisson;
  const Real stretch =
      law.direct * (half_sum + sqrt(radius * radius + (nu * nu) * g1 * g2));  // eigenvalue of C B B^T
  const Real volume = f.area * t;

  // How far from a parallelogram: part of an hourglass row that linear fields see.
  const Real taper_squared = f.x_h * f.x_h + f.y_h * f.y_h, mixed_squared = taper_squared * g1;
  const Real mixed = sqrt(mixed_squared);

  const Real xi_squared = f.x_xi * f.x_xi + f.y_xi * f.y_xi,
             eta_squared = f.x_eta * f.x_eta + f.y_eta * f.y_eta;
  const Real across_xi = k.fibre_xi / (xi_squared * xi_squared),
             across_eta = k.fibre_eta / (eta_squared * eta_squared);
  const Real f11 = across_xi * f.x_xi * f.x_xi + across_eta * f.x_eta * f.x_eta;
  const Real f22 = across_xi * f.y_xi * f.y_xi + across_eta * f.y_eta * f.y_eta;
  const Real f12 = across_xi * f.x_xi * f.y_xi + across_eta * f.x_eta * f.y_eta;
  const Real f_difference = Real(0.5) * (f11 - f22);
  const Real fibres = per_mass * (Real(0.5) * (f11 + f22) + sqrt(f_difference * f_difference + f12 * f12));
  const Real drilling = k.spin * (per_inertia + Real(0.5) * half_sum * per_mass);
  const Real membrane = drilling + max(per_mass * volume * stretch + fibres * (mixed_squared + mixed),
                                       fibres * (Real(1.0) + mixed));

  const Real shear = volume * law.transverse_shear;
  const Real shear_mean = per_mass * shear * (g1 + over_ratio);
  const Real shear_mean_taper = per_mass * shear * mixed_squared * over_ratio;
  const Real bending = per_inertia * volume * t * t * (1.0 / 12.0) * stretch;
  const Real taper_over = taper_squared * over_ratio;
  const Real slopes = per_mass * (k.shear_xi_eta * (Real(1.0) + xi_squared * over_ratio) +
                                  k.shear_eta_xi * (Real(1.0) + eta_squared * over_ratio));
  const Real slopes_taper = per_mass * (k.shear_xi_eta + k.shear_eta_xi) * taper_over;
  const Real turns = per_inertia * (k.turn_xx + k.turn_yy);
  const Real plate =
      max(max(shear_mean + slopes_taper, bending + slopes + shear_mean_taper + turns * mixed_squared),
          turns) +
      sqrt(shear_mean * shear_mean_taper) + sqrt(slopes * slopes_taper) + turns * mixed;
  // Off the centre the inverse Jacobian is at most 1/(1 - e) of the centre's.
  const Real e = min(Real(0.9), Real(0.8165) * mixed), within = Real(1.0) - e;
  const Real plate_at_points = plate * (Real(1.0) + e) / (within * within);

  const Real warp = sqrt(f.z_h * f.z_h * g1);
  // Curvatures that membrane strains and the drilling spin bring with the warp: |z,xx| and the like are at
  // most |z_h| g1. The cross term with bending is at most twice the root of the product.
  const Real twist = f.z_h * f.z_h * g1 * g1 * volume * t * t * (1.0 / 12.0) * Real(2.0 * law.direct) *
                     (per_mass * g1 + per_inertia);
  return max(membrane, plate_at_points) + fibres * (warp * warp + warp) + twist +
         Real(2.0) * sqrt(twist * bending);
}

}  // namespace tuft::fe

#pragma once
/// The kinematics that both shell elements share: from the motion of four nodes to strains, and from forces
/// conjugate to these strains back to the nodes. Pure functions; work is the same on both sides to rounding.
///
/// A four-node Mindlin element in its own plane with
/// - membrane strains of the bilinear field at the centre, plus the bending of each family of fibres in the
///   plane: a fibre along xi is strained by eta times `fibre_xi`, in uniaxial stress. That is the strain of
///   Pian & Sumihara's stress modes (Int. J. Numer. Meth. Eng. 20 (1984) 1685), so that the element bends in
///   its plane without locking, as a parallelogram too;
/// - curvatures of the bilinear rotations, at the centre plus what their hourglass modes add;
/// - transverse shear as assumed by Dvorkin & Bathe (Eng. Comput. 1 (1984) 77): covariant, taken in the
/// middle
///   of the sides, so that thin elements do not lock and pure bending has no shear on any shape;
/// - a drilling spin: the mean nodal rotation about the normal less the spin of the plane. Its penalty
/// couples
///   the nodes' rotations about the normal to the membrane (which a twisted strip needs) without stiffening
///   in-plane bending, as a penalty node by node would. Deviations from the mean have a far weaker one, so
///   that none is without any stiffness.
///
/// In a warped element the nodes stand z_h above and below its plane by turns. A spin of the plane moves them
/// in it, which is freed from the membrane's bending modes (a projection onto motions without rigid rotation,
/// after Rankin & Nour-Omid, Comput. Struct. 30 (1988) 257). Without it a twisted strip of thickness 1/340 of
/// its width is 1e4 times too stiff. In turn the drilling spin, which turns the sloping surface about the
/// normal, enters the curvatures with the warp (as do membrane strains, to the order strain x curvature;
/// after Belytschko, Wong & Chiang, Comput. Methods Appl. Mech. Eng. 96 (1992) 93). Without it the thick
/// twisted beam depends on the drilling penalty by 3 %, with it by 0.1 %.
#include "fe_carpet/shell_frame.h"

namespace tuft::fe {

/// Strain increments, or the forces that are conjugate to them and integrated over the element.
template <class Real>
struct ShellModes {
  Real exx, eyy, gxy;              ///< membrane at the centre, engineering shear | N m
  Real kxx, kyy, kxy;              ///< 1/m, strain at height z is e + z k | N m^2
  Real shear_xi, shear_xi_eta;     ///< m, covariant transverse shear along xi: mean, and slope over eta | N
  Real shear_eta, shear_eta_xi;    ///< m, the same along eta
  Real fibre_xi, fibre_eta;        ///< strain of fibres along xi at eta = 1, along eta at xi = 1 | N m
  Real turn_x, turn_y;             ///< rad, hourglass modes of the rotations about local x and y | N m
  Real spin;                       ///< rad, mean nodal rotation about the normal less the plane's | N m
  Real spin_xi, spin_eta, spin_h;  ///< rad, its deviations from the mean
};

/// Second derivatives of the height z_h xi eta of a warped element's surface, at its centre. 1/m.
template <class Real>
struct WarpCurvature {
  Real xx, yy, xy;
};

template <class Real>
TUFT_HD inline WarpCurvature<Real> warp_curvature(const ShellFrame<Real>& f) {
  const Real twice = Real(2.0) * f.z_h;
  return {twice * f.xi_x * f.eta_x, twice * f.xi_y * f.eta_y, f.z_h * (f.xi_x * f.eta_y + f.xi_y * f.eta_x)};
}

/// d: displacement increments, r: rotation increments with their mean, all global; f is the frame halfway
/// through the step (Hughes & Winget 1980): a finite rigid rotation then gives no strain at all, provided
/// that its increment is given as 2 tan(angle/2) about its axis.
template <class Real>
TUFT_HD inline ShellModes<Real> strain_increments(const ShellFrame<Real>& f,
                                                  const CornerModes<Real>& d_global,
                                                  const CornerModes<Real>& r_global,
                                                  const Triple<Real>& r_mean_global) {
  const CornerModes<Real> d = to_local(f.axes, d_global), r = to_local(f.axes, r_global);
  const Triple<Real> r0 = to_local(f.axes, r_mean_global);
  const auto along_x = [&f](const Real& xi, const Real& eta) { return f.xi_x * xi + f.eta_x * eta; };
  const auto along_y = [&f](const Real& xi, const Real& eta) { return f.xi_y * xi + f.eta_y * eta; };
  const Real ux_x = along_x(d.xi.x, d.eta.x), ux_y = along_y(d.xi.x, d.eta.x);
  const Real uy_x = along_x(d.xi.y, d.eta.y), uy_y = along_y(d.xi.y, d.eta.y);
  const Real uz_x = along_x(d.xi.z, d.eta.z), uz_y = along_y(d.xi.z, d.eta.z);
  const Real rx_x = along_x(r.xi.x, r.eta.x), rx_y = along_y(r.xi.x, r.eta.x);
  const Real ry_x = along_x(r.xi.y, r.eta.y), ry_y = along_y(r.xi.y, r.eta.y);

  ShellModes<Real> s;
  s.exx = ux_x;
  s.eyy = uy_y;
  s.gxy = ux_y + uy_x;
  s.spin = r0.z - Real(0.5) * (uy_x - ux_y);
  const WarpCurvature<Real> z = warp_curvature(f);
  const Real shear = Real(0.5) * s.gxy;
  s.kxx = ry_x + z.xx * s.exx + z.xy * (shear + s.spin);
  s.kyy = -rx_y + z.yy * s.eyy + z.xy * (shear - s.spin);
  s.kxy = ry_y - rx_x + z.xy * (s.exx + s.eyy) + shear * (z.xx + z.yy) + s.spin * (z.yy - z.xx);

  // Hourglass parts, blind to linear fields, and freed of the plane's spin in a warped element: u_x = spin z,
  // u_z,x = -spin.
  const Real qx = d.h.x - f.x_h * ux_x - f.y_h * ux_y + f.z_h * uz_x;
  const Real qy = d.h.y - f.x_h * uy_x - f.y_h * uy_y + f.z_h * uz_y;
  s.fibre_xi = (f.x_xi * qx + f.y_xi * qy) / (f.x_xi * f.x_xi + f.y_xi * f.y_xi);
  s.fibre_eta = (f.x_eta * qx + f.y_eta * qy) / (f.x_eta * f.x_eta + f.y_eta * f.y_eta);
  s.turn_x = r.h.x - f.x_h * rx_x - f.y_h * rx_y;
  s.turn_y = r.h.y - f.x_h * ry_x - f.y_h * ry_y;

  // w,xi + x,xi r_y - y,xi r_x in the middle of the sides eta = -1 and 1: their mean and half difference.
  s.shear_xi = d.xi.z + f.x_xi * r0.y + f.x_h * r.eta.y - f.y_xi * r0.x - f.y_h * r.eta.x;
  s.shear_xi_eta = d.h.z + f.x_xi * r.eta.y + f.x_h * r0.y - f.y_xi * r.eta.x - f.y_h * r0.x;
  s.shear_eta = d.eta.z + f.x_eta * r0.y + f.x_h * r.xi.y - f.y_eta * r0.x - f.y_h * r.xi.x;
  s.shear_eta_xi = d.h.z + f.x_eta * r.xi.y + f.x_h * r0.y - f.y_eta * r.xi.x - f.y_h * r0.x;

  s.spin_xi = r.xi.z;
  s.spin_eta = r.eta.z;
  s.spin_h = r.h.z;
  return s;
}

/// Forces of one element on its nodes, conjugate to the nodes' modes and in global axes: a corner's force is
/// (+-xi +-eta +-h)/4, its moment the same plus mean/4. Internal forces: to be subtracted from the loads.
template <class Real>
struct ShellForces {
  CornerModes<Real> force;   ///< N
  CornerModes<Real> moment;  ///< N m
  Triple<Real> mean_moment;  ///< N m
};

/// The transpose of strain_increments at the frame f: forces that do the work s . strain.
template <class Real>
TUFT_HD inline ShellForces<Real> nodal_forces(const ShellFrame<Real>& f, const ShellModes<Real>& s) {
  const Real over_xi = Real(1.0) / (f.x_xi * f.x_xi + f.y_xi * f.y_xi);
  const Real over_eta = Real(1.0) / (f.x_eta * f.x_eta + f.y_eta * f.y_eta);
  const Real along_xi = s.fibre_xi * over_xi, along_eta = s.fibre_eta * over_eta;
  const Real qx = f.x_xi * along_xi + f.x_eta * along_eta, qy = f.y_xi * along_xi + f.y_eta * along_eta;
  const WarpCurvature<Real> z = warp_curvature(f);
  const Real spin = s.spin + z.xy * (s.kxx - s.kyy) + (z.yy - z.xx) * s.kxy, half_spin = Real(0.5) * spin;
  const Real exx = s.exx + z.xx * s.kxx + z.xy * s.kxy, eyy = s.eyy + z.yy * s.kyy + z.xy * s.kxy;
  const Real gxy = s.gxy + Real(0.5) * (z.xy * (s.kxx + s.kyy) + (z.xx + z.yy) * s.kxy);
  const Real ux_x = exx - f.x_h * qx, ux_y = gxy + half_spin - f.y_h * qx;
  const Real uy_x = gxy - half_spin - f.x_h * qy, uy_y = eyy - f.y_h * qy;
  const Real uz_x = f.z_h * qx, uz_y = f.z_h * qy;
  const Real rx_x = -s.kxy - f.x_h * s.turn_x, rx_y = -s.kyy - f.y_h * s.turn_x;
  const Real ry_x = s.kxx - f.x_h * s.turn_y, ry_y = s.kxy - f.y_h * s.turn_y;
  const auto to_xi = [&f](const Real& x, const Real& y) { return f.xi_x * x + f.xi_y * y; };
  const auto to_eta = [&f](const Real& x, const Real& y) { return f.eta_x * x + f.eta_y * y; };

  ShellForces<Real> forces;
  forces.force.xi =
      to_global(f.axes, Triple<Real>{to_xi(ux_x, ux_y), to_xi(uy_x, uy_y), to_xi(uz_x, uz_y) + s.shear_xi});
  forces.force.eta = to_global(
      f.axes, Triple<Real>{to_eta(ux_x, ux_y), to_eta(uy_x, uy_y), to_eta(uz_x, uz_y) + s.shear_eta});
  forces.force.h = to_global(f.axes, Triple<Real>{qx, qy, s.shear_xi_eta + s.shear_eta_xi});
  forces.moment.xi = to_global(
      f.axes, Triple<Real>{to_xi(rx_x, rx_y) - f.y_h * s.shear_eta - f.y_eta * s.shear_eta_xi,
                           to_xi(ry_x, ry_y) + f.x_h * s.shear_eta + f.x_eta * s.shear_eta_xi, s.spin_xi});
  forces.moment.eta = to_global(
      f.axes, Triple<Real>{to_eta(rx_x, rx_y) - f.y_h * s.shear_xi - f.y_xi * s.shear_xi_eta,
                           to_eta(ry_x, ry_y) + f.x_h * s.shear_xi + f.x_xi * s.shear_xi_eta, s.spin_eta});
  forces.moment.h = to_global(f.axes, Triple<Real>{s.turn_x, s.turn_y, s.spin_h});
  const Real h_shear = s.shear_xi_eta + s.shear_eta_xi;
  forces.mean_moment =
      to_global(f.axes, Triple<Real>{-f.y_xi * s.shear_xi - f.y_eta * s.shear_eta - f.y_h * h_shear,
                                     f.x_xi * s.shear_xi + f.x_eta * s.shear_eta + f.x_h * h_shear, spin});
  return forces;
}

}  // namespace tuft::fe

#pragma once
/// The one-point corotational quadrilateral shell of Belytschko, Lin & Tsay, "Explicit algorithms for the
/// nonlinear dynamics of shells", Comput. Methods Appl. Mech. Eng. 42 (1984) 225-251, as pure functions:
/// geometry, strain increments, stress update, nodal forces. No loops over elements, no memory but the
/// arguments.
///
/// Three choices go beyond the paper, each because a finite step or a warped element would otherwise break an
/// invariant (tests/verification/fe_carpet/rigid_motion_test.cpp):
/// - Strain increments are taken in the configuration halfway through the step (Hughes & Winget 1980), so
/// that a finite
///   rigid rotation gives exactly no strain; the paper takes them at its end, which leaves (rotation)^2 / 2 a
///   step.
/// - The local axes bisect the diagonals instead of following side 1-2: they do not depend on which node is
/// numbered
///   first, and they lie in the plane of the diagonals without a further orthogonalisation.
/// - Membrane hourglass rates are freed of the spin of the element's plane. In a warped element, whose nodes
/// stand
///   alternately above and below that plane, the spin would be read as hourglassing; the work-conjugate
///   forces restore the balance of moments.
/// As in the paper, warping does not couple membrane and bending (no Belytschko-Wong-Chiang terms).
///
/// Known limits, held as tests: in a strip one element wide, bending in the strip's plane (3/2 r (1 +
/// a^2/b^2) of the beam's stiffness) and torsion (kappa r (a^2 + b^2) / 4ab of the strip's) are resisted by
/// the hourglass control of coefficient r alone; off parallelograms a constant moment comes with spurious
/// transverse shear.
#include <cmath>

#include "core/vector.h"

namespace tuft::fe {

template <class Real>
struct Triple {
  Real x, y, z;
};

template <class Real>
TUFT_HD inline Triple<Real> operator+(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real>
TUFT_HD inline Triple<Real> operator-(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Real>
TUFT_HD inline Triple<Real> operator*(const Real& s, const Triple<Real>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Real>
TUFT_HD inline Real dot(const Triple<Real>& a, const Triple<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
TUFT_HD inline Triple<Real> cross(const Triple<Real>& a, const Triple<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A nodal field f of the element in the three combinations that the one-point element sees. The gradient
/// operator is antisymmetric across the diagonals, B_3 = -B_1 and B_4 = -B_2, so differences along the
/// diagonals carry the gradient, and the hourglass vector h = (1, -1, 1, -1) the rest.
template <class Real>
struct DiagonalForm {
  Triple<Real> along13;    ///< f1 - f3
  Triple<Real> along24;    ///< f2 - f4
  Triple<Real> hourglass;  ///< h . f = f1 - f2 + f3 - f4
};

template <class Real>
TUFT_HD inline DiagonalForm<Real> diagonal_form(const Triple<Real>& f1, const Triple<Real>& f2,
                                                const Triple<Real>& f3, const Triple<Real>& f4) {
  return {f1 - f3, f2 - f4, (f1 + f3) - (f2 + f4)};
}

template <class Real>
struct LocalAxes {
  Triple<Real> e1, e2, e3;
};

template <class Real>
TUFT_HD inline Triple<Real> to_local(const LocalAxes<Real>& axes, const Triple<Real>& v) {
  return {dot(axes.e1, v), dot(axes.e2, v), dot(axes.e3, v)};
}
template <class Real>
TUFT_HD inline Triple<Real> to_global(const LocalAxes<Real>& axes, const Triple<Real>& v) {
  return v.x * axes.e1 + v.y * axes.e2 + v.z * axes.e3;
}

/// What the element needs to know of its shape in one configuration.
template <class Real>
struct ShellGeometry {
  LocalAxes<Real> axes;
  Real area;  ///< m^2, projected on the plane of the diagonals; negative when turned inside out
  Real b1a, b1b, b2a,
      b2b;          ///< 1/m, gradient B_1I, B_2I of nodes 1 (a) and 2 (b); nodes 3, 4 have the opposite sign
  Real hx, hy, hz;  ///< m, h . coordinates; hz measures the warp
  Real gradient_norm;  ///< 1/m^2, B_aI B_aI summed over directions and nodes
};

/// B_1 = [y24, y31, y42, y13] / 2A, B_2 = [x42, x13, x24, x31] / 2A (Belytschko, Lin & Tsay 1984).
template <class Real>
TUFT_HD inline ShellGeometry<Real> shell_geometry(const DiagonalForm<Real>& x) {
  using std::sqrt;
  const Triple<Real> u = Real(-1.0) * x.along13, w = Real(-1.0) * x.along24;
  // The bisectors of the directions u/|u| and w/|w|, scaled by |u||w| to save divisions; they are orthogonal
  // because both terms have one length.
  const Real length_u = sqrt(dot(u, u)), length_w = sqrt(dot(w, w));
  const Triple<Real> p = length_w * u - length_u * w, q = length_w * u + length_u * w;
  ShellGeometry<Real> g;
  g.axes.e1 = (Real(1.0) / sqrt(dot(p, p))) * p;
  g.axes.e2 = (Real(1.0) / sqrt(dot(q, q))) * q;
  g.axes.e3 = cross(g.axes.e1, g.axes.e2);
  const Real ux = dot(g.axes.e1, u), uy = dot(g.axes.e2, u);
  const Real wx = dot(g.axes.e1, w), wy = dot(g.axes.e2, w);
  const Real twice_area = ux * wy - wx * uy;
  const Real inverse = Real(1.0) / twice_area;
  g.area = Real(0.5) * twice_area;
  g.b1a = -wy * inverse;
  g.b1b = uy * inverse;
  g.b2a = wx * inverse;
  g.b2b = -ux * inverse;
  const Triple<Real> h = to_local(g.axes, x.hourglass);
  g.hx = h.x;
  g.hy = h.y;
  g.hz = h.z;
  g.gradient_norm = Real(2.0) * (g.b1a * g.b1a + g.b1b * g.b1b + g.b2a * g.b2a + g.b2b * g.b2b);
  return g;
}

/// Increments over one step, local axes: generalised strains of the mid-surface and the five hourglass modes.
template <class Real>
struct ShellStrain {
  Real exx, eyy, gxy;  ///< membrane, engineering shear
  Real kxx, kyy, kxy;  ///< 1/m, strain at height z is e + z k
  Real gxz, gyz;       ///< transverse shear
};

template <class Real>
struct ShellHourglass {
  Real mx, my;  ///< membrane
  Real w;       ///< out of plane
  Real tx, ty;  ///< rotation
};

/// d: displacement increments, r: rotation increments (angular velocity x step), r_sum: sum of r over the
/// four nodes. All global; g is the geometry halfway through the step.
template <class Real>
TUFT_HD inline void strain_increments(const ShellGeometry<Real>& g, const DiagonalForm<Real>& d,
                                      const DiagonalForm<Real>& r, const Triple<Real>& r_sum,
                                      ShellStrain<Real>& strain, ShellHourglass<Real>& hourglass) {
  const Triple<Real> d13 = to_local(g.axes, d.along13), d24 = to_local(g.axes, d.along24);
  const Triple<Real> dh = to_local(g.axes, d.hourglass);
  const Real r13x = dot(g.axes.e1, r.along13), r13y = dot(g.axes.e2, r.along13);
  const Real r24x = dot(g.axes.e1, r.along24), r24y = dot(g.axes.e2, r.along24);
  const Real rhx = dot(g.axes.e1, r.hourglass), rhy = dot(g.axes.e2, r.hourglass);
  const Real mean_rx = Real(0.25) * dot(g.axes.e1, r_sum), mean_ry = Real(0.25) * dot(g.axes.e2, r_sum);

  const Real ux_x = g.b1a * d13.x + g.b1b * d24.x, ux_y = g.b2a * d13.x + g.b2b * d24.x;
  const Real uy_x = g.b1a * d13.y + g.b1b * d24.y, uy_y = g.b2a * d13.y + g.b2b * d24.y;
  const Real uz_x = g.b1a * d13.z + g.b1b * d24.z, uz_y = g.b2a * d13.z + g.b2b * d24.z;
  const Real rx_x = g.b1a * r13x + g.b1b * r24x, rx_y = g.b2a * r13x + g.b2b * r24x;
  const Real ry_x = g.b1a * r13y + g.b1b * r24y, ry_y = g.b2a * r13y + g.b2b * r24y;

  strain.exx = ux_x;
  strain.eyy = uy_y;
  strain.gxy = ux_y + uy_x;
  strain.kxx = ry_x;
  strain.kyy = -rx_y;
  strain.kxy = ry_y - rx_x;
  strain.gxz = uz_x + mean_ry;
  strain.gyz = uz_y - mean_rx;

  // gamma . f with gamma_I = h_I - (h . x_a) B_aI (Flanagan & Belytschko 1981), blind to linear fields. The
  // plane's own spin, -uz_x about local y and uz_y about local x, moves the warped nodes in the plane by spin
  // x height.
  hourglass.mx = dh.x - g.hx * ux_x - g.hy * ux_y + g.hz * uz_x;
  hourglass.my = dh.y - g.hx * uy_x - g.hy * uy_y + g.hz * uz_y;
  hourglass.w = dh.z - g.hx * uz_x - g.hy * uz_y;
  hourglass.tx = rhx - g.hx * rx_x - g.hy * rx_y;
  hourglass.ty = rhy - g.hx * ry_x - g.hy * ry_y;
}

/// Forces per length (N/m), moments per length (N), transverse shear per length (N/m).
template <class Real>
struct ShellResultants {
  Real nxx, nyy, nxy, mxx, myy, mxy, qxz, qyz;
};

/// Forces of one element on its nodes' motion (internal forces: to be subtracted from the loads), global
/// axes. Corner forces: 1 along13 + hourglass, 2 along24 - hourglass, 3 -along13 + hourglass, 4 -along24 -
/// hourglass; moments likewise, plus `mean` on every node.
template <class Real>
struct ShellForces {
  DiagonalForm<Real> force;   ///< N
  DiagonalForm<Real> moment;  ///< N m
  Triple<Real> mean_moment;   ///< N m, from transverse shear
};

/// Work-conjugate to strain_increments; g is the geometry at the end of the step. mz stays zero: no drilling
/// stiffness.
template <class Real>
TUFT_HD inline ShellForces<Real> nodal_forces(const ShellGeometry<Real>& g, const ShellResultants<Real>& s,
                                              const ShellHourglass<Real>& q) {
  const Real b1a = g.area * g.b1a, b1b = g.area * g.b1b, b2a = g.area * g.b2a, b2b = g.area * g.b2b;
  // Gradient part of gamma at nodes 1 and 2.
  const Real ga = g.hx * g.b1a + g.hy * g.b2a, gb = g.hx * g.b1b + g.hy * g.b2b;
  const Real warp_a = g.hz * (g.b1a * q.mx + g.b2a * q.my), warp_b = g.hz * (g.b1b * q.mx + g.b2b * q.my);
  const Real zero(0.0), quarter_area = Real(0.25) * g.area;

  const Triple<Real> f13{b1a * s.nxx + b2a * s.nxy - ga * q.mx, b2a * s.nyy + b1a * s.nxy - ga * q.my,
                         b1a * s.qxz + b2a * s.qyz - ga * q.w + warp_a};
  const Triple<Real> f24{b1b * s.nxx + b2b * s.nxy - gb * q.mx, b2b * s.nyy + b1b * s.nxy - gb * q.my,
                         b1b * s.qxz + b2b * s.qyz - gb * q.w + warp_b};
  const Triple<Real> m13{-(b2a * s.myy + b1a * s.mxy) - ga * q.tx, b1a * s.mxx + b2a * s.mxy - ga * q.ty,
                         zero};
  const Triple<Real> m24{-(b2b * s.myy + b1b * s.mxy) - gb * q.tx, b1b * s.mxx + b2b * s.mxy - gb * q.ty,
                         zero};

  ShellForces<Real> f;
  f.force.along13 = to_global(g.axes, f13);
  f.force.along24 = to_global(g.axes, f24);
  f.force.hourglass = to_global(g.axes, Triple<Real>{q.mx, q.my, q.w});
  f.moment.along13 = m13.x * g.axes.e1 + m13.y * g.axes.e2;
  f.moment.along24 = m24.x * g.axes.e1 + m24.y * g.axes.e2;
  f.moment.hourglass = q.tx * g.axes.e1 + q.ty * g.axes.e2;
  f.mean_moment = (quarter_area * -s.qyz) * g.axes.e1 + (quarter_area * s.qxz) * g.axes.e2;
  return f;
}

}  // namespace tuft::fe

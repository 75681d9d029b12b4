#pragma once
/// Shape of a four-node shell element in its own axes, and nodal fields in the four combinations that a
/// bilinear element knows. Pure functions of their arguments.
#include <cmath>

#include "fe_carpet/triple.h"

namespace tuft::fe {

/// A nodal field in bilinear form, f(xi, eta) = mean + xi f_xi + eta f_eta + xi eta f_h over the square
/// -1 <= xi, eta <= 1 with corners 1 (-1, -1), 2 (1, -1), 3 (1, 1), 4 (-1, 1). The mean is kept apart: most
/// uses do without it.
template <class Real>
struct CornerModes {
  Triple<Real> xi, eta, h;
};

template <class Real>
TUFT_HD inline CornerModes<Real> corner_modes(const Triple<Real>& f1, const Triple<Real>& f2,
                                              const Triple<Real>& f3, const Triple<Real>& f4) {
  const Triple<Real> a = f3 - f1, b = f2 - f4;
  const Real quarter(0.25);
  return {quarter * (a + b), quarter * (a - b), quarter * ((f1 + f3) - (f2 + f4))};
}

template <class Real>
TUFT_HD inline Triple<Real> corner_mean(const Triple<Real>& f1, const Triple<Real>& f2,
                                        const Triple<Real>& f3, const Triple<Real>& f4) {
  return Real(0.25) * ((f1 + f3) + (f2 + f4));
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

template <class Real>
TUFT_HD inline CornerModes<Real> to_local(const LocalAxes<Real>& axes, const CornerModes<Real>& f) {
  return {to_local(axes, f.xi), to_local(axes, f.eta), to_local(axes, f.h)};
}

/// The element in its plane. The axes bisect the diagonals: they do not depend on which node is numbered
/// first, and both diagonals lie in the plane they span, so that the corners stand z_h above and below it by
/// turns.
template <class Real>
struct ShellFrame {
  LocalAxes<Real> axes;
  Real area;                      ///< m^2, projected, >= 0: the normal e3 follows the order of the corners
  Real x_xi, x_eta, x_h;          ///< m, modes of the coordinates
  Real y_xi, y_eta, y_h, z_h;     ///< m
  Real xi_x, xi_y, eta_x, eta_y;  ///< 1/m, inverse of the Jacobian at the centre
};

template <class Real>
TUFT_HD inline ShellFrame<Real> shell_frame(const CornerModes<Real>& x) {
  using std::sqrt;
  const Triple<Real> u = x.xi + x.eta, w = x.eta - x.xi;  // half the diagonals 1-3 and 2-4
  // The bisectors of the directions u/|u| and w/|w|, scaled by |u||w| to save divisions; they are orthogonal
  // because both terms have one length.
  const Real length_u = sqrt(dot(u, u)), length_w = sqrt(dot(w, w));
  const Triple<Real> p = length_w * u - length_u * w, q = length_w * u + length_u * w;
  ShellFrame<Real> f;
  f.axes.e1 = (Real(1.0) / sqrt(dot(p, p))) * p;
  f.axes.e2 = (Real(1.0) / sqrt(dot(q, q))) * q;
  f.axes.e3 = cross(f.axes.e1, f.axes.e2);
  f.x_xi = dot(f.axes.e1, x.xi);
  f.x_eta = dot(f.axes.e1, x.eta);
  f.y_xi = dot(f.axes.e2, x.xi);
  f.y_eta = dot(f.axes.e2, x.eta);
  f.x_h = dot(f.axes.e1, x.h);
  f.y_h = dot(f.axes.e2, x.h);
  f.z_h = dot(f.axes.e3, x.h);
  const Real jacobian = f.x_xi * f.y_eta - f.x_eta * f.y_xi, inverse = Real(1.0) / jacobian;
  f.area = Real(4.0) * jacobian;
  f.xi_x = f.y_eta * inverse;
  f.xi_y = -f.x_eta * inverse;
  f.eta_x = -f.y_xi * inverse;
  f.eta_y = f.x_xi * inverse;
  return f;
}

/// How far an element is from turning inside out within a step: 1 when flat and a parallelogram, 0 or less
/// when its normal has turned by 90 degrees or more since `before`, or the Jacobian at a point of the 2 x 2
/// rule vanishes.
template <class Real>
TUFT_HD inline Real uprightness(const ShellFrame<Real>& before, const ShellFrame<Real>& f) {
  using std::abs;
  using std::min;
  const Real off = abs(f.x_xi * f.y_h - f.x_h * f.y_xi) + abs(f.x_h * f.y_eta - f.x_eta * f.y_h);
  return min(dot(before.axes.e3, f.axes.e3), Real(1.0) - Real(4.0 * 0.57735026918962576) * off / f.area);
}

/// Jacobian at a point (xi, eta) and its inverse.
template <class Real>
struct PointJacobian {
  Real determinant;               ///< m^2 per unit of (xi, eta); element area is the integral over the square
  Real xi_x, xi_y, eta_x, eta_y;  ///< 1/m
};

template <class Real>
TUFT_HD inline PointJacobian<Real> jacobian_at(const ShellFrame<Real>& f, double xi, double eta) {
  const Real x_xi = f.x_xi + eta * f.x_h, x_eta = f.x_eta + xi * f.x_h;
  const Real y_xi = f.y_xi + eta * f.y_h, y_eta = f.y_eta + xi * f.y_h;
  PointJacobian<Real> j;
  j.determinant = x_xi * y_eta - x_eta * y_xi;
  const Real inverse = Real(1.0) / j.determinant;
  j.xi_x = y_eta * inverse;
  j.xi_y = -x_eta * inverse;
  j.eta_x = -y_xi * inverse;
  j.eta_y = x_xi * inverse;
  return j;
}

}  // namespace tuft::fe

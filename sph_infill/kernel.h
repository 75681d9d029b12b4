#pragma once
/// Smoothing kernels in three dimensions with support 2h, as values: a loop is compiled for one of them.
///
/// Loops need dW/dr / r alone: grad_i W_ij = (dW/dr / r) (x_i - x_j). It is finite at r = 0 and zero beyond
/// the support, so that a list may hold pairs that are too far apart, and the particle itself. It is a shape
/// over q = r/h, which they take pair by pair, times a factor, which goes to their sums. Shapes are templates
/// over the number type: double, or SinglePack for a pair a lane.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/lane_math.h"

namespace tuft::sph {

/// Wendland C2 (Wendland 1995; Dehnen & Aly 2012): W = s (1 - q/2)^4 (2q + 1), s = 21/(16 pi h^3), q = r/h.
/// Its Fourier transform is positive everywhere, so that particles do not pair.
struct WendlandC2 {
  double h = 0, inverse_h = 0, scale = 0;

  explicit WendlandC2(double smoothing_length)
      : h(smoothing_length), inverse_h(1 / h), scale(21 / (16 * std::numbers::pi * h * h * h)) {}

  /// 1/m^3; distance in m, >= 0.
  [[nodiscard]] TUFT_HD double value(double distance) const {
    const double q = distance * inverse_h, t = std::max(0.0, 1 - 0.5 * q);
    return scale * t * t * t * t * (2 * q + 1);
  }
  /// dW/dr / r = -5 s/h^2 (1 - q/2)^3, 1/m^5; the shape is (2 - q)^3, exactly zero from q = 2 on.
  [[nodiscard]] TUFT_HD double slope_factor() const { return -0.625 * scale * inverse_h * inverse_h; }
  template <class Real>
  [[nodiscard]] TUFT_HD static Real slope_shape(const Real& q_squared) {
    using std::max, std::sqrt;
    const Real t = max(Real(0), Real(2) - sqrt(q_squared));
    return t * (t * t);
  }
  [[nodiscard]] TUFT_HD double slope_over_distance(double distance_squared) const {
    return slope_factor() * slope_shape(distance_squared * inverse_h * inverse_h);
  }
};

/// Cubic spline (Monaghan & Lattanzio 1985): W = s (1 - 3/2 q^2 + 3/4 q^3) for q < 1, s/4 (2 - q)^3 for q <
/// 2, s = 1/(pi h^3).
struct CubicSpline {
  double h = 0, inverse_h = 0, scale = 0;

  explicit CubicSpline(double smoothing_length)
      : h(smoothing_length), inverse_h(1 / h), scale(1 / (std::numbers::pi * h * h * h)) {}

  [[nodiscard]] TUFT_HD double value(double distance) const {
    const double q = distance * inverse_h, t = std::max(0.0, 2 - q);
    return scale * (q < 1 ? 1 - 1.5 * q * q + 0.75 * q * q * q : 0.25 * t * t * t);
  }
  /// dW/dr / r = s/h^2 (-3 + 9/4 q) for q < 1, -s/h^2 3/4 (2 - q)^2 / q for q < 2; the shape is what follows
  /// s/h^2.
  [[nodiscard]] TUFT_HD double slope_factor() const { return scale * inverse_h * inverse_h; }
  template <class Real>
  [[nodiscard]] TUFT_HD static Real slope_shape(const Real& q_squared) {
    using std::max, std::sqrt;
    const Real q = sqrt(q_squared), t = max(Real(0), Real(2) - q);
    const Real inner = Real(2.25F) * q - Real(3);
    const Real outer = Real(-0.75F) * (t * t) / max(Real(1), q);  // used for q >= 1 only: no division by zero
    return select(q < Real(1), inner, outer);
  }
  [[nodiscard]] TUFT_HD double slope_over_distance(double distance_squared) const {
    return slope_factor() * slope_shape(distance_squared * inverse_h * inverse_h);
  }
};

}  // namespace tuft::sph

#pragma once
/// Symmetric second-order tensors of a single point, for loops that keep them as structures of arrays.
#include <cmath>
#include <type_traits>

#include "core/vector.h"

namespace tuft::sph {

/// Real: double for one point, Pack for as many as there are lanes.
template <class Real>
struct SymmetricTensorOf {
  Real xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
};
using SymmetricTensor = SymmetricTensorOf<double>;

template <class Real>
TUFT_HD SymmetricTensorOf<Real> operator+(const SymmetricTensorOf<Real>& a,
                                          const SymmetricTensorOf<Real>& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
}
template <class Real>
TUFT_HD SymmetricTensorOf<Real> operator-(const SymmetricTensorOf<Real>& a,
                                          const SymmetricTensorOf<Real>& b) {
  return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.zx - b.zx};
}
template <class Real>
TUFT_HD SymmetricTensorOf<Real> operator*(const std::type_identity_t<Real>& f,
                                          const SymmetricTensorOf<Real>& a) {
  return {f * a.xx, f * a.yy, f * a.zz, f * a.xy, f * a.yz, f * a.zx};
}

template <class Real>
TUFT_HD Real trace(const SymmetricTensorOf<Real>& a) {
  return a.xx + a.yy + a.zz;
}

/// a : b
template <class Real>
TUFT_HD Real double_dot(const SymmetricTensorOf<Real>& a, const SymmetricTensorOf<Real>& b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + Real(2) * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx);
}

template <class Real>
TUFT_HD Real determinant(const SymmetricTensorOf<Real>& a) {
  return a.xx * (a.yy * a.zz - a.yz * a.yz) - a.xy * (a.xy * a.zz - a.yz * a.zx) +
         a.zx * (a.xy * a.yz - a.yy * a.zx);
}

template <class Real>
TUFT_HD SymmetricTensorOf<Real> deviator(const SymmetricTensorOf<Real>& a) {
  const Real mean = trace(a) * Real(1.0 / 3);
  return {a.xx - mean, a.yy - mean, a.zz - mean, a.xy, a.yz, a.zx};
}

/// Adjugate over determinant; `det` is the caller's, who has looked at it before.
template <class Real>
TUFT_HD SymmetricTensorOf<Real> inverse(const SymmetricTensorOf<Real>& a,
                                        const std::type_identity_t<Real>& det) {
  const Real f = Real(1) / det;
  return {f * (a.yy * a.zz - a.yz * a.yz), f * (a.xx * a.zz - a.zx * a.zx), f * (a.xx * a.yy - a.xy * a.xy),
          f * (a.zx * a.yz - a.xy * a.zz), f * (a.xy * a.zx - a.xx * a.yz), f * (a.xy * a.yz - a.zx * a.yy)};
}

/// A second-order tensor by rows.
template <class Real>
struct TensorOf {
  Real xx = 0, xy = 0, xz = 0, yx = 0, yy = 0, yz = 0, zx = 0, zy = 0, zz = 0;
};
template <class Real>
TUFT_HD TensorOf<Real> operator*(const std::type_identity_t<Real>& f, const TensorOf<Real>& a) {
  return {f * a.xx, f * a.xy, f * a.xz, f * a.yx, f * a.yy, f * a.yz, f * a.zx, f * a.zy, f * a.zz};
}

/// a . b
template <class Real>
TUFT_HD TensorOf<Real> dot(const TensorOf<Real>& a, const SymmetricTensorOf<Real>& b) {
  return {a.xx * b.xx + a.xy * b.xy + a.xz * b.zx, a.xx * b.xy + a.xy * b.yy + a.xz * b.yz,
          a.xx * b.zx + a.xy * b.yz + a.xz * b.zz, a.yx * b.xx + a.yy * b.xy + a.yz * b.zx,
          a.yx * b.xy + a.yy * b.yy + a.yz * b.yz, a.yx * b.zx + a.yy * b.yz + a.yz * b.zz,
          a.zx * b.xx + a.zy * b.xy + a.zz * b.zx, a.zx * b.xy + a.zy * b.yy + a.zz * b.yz,
          a.zx * b.zx + a.zy * b.yz + a.zz * b.zz};
}
template <class Real>
TUFT_HD TensorOf<Real> dot(const SymmetricTensorOf<Real>& a, const SymmetricTensorOf<Real>& b) {
  return dot(TensorOf<Real>{a.xx, a.xy, a.zx, a.xy, a.yy, a.yz, a.zx, a.yz, a.zz}, b);
}

/// The symmetric part.
template <class Real>
TUFT_HD SymmetricTensorOf<Real> symmetric_part(const TensorOf<Real>& m) {
  const Real half = Real(0.5);
  return {m.xx, m.yy, m.zz, half * (m.xy + m.yx), half * (m.yz + m.zy), half * (m.zx + m.xz)};
}

inline Mat3 to_matrix(const SymmetricTensor& a) {
  Mat3 m;
  m << a.xx, a.xy, a.zx, a.xy, a.yy, a.yz, a.zx, a.yz, a.zz;
  return m;
}

/// The symmetric part of m.
inline SymmetricTensor symmetric_part(const Mat3& m) {
  return {
      m(0, 0), m(1, 1), m(2, 2), (m(0, 1) + m(1, 0)) / 2, (m(1, 2) + m(2, 1)) / 2, (m(2, 0) + m(0, 2)) / 2};
}

}  // namespace tuft::sph

#pragma once
/// Symmetric second-order tensors of a single point, for loops that keep them as structures of arrays.
#include <cmath>

#include "core/vector.h"

namespace tuft::sph {

struct SymmetricTensor {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;
};

TUFT_HD inline SymmetricTensor operator+(const SymmetricTensor& a, const SymmetricTensor& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.yz + b.yz, a.zx + b.zx};
}
TUFT_HD inline SymmetricTensor operator-(const SymmetricTensor& a, const SymmetricTensor& b) {
  return {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.zx - b.zx};
}
TUFT_HD inline SymmetricTensor operator*(double f, const SymmetricTensor& a) {
  return {f * a.xx, f * a.yy, f * a.zz, f * a.xy, f * a.yz, f * a.zx};
}

TUFT_HD inline double trace(const SymmetricTensor& a) {
  return a.xx + a.yy + a.zz;
}

/// a : b
TUFT_HD inline double double_dot(const SymmetricTensor& a, const SymmetricTensor& b) {
  return a.xx * b.xx + a.yy * b.yy + a.zz * b.zz + 2 * (a.xy * b.xy + a.yz * b.yz + a.zx * b.zx);
}

TUFT_HD inline double determinant(const SymmetricTensor& a) {
  return a.xx * (a.yy * a.zz - a.yz * a.yz) - a.xy * (a.xy * a.zz - a.yz * a.zx) +
         a.zx * (a.xy * a.yz - a.yy * a.zx);
}

TUFT_HD inline SymmetricTensor deviator(const SymmetricTensor& a) {
  const double mean = trace(a) / 3;
  return {a.xx - mean, a.yy - mean, a.zz - mean, a.xy, a.yz, a.zx};
}

/// Adjugate over determinant; `det` is the caller's, who has looked at it before.
TUFT_HD inline SymmetricTensor inverse(const SymmetricTensor& a, double det) {
  const double f = 1 / det;
  return {f * (a.yy * a.zz - a.yz * a.yz), f * (a.xx * a.zz - a.zx * a.zx), f * (a.xx * a.yy - a.xy * a.xy),
          f * (a.zx * a.yz - a.xy * a.zz), f * (a.xy * a.zx - a.xx * a.yz), f * (a.xy * a.yz - a.zx * a.yy)};
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

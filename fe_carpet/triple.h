#pragma once
/// Three components of any number type: double for one element, Pack for as many as there are lanes.
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

}  // namespace tuft::fe

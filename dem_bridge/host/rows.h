#pragma once
/// Rows of three as LIGGGHTS' arrays have them.
#include "core/vector.h"

namespace tuft::dem {

inline Vec3 load3(const double* p) {
  return {p[0], p[1], p[2]};
}
inline void store3(double* p, const Vec3& v) {
  p[0] = v.x();
  p[1] = v.y();
  p[2] = v.z();
}

}  // namespace tuft::dem

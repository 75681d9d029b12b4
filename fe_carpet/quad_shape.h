#pragma once
/// What can be wrong with the shape of a four-node shell; the words are the caller's, who knows the names.
#include <algorithm>
#include <array>

#include "core/vector.h"

namespace tuft::fe {

struct QuadFault {
  enum class Kind { none, coincident_corners, not_convex };
  Kind kind = Kind::none;
  std::size_t first = 0, second = 0;  ///< corners: the two that coincide, or the one over 180 degrees
  double distance = 0;                ///< m, of the two
};

/// Sides and diagonals shorter than this share of the longest side count as zero.
inline constexpr double relative_zero_length = 1e-6;

/// The first fault found; `none` for a convex quad whose corners are apart. Corners must be finite.
[[nodiscard]] inline QuadFault find_quad_fault(const std::array<Vec3, 4>& corner) {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i) longest = std::max(longest, (corner[(i + 1) % 4] - corner[i]).norm());
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double distance = (corner[i] - corner[j]).norm();
      if (!(distance > relative_zero_length * longest))
        return {QuadFault::Kind::coincident_corners, j, i, distance};
    }
  // Positive corner areas with respect to the normal of the diagonals: convex, right way round, not folded.
  const Vec3 normal = (corner[2] - corner[0]).cross(corner[3] - corner[1]);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 forward = corner[(i + 1) % 4] - corner[i], backward = corner[(i + 3) % 4] - corner[i];
    const double area = forward.cross(backward).dot(normal);
    if (!(area > relative_zero_length * normal.squaredNorm())) return {QuadFault::Kind::not_convex, i, i, 0};
  }
  return {};
}

}  // namespace tuft::fe

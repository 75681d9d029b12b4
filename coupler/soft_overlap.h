#pragma once
/// Overlap of a ball with a surface of facets, smooth where facets meet. Pure functions of positions.
#include <array>
#include <cmath>
#include <cstddef>

#include "core/geometry.h"

namespace tuft::coupler {

/// A triangle's part in a contact. Facets enter as their two triangles: the diagonal of a warped facet is a
/// fold too.
struct SurfacePart {
  FacetPoint at;         ///< nearest point to the ball's centre, weights of the facet's four corners
  Vec3 normal{0, 0, 1};  ///< unit, from there towards the centre
  Vec3 face{0, 0, 1};    ///< normal of the triangle by the order of its corners, not normalised
  double nearness = 0;   ///< m, of the centre, >= 0
  double overlap = 0;    ///< m, of the ball with this triangle alone
  double root = 0;       ///< (N/m)^1/2, of the triangle's penalty stiffness
  double slope = 0;      ///< d(overlap of all)/d(overlap of this), >= 0
  double share = 0;      ///< slope over the sum of slopes
  Index element = -1;
};

/// The parts that touch, by depth times root of stiffness, largest first, and what they come to together:
///
///   U = k D^2 / 2,   sqrt(k) D = (sum_i (sqrt(k_i) d_i)^8)^(1/8),
///
/// over all triangles with an overlap d_i > 0, k being the stiffness of the first. The force -grad U is
/// k D sum_i slope_i n_i, slope_i = sqrt(k_i/k) (sqrt(k_i) d_i / (sqrt(k) D))^7. Taking the deepest alone
/// (the limit of a large exponent), direction and stiffness would jump from one triangle to the next in
/// hollows and where stiffness changes, and a particle caught there draws energy from every jump. Every
/// triangle enters with d_i = 0 and a vanishing slope, so it matters neither when the search finds it nor
/// when it leaves.
struct SoftOverlap {
  static constexpr std::size_t most_parts = 16;  ///< the shallowest beyond so many are left out
  std::array<SurfacePart, most_parts> parts;
  std::size_t count = 0;
  double value = 0;  ///< m, D; 0: apart. At least the deepest part's overlap
  double gap = 0;    ///< m, distance between ball and the nearest triangle that it does not overlap

  void clear() {
    count = 0;
    value = 0;
    gap = 1e300;
  }

  /// Takes in the triangles of a facet that overlap a ball of `touching` (m, its radius and half the shell's
  /// thickness) around the point. `stiffness`, N/m: > 0.
  void add_facet(const Vec3& point, double touching, const std::array<Vec3, 4>& corner, double stiffness,
                 Index element) {
    const auto halves = closest_points_on_halves(point, corner);
    for (std::size_t half = 0; half < 2; ++half) {
      const double nearness = std::sqrt(halves[half].distance_squared), overlap = touching - nearness;
      if (!(overlap > 0)) {
        gap = std::min(gap, -overlap);
        continue;
      }
      const double root = std::sqrt(stiffness);
      std::size_t place = count;
      while (place > 0 && root * overlap > parts[place - 1].root * parts[place - 1].overlap) --place;
      if (place == most_parts) continue;
      if (count < most_parts) ++count;
      for (std::size_t i = count - 1; i > place; --i) parts[i] = parts[i - 1];
      SurfacePart& part = parts[place];
      part.at = halves[half];
      part.nearness = nearness;
      part.overlap = overlap;
      part.root = root;
      part.element = element;
      const Vec3 along = corner[2] - corner[0];
      part.face =
          half == 0 ? Vec3((corner[1] - corner[0]).cross(along)) : Vec3(along.cross(corner[3] - corner[0]));
    }
  }

  /// After the last facet, when count > 0.
  void finish(const Vec3& point) {
    for (std::size_t i = 0; i < count; ++i) {
      SurfacePart& part = parts[i];
      // A point on the triangle has no direction from it: the face's own normal serves.
      part.normal = part.nearness > 1e-9 * part.overlap ? Vec3((point - part.at.point) / part.nearness)
                                                        : part.face.normalized();
    }
    combine();
  }

  /// For a ball whose centre has passed through the first triangle from its other side: that one's overlap
  /// goes on growing with the distance. Continuous where the centre is on the triangle.
  void take_as_passed() {
    parts[0].normal = -parts[0].normal;
    parts[0].overlap += 2 * parts[0].nearness;
    combine();
  }

  /// -grad D with respect to the ball's centre.
  [[nodiscard]] Vec3 direction() const {
    Vec3 sum(0, 0, 0);
    for (std::size_t i = 0; i < count; ++i) sum += parts[i].slope * parts[i].normal;
    return sum;
  }

 private:
  /// Value, slopes and shares from the overlaps.
  void combine() {
    const double deepest = parts[0].root * parts[0].overlap;
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double ratio = parts[i].root * parts[i].overlap / deepest, squared = ratio * ratio;
      parts[i].slope = squared * squared * squared * ratio;
      sum += parts[i].slope * ratio;
    }
    const double eighth_root = std::sqrt(std::sqrt(std::sqrt(sum)));
    value = parts[0].overlap * eighth_root;
    const double seventh_power = sum / eighth_root;
    double slopes = 0;
    for (std::size_t i = 0; i < count; ++i) {
      SurfacePart& part = parts[i];
      part.slope *= part.root / (parts[0].root * seventh_power);
      slopes += part.slope;
    }
    for (std::size_t i = 0; i < count; ++i) parts[i].share = parts[i].slope / slopes;
  }
};

}  // namespace tuft::coupler

#pragma once
/// Closest points: pure functions on points, no state.
#include <array>

#include "core/vector.h"

namespace tuft {

/// Closest point of a four-node facet to a point. The facet is taken as the two triangles (0,1,2) and
/// (0,2,3), so that it is defined for warped quadrilaterals too; weights are continuous over the facet.
struct FacetPoint {
  Vec3 point;                    ///< m
  std::array<double, 4> weight;  ///< shape values at the four corners, sum 1
  double distance_squared;       ///< m^2
};

/// Barycentric weights of the point of triangle abc closest to p (Ericson, Real-Time Collision Detection,
/// 2005, section 5.1.5: Voronoi regions of corners, edges, face).
inline std::array<double, 3> closest_triangle_weights(const Vec3& p, const Vec3& a, const Vec3& b,
                                                      const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double scale = 1.0 / (va + vb + vc);
  return {va * scale, vb * scale, vc * scale};
}

/// Closest points of the two triangles (0,1,2) and (0,2,3) of a facet.
inline std::array<FacetPoint, 2> closest_points_on_halves(const Vec3& p, const std::array<Vec3, 4>& corner) {
  const auto first = closest_triangle_weights(p, corner[0], corner[1], corner[2]);
  const Vec3 q1 = first[0] * corner[0] + first[1] * corner[1] + first[2] * corner[2];
  const auto second = closest_triangle_weights(p, corner[0], corner[2], corner[3]);
  const Vec3 q2 = second[0] * corner[0] + second[1] * corner[2] + second[2] * corner[3];
  return {FacetPoint{q1, {first[0], first[1], first[2], 0.0}, (p - q1).squaredNorm()},
          FacetPoint{q2, {second[0], 0.0, second[1], second[2]}, (p - q2).squaredNorm()}};
}

/// The nearer of the two; the first when both are equally near.
inline FacetPoint closest_point_on_facet(const Vec3& p, const std::array<Vec3, 4>& corner) {
  const auto halves = closest_points_on_halves(p, corner);
  return halves[0].distance_squared <= halves[1].distance_squared ? halves[0] : halves[1];
}

}  // namespace tuft

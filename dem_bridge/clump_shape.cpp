#include "dem_bridge/clump_shape.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace tuft::dem {
namespace {

struct GaussRule {
  std::vector<double> node, weight;  ///< on [-1, 1]
};

/// Zeros of Legendre's polynomial by Newton's method from Chebyshev's points.
GaussRule gauss_rule(int points) {
  GaussRule rule;
  for (int i = 0; i < points; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5)), slope = 0;
    for (int step = 0; step < 20; ++step) {
      double before = 1, value = x;
      for (int n = 2; n <= points; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = next;
      }
      slope = points * (x * value - before) / (x * x - 1);
      x -= value / slope;
    }
    rule.node.push_back(x);
    rule.weight.push_back(2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

struct Disc {
  double x, y, radius;
};

/// Integrals over a slice of 1, x, y, x^2, y^2, xy.
using SliceMoments = std::array<double, 6>;

struct Arc {
  double from, to;  // rad
};

/// What of the rim of disc `i` lies in no other: arcs that make up the rim of the union.
std::vector<Arc> free_arcs(const std::vector<Disc>& discs, std::size_t i) {
  constexpr double turn = 2 * std::numbers::pi;
  const Disc& own = discs[i];
  std::vector<Arc> covered;
  for (std::size_t j = 0; j < discs.size(); ++j) {
    if (j == i) continue;
    const Disc& other = discs[j];
    const double dx = other.x - own.x, dy = other.y - own.y, distance = std::hypot(dx, dy);
    // Of two discs that are one the first has the rim.
    if (distance == 0 && other.radius == own.radius && j > i) continue;
    if (distance + own.radius <= other.radius) return {};
    if (distance >= own.radius + other.radius || distance + other.radius <= own.radius) continue;
    const double half =
        std::acos(std::clamp((distance * distance + own.radius * own.radius - other.radius * other.radius) /
                                 (2 * distance * own.radius),
                             -1.0, 1.0));
    double from = std::fmod(std::atan2(dy, dx) - half, turn);
    if (from < 0) from += turn;
    covered.push_back({from, std::min(from + 2 * half, turn)});
    if (from + 2 * half > turn) covered.push_back({0, from + 2 * half - turn});
  }
  std::sort(covered.begin(), covered.end(), [](const Arc& a, const Arc& b) { return a.from < b.from; });
  std::vector<Arc> free;
  double at = 0;
  for (const Arc& arc : covered) {
    if (arc.from > at) free.push_back({at, arc.from});
    at = std::max(at, arc.to);
  }
  if (at < turn) free.push_back({at, turn});
  return free;
}

/// Along arcs the integrands are polynomials of degree 4 in sine and cosine: 24 points take a whole turn of
/// them to rounding.
SliceMoments slice_moments(const std::vector<Disc>& discs) {
  static const GaussRule rule = gauss_rule(24);
  SliceMoments sum{};
  for (std::size_t i = 0; i < discs.size(); ++i)
    for (const Arc& arc : free_arcs(discs, i))
      for (std::size_t k = 0; k < rule.node.size(); ++k) {
        const double half = 0.5 * (arc.to - arc.from), angle = arc.from + half * (1 + rule.node[k]);
        const double c = discs[i].radius * std::cos(angle), s = discs[i].radius * std::sin(angle);
        const double x = discs[i].x + c, y = discs[i].y + s, w = half * rule.weight[k];
        const double dx = -s * w, dy = c * w;
        sum[0] += 0.5 * (x * dy - y * dx);
        sum[1] += 0.5 * x * x * dy;
        sum[2] -= 0.5 * y * y * dx;
        sum[3] += x * x * x * dy / 3;
        sum[4] -= y * y * y * dx / 3;
        sum[5] += 0.5 * x * x * y * dy;
      }
  return sum;
}

/// Heights of the points that lie on three spheres.
void add_triple_points(const std::array<Vec3, 3>& c, const std::array<double, 3>& r,
                       std::vector<double>& heights) {
  const Vec3 a = c[1] - c[0], b = c[2] - c[0], normal = a.cross(b);
  const double square = normal.squaredNorm();
  if (!(square > 1e-20 * a.squaredNorm() * b.squaredNorm())) return;
  // x = c0 + p a + q b + t n: both differences of the spheres' equations give p and q.
  const double of_a = 0.5 * (r[0] * r[0] - r[1] * r[1] + a.squaredNorm()),
               of_b = 0.5 * (r[0] * r[0] - r[2] * r[2] + b.squaredNorm());
  const Vec3 in_plane = (of_a * b.cross(normal) + of_b * normal.cross(a)) / square;
  const double left = r[0] * r[0] - in_plane.squaredNorm();
  if (!(left >= 0)) return;
  const double up = std::sqrt(left / square) * normal.z();
  heights.push_back(c[0].z() + in_plane.z() - up);
  heights.push_back(c[0].z() + in_plane.z() + up);
}

std::vector<double> heights_of_change(std::span<const Vec3> centre, std::span<const double> radius) {
  std::vector<double> heights;
  const std::size_t count = radius.size();
  for (std::size_t i = 0; i < count; ++i) {
    heights.push_back(centre[i].z() - radius[i]);
    heights.push_back(centre[i].z() + radius[i]);
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 apart = centre[j] - centre[i];
      const double distance = apart.norm();
      if (!(distance > 0)) continue;
      const double along =
          (distance * distance + radius[i] * radius[i] - radius[j] * radius[j]) / (2 * distance);
      const double square = radius[i] * radius[i] - along * along;
      if (!(square > 0)) continue;
      // The circle in which two spheres meet.
      const Vec3 axis = apart / distance;
      const double z = centre[i].z() + along * axis.z(),
                   reach = std::sqrt(square * std::max(0.0, 1 - axis.z() * axis.z()));
      heights.push_back(z - reach);
      heights.push_back(z + reach);
      for (std::size_t k = 0; k < j; ++k)
        add_triple_points({centre[i], centre[j], centre[k]}, {radius[i], radius[j], radius[k]}, heights);
    }
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

/// The spheres of a clump, in its own unit.
void list_spheres(const Clump& clump, std::vector<Vec3>& centre, std::vector<double>& radius) {
  if (clump.shape == ClumpShape::spheres) {
    for (const ClumpSphere& sphere : clump.spheres) {
      centre.emplace_back(sphere.x, sphere.y, sphere.z);
      radius.push_back(sphere.radius);
    }
    return;
  }
  const double side = 2 * (1 - clump.overlap);  // between centres of spheres of radius 1
  const double root2 = std::numbers::sqrt2, root3 = std::numbers::sqrt3;
  switch (clump.shape) {
    case ClumpShape::pair:
      centre = {Vec3(-0.5, 0, 0), Vec3(0.5, 0, 0)};
      break;
    case ClumpShape::triangle:
      centre = {Vec3(1 / root3, 0, 0), Vec3(-0.5 / root3, 0.5, 0), Vec3(-0.5 / root3, -0.5, 0)};
      break;
    default:
      centre = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)};
      for (Vec3& x : centre) x /= 2 * root2;
  }
  for (Vec3& x : centre) x *= side;
  radius.assign(centre.size(), 1.0);
}

/// sum w (x^2 - x x^T)
Mat3 inertia_of_points(const std::vector<Vec3>& place, const std::vector<double>& weight) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < place.size(); ++i)
    sum += weight[i] * (place[i].squaredNorm() * Mat3::Identity() - place[i] * place[i].transpose());
  return sum;
}

/// The shares nearest to the cubes of the radii, in the norm that these weigh, with sum 1 and the centre at
/// 0.
std::vector<double> shares_of_mass(const ClumpBody& body) {
  const auto count = static_cast<Eigen::Index>(body.size());
  Eigen::VectorXd start(count);
  Eigen::MatrixXd sums(4, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    start[i] = std::pow(body.radius[static_cast<std::size_t>(i)], 3);
    sums.col(i) << 1, body.centre[static_cast<std::size_t>(i)];
  }
  start /= start.sum();
  const Eigen::Vector4d wanted(1, 0, 0, 0);
  const Eigen::MatrixXd weighed = start.asDiagonal() * sums.transpose();
  const Eigen::Matrix4d normal = sums * weighed;
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix4d> solver;
  solver.setThreshold(1e-10);  // a row or plane of spheres has no centre off it
  solver.compute(normal);
  const Eigen::VectorXd shares = start + weighed * solver.solve(Eigen::Vector4d(wanted - sums * start));
  return {shares.begin(), shares.end()};
}

double stable_share_of(const ClumpBody& body) {
  Mat3 of_spheres = inertia_of_points(body.centre, body.share);
  for (std::size_t i = 0; i < body.size(); ++i)
    of_spheres += 0.4 * body.share[i] * body.radius[i] * body.radius[i] * Mat3::Identity();
  const Vec3 scale = body.inertia.cwiseSqrt().cwiseInverse();
  const Mat3 ratio = scale.asDiagonal() * of_spheres * scale.asDiagonal();
  const double largest = Eigen::SelfAdjointEigenSolver<Mat3>(ratio).eigenvalues().maxCoeff();
  return 1 / std::max(1.0, largest);
}

}  // namespace

UnionMoments union_moments(std::span<const Vec3> centre, std::span<const double> radius, int points) {
  const GaussRule rule = gauss_rule(points);
  const std::vector<double> heights = heights_of_change(centre, radius);
  UnionMoments sum;
  std::vector<Disc> discs;
  for (std::size_t h = 1; h < heights.size(); ++h) {
    const double middle = 0.5 * (heights[h] + heights[h - 1]), half = 0.5 * (heights[h] - heights[h - 1]);
    if (!(half > 1e-15 * (heights.back() - heights.front()))) continue;
    for (std::size_t k = 0; k < rule.node.size(); ++k) {
      const double angle = 0.5 * std::numbers::pi * rule.node[k], z = middle + half * std::sin(angle);
      const double weight = rule.weight[k] * half * 0.5 * std::numbers::pi * std::cos(angle);
      discs.clear();
      for (std::size_t i = 0; i < radius.size(); ++i) {
        const double up = z - centre[i].z(), square = radius[i] * radius[i] - up * up;
        if (square > 0) discs.push_back({centre[i].x(), centre[i].y(), std::sqrt(square)});
      }
      const SliceMoments m = slice_moments(discs);
      sum.volume += weight * m[0];
      sum.first += weight * Vec3(m[1], m[2], z * m[0]);
      const Mat3 second{{m[3], m[5], z * m[1]}, {m[5], m[4], z * m[2]}, {z * m[1], z * m[2], z * z * m[0]}};
      sum.second += weight * second;
    }
  }
  return sum;
}

ClumpBody make_clump_body(const Clump& clump, std::string_view name) {
  ClumpBody body;
  list_spheres(clump, body.centre, body.radius);
  const UnionMoments moments = union_moments(body.centre, body.radius);
  const Vec3 middle = moments.first / moments.volume;
  const Mat3 second = moments.second / moments.volume - middle * middle.transpose();
  const Mat3 inertia = second.trace() * Mat3::Identity() - second;
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(inertia);
  // Falling moments, a right-handed frame.
  Mat3 axes = principal.eigenvectors().rowwise().reverse();
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  const double scale = std::cbrt(std::numbers::pi / 6 / moments.volume);
  body.inertia = scale * scale * principal.eigenvalues().reverse();
  for (std::size_t i = 0; i < body.size(); ++i) {
    body.centre[i] = scale * (axes.transpose() * (body.centre[i] - middle)).eval();
    body.radius[i] *= scale;
    body.reach = std::max(body.reach, body.centre[i].norm() + body.radius[i]);
  }
  body.share = shares_of_mass(body);
  if (const auto least = std::min_element(body.share.begin(), body.share.end()); !(*least > 0))
    throw_input_error(
        "grains of {}: sphere {} of their clump would have to weigh {:.2g} of the clump, or less than "
        "nothing, "
        "for "
        "its centre of mass; leave it out, or move it",
        name, least - body.share.begin(), *least);
  body.stable_share = stable_share_of(body);
  return body;
}

SphereOfClump sphere_of_clump(const ClumpBody& body, std::size_t sphere, double density) {
  const double share = body.share[sphere] * body.stable_share, diameter = 2 * body.radius[sphere];
  return {density * share / (diameter * diameter * diameter), 1 / share};
}

}  // namespace tuft::dem

#include "core/geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/parallel.h"

namespace tuft {
namespace {

Vec3 random_point(std::mt19937& generator, double size) {
  std::uniform_real_distribution<double> within(-size, size);
  const double x = within(generator), y = within(generator), z = within(generator);
  return {x, y, z};
}

/// Distance to a triangle by trying a fine grid of its points: never below the true one, and above by less
/// than a grid cell.
double brute_force_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, int cells) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; i + j <= cells; ++j) {
      const double u = double(i) / cells, v = double(j) / cells;
      best = std::min(best, (p - ((1 - u - v) * a + u * b + v * c)).norm());
    }
  return best;
}

TEST(ClosestPoint, OnTriangleAgreesWithBruteForce) {
  std::mt19937 generator(7);
  constexpr int cells = 60;
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 a = random_point(generator, 1), b = random_point(generator, 1), c = random_point(generator, 1);
    const Vec3 p = random_point(generator, 2);
    const auto w = closest_triangle_weights(p, a, b, c);
    EXPECT_NEAR(w[0] + w[1] + w[2], 1.0, 1e-12);
    for (const double weight : w) EXPECT_GE(weight, -1e-12);
    const double distance = (p - (w[0] * a + w[1] * b + w[2] * c)).norm();
    const double tried = brute_force_distance(p, a, b, c, cells);
    const double cell = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()}) / cells;
    EXPECT_LE(distance, tried + 1e-12);
    EXPECT_GE(distance, tried - cell);
  }
}

TEST(ClosestPoint, OnFacetIsTheNearerOfItsTwoTriangles) {
  std::mt19937 generator(11);
  for (int trial = 0; trial < 200; ++trial) {
    std::array<Vec3, 4> corner{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
    for (Vec3& x : corner) x += random_point(generator, 0.2);
    const Vec3 p = random_point(generator, 2);
    const FacetPoint found = closest_point_on_facet(p, corner);
    Vec3 from_weights(0, 0, 0);
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      from_weights += found.weight[k] * corner[k];
      sum += found.weight[k];
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_LT((from_weights - found.point).norm(), 1e-12);
    EXPECT_NEAR((p - found.point).squaredNorm(), found.distance_squared, 1e-12);
    constexpr int cells = 40;
    const double tried = std::min(brute_force_distance(p, corner[0], corner[1], corner[2], cells),
                                  brute_force_distance(p, corner[0], corner[2], corner[3], cells));
    EXPECT_LE(std::sqrt(found.distance_squared), tried + 1e-12);
    EXPECT_GE(std::sqrt(found.distance_squared), tried - 2.0 / cells);
  }
}

TEST(ClosestPoint, MovesContinuouslyOverTheDiagonalOfAFlatFacet) {
  const std::array<Vec3, 4> corner{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};
  const FacetPoint below = closest_point_on_facet({0.5 + 1e-9, 0.5 - 1e-9, 0.3}, corner);
  const FacetPoint above = closest_point_on_facet({0.5 - 1e-9, 0.5 + 1e-9, 0.3}, corner);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(below.weight[k], above.weight[k], 1e-8);
}

TEST(DeterministicSum, HasTheSameBitsForAnyNumberOfThreads) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> value(-1, 1);
  std::vector<double> terms(100003);
  for (double& term : terms) term = value(generator) * std::pow(10.0, 8 * value(generator));
  const auto sum = [&](int threads) {
    set_threads(threads);
    return deterministic_sum<double>(terms.size(), [&](std::size_t i) { return terms[i]; });
  };
  const double one = sum(1);
  for (const int threads : {2, 3, 4}) EXPECT_EQ(sum(threads), one) << threads;
  set_threads(1);
  EXPECT_EQ(deterministic_sum<double>(0, [](std::size_t) { return 1.0; }), 0.0);
  long double reference = 0;
  for (const double term : terms) reference += term;
  EXPECT_NEAR(one, static_cast<double>(reference), 1e-3);
}

TEST(LargestOf, IsTheLargestWhereverItStandsAndPassesOverNaN) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const int threads : {1, 3}) {
    set_threads(threads);
    for (const std::size_t count : {1UL, 15UL, 16UL, 17UL, 4096UL, 4097UL, 20011UL})
      for (const std::size_t place : {std::size_t{0}, count / 2, count - 1}) {
        const auto value = [&](std::size_t i) {
          return i == place ? 7.0 : i % 3 == 0 ? nan : 1.0 / double(i + 1);
        };
        EXPECT_EQ(largest_of(count, value), 7.0) << place << " of " << count;
      }
  }
  set_threads(1);
  EXPECT_EQ(largest_of(0, [](std::size_t) { return 1.0; }), 0.0);
  EXPECT_EQ(largest_of(3, [&](std::size_t) { return nan; }), 0.0);
}

TEST(ParallelFor, VisitsEveryIndexOnce) {
  set_threads(3);
  std::vector<int> visits(10007, 0);
  parallel_for(visits.size(), [&](std::size_t i) { ++visits[i]; });
  set_threads(1);
  for (const int count : visits) ASSERT_EQ(count, 1);
}

}  // namespace
}  // namespace tuft

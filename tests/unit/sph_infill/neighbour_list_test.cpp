#include "sph_infill/neighbour_list.h"

#include <gtest/gtest.h>

#include <random>

#include "core/parallel.h"

namespace tuft::sph {
namespace {

Vec3Array random_points(std::size_t count, double side, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(0, side);
  Vec3Array points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({along(random), along(random), along(random)});
  return points;
}

/// Row i without the padding.
std::vector<Index> others(const NeighbourList& list, std::size_t i) {
  std::vector<Index> row;
  for (const Index j : list.row(i))
    if (static_cast<std::size_t>(j) != i) row.push_back(j);
  return row;
}

std::vector<Index> brute_force(const Vec3Array& points, std::size_t i, double reach) {
  std::vector<Index> row;
  for (std::size_t j = 0; j < points.size(); ++j)
    if (j != i && (points[i] - points[j]).squaredNorm() < reach * reach) row.push_back(static_cast<Index>(j));
  return row;
}

TEST(NeighbourList, HoldsExactlyThePairsWithinReachSortedByIndex) {
  const Vec3Array points = random_points(600, 1, 1);
  NeighbourList list(points, 0.17, 0.03);
  list.build(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(others(list, i), brute_force(points, i, 0.2));
    EXPECT_EQ(list.row(i).size() % NeighbourList::row_multiple, 0u);
  }
}

TEST(NeighbourList, StaysRightWhenParticlesLeaveTheBoxItWasMadeFor) {
  NeighbourList list(random_points(300, 1, 1), 0.5, 0.1);
  const Vec3Array spread = random_points(300, 3, 2);
  list.build(spread);
  for (std::size_t i = 0; i < spread.size(); ++i) EXPECT_EQ(others(list, i), brute_force(spread, i, 0.6));
}

TEST(NeighbourList, MissesNoPairUntilAParticleHasMovedHalfTheSkin) {
  Vec3Array points = random_points(500, 1, 3);
  NeighbourList list(points, 0.17, 0.04);
  list.build(points);
  std::mt19937_64 random(4);
  std::normal_distribution<double> any;
  for (std::size_t i = 0; i < points.size(); ++i)
    points.add(
        i, 0.999 * list.allowed_displacement() * Vec3(any(random), any(random), any(random)).normalized());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto listed = others(list, i);
    for (const Index j : brute_force(points, i, 0.17))
      EXPECT_TRUE(std::binary_search(listed.begin(), listed.end(), j));
  }
}

TEST(NeighbourList, IsTheSameForAnyNumberOfThreads) {
  const Vec3Array points = random_points(500, 1, 6);
  NeighbourList one(points, 0.2, 0.02), three(points, 0.2, 0.02);
  const int threads = omp_get_max_threads();
  set_threads(1);
  one.build(points);
  set_threads(3);
  three.build(points);
  set_threads(threads);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_TRUE(std::ranges::equal(one.row(i), three.row(i)));
}

}  // namespace
}  // namespace tuft::sph

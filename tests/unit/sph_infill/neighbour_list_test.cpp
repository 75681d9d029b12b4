#include "sph_infill/neighbour_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(list.row(i), brute_force(points, i, 0.2));
}

TEST(NeighbourList, EndsShorterRowsOfAGroupWithTheParticleItself) {
  const Vec3Array points = random_points(group_size * 40 + 3, 1, 7);
  NeighbourList list(points, 0.2, 0.03);
  list.build(points);
  const std::size_t n = points.size();
  for (std::size_t g = 0; g * group_size < n; ++g) {
    const NeighbourList::GroupRows rows = list.group(g);
    std::size_t longest = 0;
    for (std::size_t l = 0; l < group_size; ++l) {
      const std::size_t i = std::min(g * group_size + l, n - 1);
      const std::size_t own = g * group_size + l < n ? list.row(i).size() : 0;
      longest = std::max(longest, own);
      for (std::size_t k = own; k < rows.length; ++k)
        EXPECT_EQ(rows.first[k * group_size + l].index(), i) << "group " << g << ", lane " << l;
    }
    EXPECT_EQ(rows.length, longest);
  }
}

TEST(NeighbourList, FindsRowsOfAGroupThatIsScatteredOverTheWholeBox) {
  // Neighbours in space are far apart in index: every group takes its candidates particle by particle.
  Vec3Array points = random_points(2000, 1, 8);
  NeighbourList list(points, 0.08, 0.01);
  list.build(points);
  for (std::size_t i = 0; i < points.size(); i += 37) EXPECT_EQ(list.row(i), brute_force(points, i, 0.09));
}

TEST(NeighbourList, StaysRightWhenParticlesLeaveTheBoxItWasMadeFor) {
  NeighbourList list(random_points(300, 1, 1), 0.5, 0.1);
  const Vec3Array spread = random_points(300, 3, 2);
  list.build(spread);
  for (std::size_t i = 0; i < spread.size(); ++i) EXPECT_EQ(list.row(i), brute_force(spread, i, 0.6));
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
    const auto listed = list.row(i);
    for (const Index j : brute_force(points, i, 0.17))
      EXPECT_TRUE(std::binary_search(listed.begin(), listed.end(), j));
  }
}

TEST(NeighbourList, TakesANewSkinWithTheNextBuild) {
  const Vec3Array points = random_points(600, 1, 9);
  NeighbourList list(points, 0.17, 0.03);
  list.build(points);
  for (const double skin : {0.01, 0.08}) {
    const double before = list.allowed_displacement();
    list.set_skin(skin);
    EXPECT_EQ(list.allowed_displacement(), before);
    list.build(points);
    EXPECT_EQ(list.allowed_displacement(), 0.5 * skin);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_EQ(list.row(i), brute_force(points, i, 0.17 + skin));
  }
}

/// A blow in the middle, which moves less and less round it.
void strike(Vec3Array& points, std::mt19937_64& random, double farthest) {
  std::normal_distribution<double> any;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double away = (points[i] - Vec3(0.5, 0.5, 0.5)).norm();
    points.add(
        i, farthest * std::exp(-50 * away * away) * Vec3(any(random), any(random), any(random)).normalized());
  }
}

TEST(NeighbourList, RenewedInPartIsTheListBuiltAtItsPlacesAndMissesNoPair) {
  Vec3Array points = random_points(3000, 1, 11);
  std::sort(points.z.begin(), points.z.end());  // groups lie together
  constexpr double support = 0.1, skin = 0.03;
  NeighbourList list(points, support, skin);
  list.keep_places();
  list.build(points);
  std::mt19937_64 random(12);
  std::size_t made = 0, groups = 0;
  for (int round = 0; round < 12; ++round) {
    strike(points, random, 0.3 * skin);
    const NeighbourList::Renewal renewal = list.renew(points);
    made += renewal.groups, groups += (points.size() + group_size - 1) / group_size;
    EXPECT_LE(renewal.farthest, skin / 8);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LE((points[i] - list.places()[i]).norm(), renewal.farthest);
      ASSERT_EQ(list.row(i), brute_force(list.places(), i, support + skin))
          << "round " << round << ", particle " << i;
    }
  }
  EXPECT_LT(made, groups * 9 / 10) << "part of it, not all";
  EXPECT_GT(made, groups / 10);
  // As far again as what stays may have moved already.
  const double more = 0.999 * (list.allowed_displacement() - skin / 8);
  std::normal_distribution<double> any;
  for (std::size_t i = 0; i < points.size(); ++i)
    points.add(i, more * Vec3(any(random), any(random), any(random)).normalized());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto listed = list.row(i);
    for (const Index j : brute_force(points, i, support))
      EXPECT_TRUE(std::binary_search(listed.begin(), listed.end(), j));
  }
}

TEST(NeighbourList, RenewedWhereAllHaveMovedIsBuiltAnew) {
  Vec3Array points = random_points(500, 1, 13);
  NeighbourList list(points, 0.17, 0.04);
  list.keep_places();
  list.build(points);
  for (std::size_t i = 0; i < points.size(); ++i) points.add(i, Vec3(0.02, 0, 0));
  EXPECT_EQ(list.renew(points).farthest, 0);
  EXPECT_EQ(list.places().x, points.x);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(list.row(i), brute_force(points, i, 0.21));
}

TEST(NeighbourList, RenewedIsTheSameForAnyNumberOfThreads) {
  const Vec3Array before = random_points(3000, 1, 14);
  Vec3Array after = before;
  std::mt19937_64 random(15);
  strike(after, random, 0.02);
  const int threads = omp_get_max_threads();
  std::vector<NeighbourList> lists;
  for (const int count : {1, 3}) {
    set_threads(count);
    NeighbourList& list = lists.emplace_back(before, 0.1, 0.02);
    list.keep_places();
    list.build(before);
    (void)list.renew(after);
  }
  set_threads(threads);
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(lists[0].row(i), lists[1].row(i));
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
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(one.row(i), three.row(i));
}

}  // namespace
}  // namespace tuft::sph

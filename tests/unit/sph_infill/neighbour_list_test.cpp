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

/// Rows of a lattice one after the other, thrown off it by up to so many pitches: groups lie together.
Vec3Array rows_of_points(std::size_t along, double pitch, unsigned seed, double thrown = 0.25) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-thrown * pitch, thrown * pitch);
  Vec3Array points;
  for (std::size_t x = 0; x < along; ++x)
    for (std::size_t z = 0; z < along; ++z)
      for (std::size_t y = 0; y < along; ++y)
        points.push_back({static_cast<double>(x) * pitch + any(random),
                          static_cast<double>(y) * pitch + any(random),
                          static_cast<double>(z) * pitch + any(random)});
  return points;
}

TEST(NeighbourList, HoldsExactlyThePairsWithinReachWhereGroupsLieTogether) {
  Vec3Array points = rows_of_points(13, 0.1, 17);  // 13: groups run on from row to row
  for (std::size_t i = 3; i < points.size(); i += 29)
    points.set(i, {0.6, 0.5, 1.5 + 1e-3 * static_cast<double>(i)});
  NeighbourList list(points, 0.23, 0.03);
  list.keep_places();
  list.leave_out(40, points.size());
  list.build(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<Index> expected = brute_force(points, i, 0.26);
    std::erase(expected, 40);
    if (i == 40) expected.clear();
    ASSERT_EQ(list.row(i), expected) << i;
  }
}

/// Distances that are the reach but for rounding, of particles found together and one by one.
TEST(NeighbourList, HasEveryPairInBothRowsWhereDistancesAreTheReach) {
  constexpr double pitch = 0.1;
  Vec3Array points = rows_of_points(13, pitch, 0, 0);
  std::mt19937_64 random(21);
  for (std::size_t i = points.size() / 2; i < points.size(); ++i) {
    std::uniform_int_distribution<std::size_t> other(points.size() / 2, points.size() - 1);
    const std::size_t j = other(random);
    const Vec3 here = points[i];
    points.set(i, points[j]), points.set(j, here);
  }
  NeighbourList list(points, 2.8 * pitch, 3 * pitch - 2.8 * pitch);
  list.build(points);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Index j : list.row(i)) {
      const std::vector<Index> theirs = list.row(static_cast<std::size_t>(j));
      EXPECT_TRUE(std::binary_search(theirs.begin(), theirs.end(), static_cast<Index>(i)))
          << i << " and " << j;
    }
}

/// By blocks, after particles have moved as far as they may since their groups were sorted into cells.
TEST(NeighbourList, CompletesRowsOfThePresentPositionsWhereGroupsLieTogether) {
  Vec3Array points = rows_of_points(13, 0.1, 18);
  constexpr double support = 0.23, skin = 0.06;
  NeighbourList list(points, support, skin);
  list.begin(points);
  std::mt19937_64 random(19);
  std::normal_distribution<double> any;
  for (std::size_t i = 0; i < points.size(); ++i)
    points.add(i, 0.499 * skin * Vec3(any(random), any(random), any(random)).normalized());
  std::vector<Index> blocks;
  for (std::size_t b = 0; b * block_size < points.size(); ++b) blocks.push_back(static_cast<Index>(b));
  list.complete(points, blocks);
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_EQ(list.row(i), brute_force(points, i, support + skin)) << i;
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

void expect_near_groups_of_rows(const Vec3Array& points, double support) {
  NeighbourList list(points, support, 0.01);
  list.keep_places();
  list.leave_out(17, points.size());
  list.build(points);
  for (std::size_t g = 0; g < points.size() / group_size; ++g) {
    std::vector<Index> near;
    for (std::size_t i = g * group_size; i < (g + 1) * group_size; ++i)
      for (const Index j : list.row(i))
        near.push_back(static_cast<Index>(static_cast<std::size_t>(j) / group_size));
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    EXPECT_TRUE(std::ranges::equal(list.groups_near(g), near)) << "group " << g;
  }
  EXPECT_TRUE(list.row(17).empty());
}

TEST(NeighbourList, KnowsWhichGroupsAreNearEachOtherWherePlacesAreKept) {
  expect_near_groups_of_rows(random_points(2400, 1, 16), 0.1);  // scattered
  expect_near_groups_of_rows(rows_of_points(13, 0.1, 20), 0.23);
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
  NeighbourList whole(before, 0.1, 0.02);
  whole.build(lists[0].places());
  for (std::size_t g = 0; g < (before.size() + group_size - 1) / group_size; ++g) {
    const auto entries = [g](const NeighbourList& list) {
      const NeighbourList::GroupRows rows = list.group(g);
      std::vector<std::size_t> indices;
      for (std::size_t e = 0; e < rows.length * group_size; ++e) indices.push_back(rows.first[e].index());
      return indices;
    };
    EXPECT_EQ(entries(lists[0]), entries(lists[1]));
    EXPECT_EQ(entries(lists[0]), entries(whole)) << "padding, too";
    EXPECT_TRUE(std::ranges::equal(lists[0].groups_near(g), lists[1].groups_near(g)));
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
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(one.row(i), three.row(i));
}

}  // namespace
}  // namespace tuft::sph

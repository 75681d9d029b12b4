/// What loops over pairs ask for ahead of its turn is what they read, but for what their thread has read not
/// four blocks ago: however a list is made.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "core/parallel.h"
#include "sph_infill/neighbour_list.h"

namespace tuft::sph {
namespace {

constexpr std::size_t groups_per_block = block_size / group_size, remembered = 4;
constexpr double pitch = 0.1, support = 0.15, skin = 0.02;

using Groups = std::vector<Index>;

std::size_t groups_of(const Vec3Array& points) {
  return (points.size() + group_size - 1) / group_size;
}
std::size_t blocks_of(const Vec3Array& points) {
  return (points.size() + block_size - 1) / block_size;
}

/// 15^3 points, row after row, about a lattice: the last group has seven, the last block 47.
Vec3Array rows_of_points() {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> any(-0.25 * pitch, 0.25 * pitch);
  Vec3Array points;
  for (int x = 0; x < 15; ++x)
    for (int z = 0; z < 15; ++z)
      for (int y = 0; y < 15; ++y)
        points.push_back(pitch * Vec3(x, y, z) + Vec3(any(random), any(random), any(random)));
  return points;
}

/// Of each group, those that its rows are of.
std::vector<Groups> groups_read(const NeighbourList& list, const Vec3Array& points) {
  std::vector<Groups> read(groups_of(points));
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Index j : list.row(i))
      read[i / group_size].push_back(static_cast<Index>(static_cast<std::size_t>(j) / group_size));
  for (Groups& near : read) {
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
  }
  return read;
}

/// What one thread reads, block after block.
class Thread {
 public:
  /// What the groups of a block read and the thread has not just read; the first blocks are not known, for
  /// what it has read before them is not.
  std::map<std::size_t, Groups> make(std::size_t block, const std::vector<Groups>& read) {
    ++made_;
    std::map<std::size_t, Groups> first;
    for (std::size_t g = block * groups_per_block; g < std::min(read.size(), (block + 1) * groups_per_block);
         ++g) {
      Groups& missing = first[g];
      for (const Index other : read[g]) {
        const auto [at, is_new] = last_.try_emplace(other, 0);
        if (is_new || made_ - at->second >= remembered) missing.push_back(other);
        at->second = made_;
      }
    }
    if (made_ < remembered) first.clear();
    return first;
  }

 private:
  std::map<Index, std::size_t> last_;
  std::size_t made_ = 0;
};

/// groups_first_read of the groups of `expected`.
void expect_first_reads(const NeighbourList& list, const std::map<std::size_t, Groups>& expected) {
  for (const auto& [g, groups] : expected)
    EXPECT_TRUE(std::ranges::equal(list.groups_first_read(g), groups)) << "group " << g;
}

/// On so many threads, for as long as it lives.
class Threads {
 public:
  explicit Threads(int count) { set_threads(count); }
  ~Threads() { set_threads(before_); }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

 private:
  int before_ = omp_get_max_threads();
};

struct Build {
  bool keeps_places;
  int threads;
  friend void PrintTo(const Build& b, std::ostream* os) {
    *os << (b.keeps_places ? "places kept, " : "") << b.threads << " threads";
  }
};
class FirstReads : public testing::TestWithParam<Build> {};
INSTANTIATE_TEST_SUITE_P(Builds, FirstReads,
                         testing::Values(Build{false, 1}, Build{true, 1}, Build{false, 2}, Build{true, 2},
                                         Build{false, 3}, Build{true, 3}));

TEST_P(FirstReads, OfAWholeListAreAllThatRowsReadAndTheBlocksJustBeforeHaveNot) {
  const Vec3Array points = rows_of_points();
  const Threads threads(GetParam().threads);
  NeighbourList list(points, support, skin);
  if (GetParam().keeps_places) list.keep_places();
  list.build(points);
  const std::vector<Groups> read = groups_read(list, points);
  // Blocks are shared out evenly, in order: who has made which.
  std::vector<int> maker(blocks_of(points));
  parallel_for(maker.size(), [&](std::size_t b) { maker[b] = omp_get_thread_num(); });
  std::map<int, Thread> made_by;
  std::size_t asked_for = 0, known = 0;
  for (std::size_t b = 0; b < maker.size(); ++b) {
    const auto expected = made_by[maker[b]].make(b, read);
    expect_first_reads(list, expected);
    for (const auto& [g, groups] : expected) asked_for += groups.size(), ++known;
  }
  EXPECT_GT(known, 0u);
  EXPECT_LT(asked_for, 2 * known) << "most are in a cache when a group reads them again";
}

/// As where infill sleeps: some blocks, then others.
TEST(FirstReadsOfParts, AreThoseOfTheBlocksThatWereMade) {
  const Vec3Array points = rows_of_points();
  const Threads threads(1);
  NeighbourList list(points, support, skin);
  list.begin(points);
  Groups some, all;
  for (std::size_t b = 0; b < blocks_of(points); ++b) {
    all.push_back(static_cast<Index>(b));
    if (b % 3 != 1) some.push_back(static_cast<Index>(b));
  }
  std::vector<Index> order;
  for (const Groups& blocks : {some, all}) {
    const auto made = list.complete(points, blocks);
    order.insert(order.end(), made.begin(), made.end());
  }
  ASSERT_EQ(order.size(), all.size());
  const std::vector<Groups> read = groups_read(list, points);
  Thread thread;
  for (const Index b : order) expect_first_reads(list, thread.make(static_cast<std::size_t>(b), read));
}

/// As where steps are individual. What has moved is made first, with what its block had, then what is beside
/// it.
TEST(FirstReadsOfARenewedList, AreThoseOfTheBlocksThatWereMadeAgain) {
  Vec3Array points = rows_of_points();
  const Threads threads(1);
  NeighbourList list(points, support, skin);
  list.keep_places();
  list.build(points);
  const std::vector<Groups> before = groups_read(list, points);
  // Of groups here and there one particle, by a pitch.
  std::vector<bool> moved(groups_of(points), false);
  for (std::size_t g = 5; g < moved.size(); g += 71) {
    moved[g] = true;
    points.add(g * group_size + 3, Vec3(0, 0, pitch));
  }
  const NeighbourList::Renewal renewal = list.renew(points);
  ASSERT_LT(renewal.groups, moved.size()) << "all was built";
  const std::vector<Groups> after = groups_read(list, points);
  std::vector<bool> beside(moved.size(), false);
  std::vector<Groups> half_way = before;
  for (std::size_t g = 0; g < moved.size(); ++g) {
    if (!moved[g]) continue;
    half_way[g] = after[g];
    for (const auto* near : {&before[g], &after[g]})
      for (const Index other : *near) beside[static_cast<std::size_t>(other)] = true;
  }
  Thread thread;
  std::map<std::size_t, Groups> expected;  // of blocks as last made
  const auto make = [&](const std::vector<bool>& which, const std::vector<Groups>& read) {
    for (std::size_t b = 0; b < blocks_of(points); ++b) {
      bool any = false;
      for (std::size_t g = b * groups_per_block; g < std::min(moved.size(), (b + 1) * groups_per_block); ++g)
        any = any || which[g];
      if (!any) continue;
      for (std::size_t g = b * groups_per_block; g < std::min(moved.size(), (b + 1) * groups_per_block); ++g)
        expected.erase(g);
      expected.merge(thread.make(b, read));
    }
  };
  make(moved, half_way);
  for (std::size_t g = 0; g < moved.size(); ++g) beside[g] = beside[g] && !moved[g];
  make(beside, after);
  EXPECT_GT(expected.size(), moved.size() / 2);
  expect_first_reads(list, expected);
}

}  // namespace
}  // namespace tuft::sph

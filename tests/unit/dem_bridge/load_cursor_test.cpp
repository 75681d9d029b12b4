#include "dem_bridge/host/load_cursor.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <vector>

namespace tuft::dem {
namespace {

std::vector<LoadRecord> every_third(std::size_t grains) {
  std::vector<LoadRecord> loads;
  for (std::size_t i = 0; i < grains; i += 3) loads.push_back({i, {static_cast<double>(i), 0, 0}, {}});
  return loads;
}

std::vector<std::size_t> grains_of(std::span<const LoadRecord> loads) {
  std::vector<std::size_t> grains;
  for (const LoadRecord& load : loads) grains.push_back(load.grain);
  return grains;
}

TEST(LoadCursor, GivesEachRangeItsLoadsInAnyOrder) {
  const std::vector<LoadRecord> loads = every_third(200);
  using Grains = std::vector<std::size_t>;
  LoadCursor cursor(loads);
  EXPECT_EQ(grains_of(cursor.of(0, 7)), (Grains{0, 3, 6}));
  EXPECT_EQ(grains_of(cursor.of(7, 9)), Grains{});
  EXPECT_EQ(grains_of(cursor.of(9, 13)), (Grains{9, 12}));
  EXPECT_EQ(grains_of(cursor.of(150, 154)), (Grains{150, 153})) << "far ahead";
  EXPECT_EQ(grains_of(cursor.of(150, 151)), Grains{150}) << "a part of the same again";
  EXPECT_EQ(grains_of(cursor.of(1, 4)), Grains{3}) << "back";
  EXPECT_EQ(grains_of(cursor.of(190, 500)), (Grains{192, 195, 198})) << "past the end";
  EXPECT_EQ(grains_of(cursor.of(500, 600)), Grains{});
  EXPECT_EQ(grains_of(cursor.of(198, 199)), Grains{198}) << "back from the end";
}

TEST(LoadCursor, FindsWhatASearchFindsForGrainsOutOfOrder) {
  const std::vector<LoadRecord> loads = every_third(101);
  LoadCursor cursor(loads);
  for (std::size_t k = 0; k < 101; ++k) {
    const std::size_t i = k * 37 % 101;
    EXPECT_EQ(cursor.of(i, i + 1).size(), i % 3 == 0 ? 1u : 0u) << i;
  }
}

TEST(LoadCursor, HasNothingWhereNothingIsLoaded) {
  LoadCursor cursor({});
  EXPECT_TRUE(cursor.of(0, 100).empty());
}

}  // namespace
}  // namespace tuft::dem

#include "core/lane_columns.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <numeric>
#include <vector>

namespace tuft {
namespace {

constexpr std::size_t row_length = 12;

template <class T>
std::vector<T> counted_table(std::size_t rows) {
  std::vector<T> table(rows * row_length);
  std::iota(table.begin(), table.end(), T(1));
  return table;
}

template <class T>
class LaneColumns : public testing::Test {};
using Numbers = testing::Types<double, float>;
TYPED_TEST_SUITE(LaneColumns, Numbers);

TYPED_TEST(LaneColumns, AreTheValuesOfTheRowsNamedWhateverTheirOrder) {
  const auto table = counted_table<TypeParam>(40);
  RowsOf<TypeParam, row_length * sizeof(TypeParam)> rows{table.data(), {}};
  for (std::size_t l = 0; l < rows.at.size(); ++l) rows.at[l] = (17 * l + 5) % 40;
  const auto column = load_columns<8>(rows);
  for (std::size_t c = 0; c < column.size(); ++c)
    for (std::size_t l = 0; l < rows.at.size(); ++l)
      EXPECT_EQ(TypeParam(column[c][l]), table[rows.at[l] * row_length + c])
          << "column " << c << ", lane " << l;
}

TEST(LaneColumnsStored, ReachTheRowsAskedForAndNothingElse) {
  for (std::size_t count = 1; count <= lanes; ++count) {
    std::vector<float> table(lanes * row_length, -1);
    std::array<NarrowPack, 4> column;
    for (std::size_t c = 0; c < 4; ++c)
      column[c] = NarrowPack([c](auto lane) { return static_cast<float>(10 * std::size_t(lane) + c); });
    store_four_columns(column, count, table.data() + 4, row_length);
    for (std::size_t l = 0; l < lanes; ++l)
      for (std::size_t c = 0; c < row_length; ++c) {
        const bool written = l < count && c >= 4 && c < 8;
        EXPECT_EQ(table[l * row_length + c], written ? static_cast<float>(10 * l + c - 4) : -1.0F)
            << count << " rows, row " << l << ", value " << c;
      }
  }
}

TEST(LaneColumnsStored, NarrowedPacksAreRoundedToTheNearest) {
  const Pack wide([](auto lane) { return 1.0 / (3.0 + double(lane)); });
  const NarrowPack narrow = narrowed(wide);
  for (std::size_t l = 0; l < lanes; ++l) EXPECT_EQ(narrow[l], static_cast<float>(double(wide[l])));
}

TEST(LaneColumnsStored, LowHalvesAreTheLastThirtyTwoBits) {
  const auto bits_of = [](std::size_t lane) { return 0x4338'0000'0000'0000U + 0x1'0000'0001U * (lane + 7); };
  const Pack wide([&](auto lane) { return std::bit_cast<double>(std::uint64_t(bits_of(lane))); });
  const NarrowPack low = low_halves(wide);
  for (std::size_t l = 0; l < lanes; ++l)
    EXPECT_EQ(std::bit_cast<std::uint32_t>(float(low[l])), static_cast<std::uint32_t>(bits_of(l))) << l;
}

TEST(LaneColumnsStored, DifferencesOfIntegersAreExactAcrossTheWrap) {
  const auto pack_of = [](std::uint32_t bits) { return SinglePack(std::bit_cast<float>(bits)); };
  EXPECT_EQ(float(integer_difference(pack_of(5), pack_of(0xFFFF'FFFBU))[0]), 10);
  EXPECT_EQ(float(integer_difference(pack_of(0xFFFF'FFFBU), pack_of(5))[0]), -10);
}

}  // namespace
}  // namespace tuft

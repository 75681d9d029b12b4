/// The memory of ranks as it travels over a network.
#include "dem_bridge/wire_blocks.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

namespace tuft::dem {
namespace {

TEST(WireBlocks, CarryWhatEveryRankTells) {
  const SharedMemory from = SharedMemory::create(4, 3);
  SharedMemory to = SharedMemory::create(4, 3);
  for (std::size_t r = 0; r < 3; ++r) from.rank(r).kinetic = 1.0 + static_cast<double>(r);
  from.array(SharedArrays::position_x)[0] = 7;
  unpack(to, pack(from, ranks_block));
  for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(to.rank(r).kinetic, from.rank(r).kinetic);
  EXPECT_EQ(to.array(SharedArrays::position_x)[0], 0) << "not asked for";
  unpack(to, pack(from, array_block(SharedArrays::position_x)));
  EXPECT_EQ(to.array(SharedArrays::position_x)[0], 7);
}

TEST(WireBlocks, OfAnotherMemoryAreRefusedAndChangeNothing) {
  SharedMemory memory = SharedMemory::create(4, 2);
  for (const auto& [grains, ranks] : {std::pair<std::size_t, std::size_t>{4, 3}, {4, 1}, {5, 2}}) {
    const SharedMemory other = SharedMemory::create(grains, ranks);
    EXPECT_THROW(unpack(memory, pack(other, state_block)), std::runtime_error);
    EXPECT_EQ(memory.state().grains, 4u);
    EXPECT_EQ(memory.state().ranks, 2u);
  }
  const SharedMemory same = SharedMemory::create(4, 2);
  same.state().step = 3;
  unpack(memory, pack(same, state_block));
  EXPECT_EQ(memory.state().step, 3);
  EXPECT_THROW(unpack(memory, pack(SharedMemory::create(4, 3), ranks_block)), std::runtime_error);
}

}  // namespace
}  // namespace tuft::dem

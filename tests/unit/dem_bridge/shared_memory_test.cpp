#include "dem_bridge/shared_memory.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "core/error.h"

namespace tuft::dem {
namespace {

TEST(SharedMemory, BothEndsSeeTheSameNumbersAndTheNameIsGone) {
  const SharedMemory driver = SharedMemory::create(1001, 3);
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm"))
    EXPECT_FALSE(entry.path().filename().string().starts_with("tuft-dem-" + std::to_string(::getpid()) + "-"))
        << entry;
  const int descriptor = ::dup(driver.descriptor());
  const SharedMemory host = SharedMemory::open(descriptor);
  ASSERT_EQ(host.grains(), 1001u);
  for (std::size_t name = 0; name < SharedArrays::count; ++name)
    for (double& value : driver.array(name)) value = static_cast<double>(name) + 0.5;
  for (LoadRecord& load : driver.load_room()) load = {7, {1, 2, 3}, {4, 5, 6}};
  for (std::size_t rank = 0; rank < 3; ++rank) driver.rank(rank).grains = 5 + rank;
  EXPECT_EQ(host.ranks(), 3u);
  EXPECT_EQ(host.grains(), 1001u);
  for (std::size_t rank = 0; rank < 3; ++rank) EXPECT_EQ(host.rank(rank).grains, 5 + rank);
  for (std::size_t name = 0; name < SharedArrays::count; ++name) {
    EXPECT_EQ(host.array(name)[0], static_cast<double>(name) + 0.5) << "arrays overlap";
    EXPECT_EQ(host.array(name)[1000], static_cast<double>(name) + 0.5) << "arrays overlap";
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(host.array(name).data()) % SharedArrays::alignment, 0u);
  }
}

TEST(SharedMemory, HasLoadsOfTheWindowAlone) {
  const SharedMemory memory = SharedMemory::create(10);
  EXPECT_TRUE(memory.loads().empty());
  memory.load_room()[1].grain = 5;
  memory.state().loads = 2;
  ASSERT_EQ(memory.loads().size(), 2u);
  EXPECT_EQ(memory.loads()[1].grain, 5u);
  memory.state().loads = 11;
  EXPECT_THROW((void)memory.loads(), std::runtime_error);
}

TEST(SharedMemory, OtherProtocolVersionIsRefused) {
  const SharedMemory driver = SharedMemory::create(10);
  driver.state().version = protocol_version + 1;
  try {
    const SharedMemory host = SharedMemory::open(::dup(driver.descriptor()));
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("different builds"), std::string::npos) << error.what();
  }
}

TEST(SharedMemory, ThatCannotBeCreatedSaysWhyAndWhatToDo) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none = before;
  none.rlim_cur = 3;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  std::string message;
  try {
    (void)SharedMemory::create(10);
  } catch (const RunError& error) {
    message = error.what();
  }
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_NE(message.find("/tuft-dem-"), std::string::npos) << message;
  EXPECT_NE(message.find("ulimit -n"), std::string::npos) << message;
}

TEST(SharedMemory, KeepsTheLastWords) {
  const SharedMemory memory = SharedMemory::create(1);
  RankState& state = memory.rank(0);
  const std::string said(10000, 'a');
  for (char c : said + "ERROR: the end\n") state.words[state.words_written++ % state.words.size()] = c;
  EXPECT_EQ(memory.words().size(), state.words.size());
  EXPECT_TRUE(memory.words().ends_with("aERROR: the end\n"));
}

}  // namespace
}  // namespace tuft::dem

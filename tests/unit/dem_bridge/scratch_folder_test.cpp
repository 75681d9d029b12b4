#include "dem_bridge/scratch_folder.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;

/// Many programs that begin at one moment: each makes a folder, sweeping what killed programs left. A lock
/// belongs to an open file and not to a process, so threads contend for it as programs do.
TEST(ScratchFolder, IsNeverSweptWhileItLivesHoweverManyBeginTogether) {
  std::vector<int> lost(8, 0);
  std::vector<std::thread> programs;
  for (int& mine : lost)
    programs.emplace_back([&mine] {
      for (int k = 0; k < 400; ++k) {
        const ScratchFolder folder;
        mine += !std::ofstream(folder.path() / "socket") || !fs::exists(folder.path() / "lock");
      }
    });
  for (std::thread& program : programs) program.join();
  for (const int count : lost) EXPECT_EQ(count, 0);
}

TEST(ScratchFolder, HoldsNothingAtFirstButItsLockAndIsGoneAtItsEnd) {
  fs::path path;
  {
    const ScratchFolder folder;
    path = folder.path();
    for (const auto& entry : fs::directory_iterator(path)) EXPECT_EQ(entry.path().filename(), "lock");
    std::ofstream(path / "restart") << "a file of the host's";
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(ScratchFolder, SweepsAFolderWhoseLockNobodyHolds) {
  const fs::path left = fs::temp_directory_path() / ("tuft-dem-left-" + std::to_string(::getpid()));
  fs::create_directory(left);
  std::ofstream(left / "lock").close();
  std::ofstream(left / "restart").close();
  { const ScratchFolder next; }
  EXPECT_FALSE(fs::exists(left));
}

TEST(ScratchFolder, SweepsAFolderWithoutALockOnceItCannotBeOneThatIsBeingMade) {
  const fs::path left = fs::temp_directory_path() / ("tuft-dem-bare-" + std::to_string(::getpid()));
  fs::create_directory(left);
  { const ScratchFolder next; }
  EXPECT_TRUE(fs::exists(left)) << "its maker may be about to place the lock";
  fs::last_write_time(left, fs::file_time_type::clock::now() - std::chrono::seconds(10));
  { const ScratchFolder next; }
  EXPECT_FALSE(fs::exists(left));
}

}  // namespace
}  // namespace tuft::dem

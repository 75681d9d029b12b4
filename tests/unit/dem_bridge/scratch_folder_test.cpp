#include "dem_bridge/scratch_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;
constexpr seconds long_grace{1'000'000};

/// A temporary folder of the test's own: what others left, or sweep, does not matter.
class ScratchFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    before_ = std::getenv("TMPDIR") == nullptr ? "" : std::getenv("TMPDIR");
    std::string pattern = (fs::temp_directory_path() / "scratch-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    temporary_ = pattern;
    set_temporary(temporary_);
    const ScratchFolder one;
    const std::string name = one.path().filename();
    begin_ = name.substr(0, name.size() - 6);
  }
  void TearDown() override {
    before_.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before_.c_str(), 1);
    fs::remove_all(temporary_);
  }
  static void set_temporary(const fs::path& folder) { ::setenv("TMPDIR", folder.c_str(), 1); }

  /// As a program that was killed leaves it.
  [[nodiscard]] fs::path leave(const std::string& name, bool with_file) const {
    const fs::path folder = temporary_ / name;
    fs::create_directory(folder);
    if (with_file) std::ofstream(folder / "restart") << "a file of the host's";
    return folder;
  }
  [[nodiscard]] std::string message_of_failure() const {
    try {
      const ScratchFolder folder;
    } catch (const RunError& error) {
      return error.what();
    }
    return "";
  }

  fs::path temporary_;
  std::string begin_;  ///< of the folders' names, as far as they are alike

 private:
  std::string before_;
};

/// Without grace each program that begins sweeps what others have made and not locked yet. A lock belongs to
/// an open file and not to a process, so threads contend for it as programs do. Now and then
/// one leaves a folder as if it had been killed.
TEST_F(ScratchFolderTest, IsNeverSweptWhileItLivesHoweverManyBeginTogetherWithoutGrace) {
  std::atomic<int> lost{0};
  std::vector<std::thread> programs;
  for (int m = 0; m < 8; ++m)
    programs.emplace_back([&, m] {
      for (int k = 0; k < 400; ++k) {
        if (k % 8 == m) (void)leave(begin_ + std::to_string(100'000 * (m + 1) + k), k % 16 == m);
        const ScratchFolder folder(seconds(0));
        std::this_thread::yield();
        std::error_code gone;
        const bool alive = fs::is_empty(folder.path(), gone) && std::ofstream(folder.path() / "socket");
        std::this_thread::yield();
        lost += !alive || !fs::exists(folder.path() / "socket");
      }
    });
  for (std::thread& program : programs) program.join();
  EXPECT_EQ(lost, 0);
  { const ScratchFolder next(seconds(0)); }
  EXPECT_TRUE(fs::is_empty(temporary_));
}

TEST_F(ScratchFolderTest, IsEmptyAtFirstAndGoneAtItsEnd) {
  fs::path path;
  {
    const ScratchFolder folder;
    path = folder.path();
    EXPECT_TRUE(fs::is_empty(path));
    std::ofstream(path / "restart") << "a file of the host's";
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(ScratchFolderTest, SweepsWhatHoldsSomethingAndNobodyHoldsAtOnce) {
  const fs::path left = leave(begin_ + "aaaaaa", true);
  { const ScratchFolder next(long_grace); }
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(ScratchFolderTest, SweepsWhatIsEmptyOnceItIsNotBeingMade) {
  const fs::path left = leave(begin_ + "aaaaaa", false);
  { const ScratchFolder next(long_grace); }
  EXPECT_TRUE(fs::exists(left)) << "its maker may be about to lock it";
  for (const int age : {10, -10}) {  // s: clocks may differ
    fs::create_directories(left);
    fs::last_write_time(left, fs::file_time_type::clock::now() - seconds(age));
    { const ScratchFolder next(seconds(5)); }
    EXPECT_FALSE(fs::exists(left)) << age << " s";
  }
}

TEST_F(ScratchFolderTest, LeavesAloneWhatSomeoneHolds) {
  for (const bool with_file : {false, true}) {
    const fs::path left = leave(begin_ + "aaaaaa", with_file);
    const int lock = ::open(left.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
    { const ScratchFolder next(seconds(0)); }
    EXPECT_TRUE(fs::exists(left));
    ::close(lock);
    { const ScratchFolder next(seconds(0)); }
    EXPECT_FALSE(fs::exists(left));
  }
}

/// Of another machine, of what earlier versions made (it holds a file `lock`), of anyone else.
TEST_F(ScratchFolderTest, SweepsItsOwnMachinesAlone) {
  std::string other = begin_;
  char& digit = other[std::string("tuft-").size()];
  digit = digit == '0' ? '1' : '0';
  for (const std::string& name : {other + "aaaaaa", std::string("tuft-dem-aaaaaa"), begin_ + "reports"}) {
    const fs::path left = leave(name, true);
    { const ScratchFolder next(seconds(0)); }
    EXPECT_TRUE(fs::exists(left)) << left;
  }
}

TEST_F(ScratchFolderTest, DoesNotFollowALink) {
  const fs::path target = leave("target", true);
  fs::create_directory_symlink(target, temporary_ / (begin_ + "aaaaaa"));
  { const ScratchFolder next(seconds(0)); }
  EXPECT_TRUE(fs::exists(target / "restart"));
}

TEST_F(ScratchFolderTest, OfAProgramThatWasKilledIsSwept) {
  const pid_t program = ::fork();
  if (program == 0) {
    const ScratchFolder folder;
    std::ofstream(folder.path() / "restart") << "a file of the host's";
    ::raise(SIGKILL);
  }
  ASSERT_EQ(::waitpid(program, nullptr, 0), program);
  EXPECT_FALSE(fs::is_empty(temporary_));
  { const ScratchFolder next(long_grace); }
  EXPECT_TRUE(fs::is_empty(temporary_));
}

TEST_F(ScratchFolderTest, HasRoomForASocketsPathHoweverLongTheTemporaryFoldersIs) {
  fs::path deep = temporary_ / "d";
  for (; deep.string().size() < 120; deep += "e") {
    fs::create_directories(deep);
    set_temporary(deep);
    const ScratchFolder folder;
    EXPECT_LE((folder.path() / "control").string().size(), 107u);
    const bool fits = (deep / folder.path().filename() / "control").string().size() <= 107;
    EXPECT_EQ(folder.path().parent_path(), fits ? deep : fs::path("/tmp"));
  }
}

TEST_F(ScratchFolderTest, ThatCannotBeMadeSaysWhereAndWhatToDo) {
  set_temporary("/proc");
  const std::string message = message_of_failure();
  EXPECT_NE(message.find("/proc"), std::string::npos) << message;
  EXPECT_NE(message.find("set TMPDIR"), std::string::npos) << message;
}

TEST_F(ScratchFolderTest, ThatCannotBeLockedSaysWhyAndIsNotLeft) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit none = before;
  none.rlim_cur = 3;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string message = message_of_failure();
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_NE(message.find(temporary_.string()), std::string::npos) << message;
  EXPECT_NE(message.find("ulimit -n"), std::string::npos) << message;
  EXPECT_TRUE(fs::is_empty(temporary_));
}

}  // namespace
}  // namespace tuft::dem

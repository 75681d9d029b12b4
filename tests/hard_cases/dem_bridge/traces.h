#pragma once
/// Looks for what a host may leave behind.
#include <dirent.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace tuft::dem::test {

/// True when no process has the number, or it is a zombie that its new parent has not collected yet.
inline bool process_is_gone(int process) {
  std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
  std::string line;
  if (!std::getline(stat, line)) return true;
  return line.substr(line.rfind(')') + 2, 1) == "Z";
}

inline bool gone_within(int process, double seconds) {
  for (int i = 0; i < seconds * 100; ++i) {
    if (process_is_gone(process)) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Processes that the process has started, and theirs.
inline std::vector<int> descendants(int process) {
  std::vector<int> found;
  const std::string task = "/proc/" + std::to_string(process) + "/task/";
  std::error_code ended;
  for (const auto& thread : std::filesystem::directory_iterator(task, ended)) {
    std::ifstream children(thread.path() / "children");
    for (int child = 0; children >> child;) {
      found.push_back(child);
      const auto below = descendants(child);
      found.insert(found.end(), below.begin(), below.end());
    }
  }
  return found;
}

/// A temporary folder of the test's own, so that whatever is in it at the end was left by the test.
class Traces : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "traces-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    before_ = std::getenv("TMPDIR") == nullptr ? "" : std::getenv("TMPDIR");
    ::setenv("TMPDIR", folder_.c_str(), 1);
    shared_before_ = shared_memory();
  }
  void TearDown() override {
    if (before_.empty())
      ::unsetenv("TMPDIR");
    else
      ::setenv("TMPDIR", before_.c_str(), 1);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      ADD_FAILURE() << "left in the temporary folder: " << entry.path();
    std::filesystem::remove_all(folder_);
    for (const std::string& name : shared_memory())
      EXPECT_TRUE(shared_before_.contains(name)) << "left in /dev/shm: " << name;
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child was left";
    EXPECT_EQ(errno, ECHILD);
  }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  /// Blocks of ours, and those that ranks of Open MPI talk through.
  static std::set<std::string> shared_memory() {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator("/dev/shm"))
      if (const std::string name = entry.path().filename();
          name.starts_with("tuft-dem-" + std::to_string(::getpid())) || name.starts_with("vader_segment"))
        names.insert(name);
    return names;
  }

  std::set<std::string> shared_before_;
  std::filesystem::path folder_;
  std::string before_;
};

/// The message of the RunError (or other Error) that `action` throws.
template <class Error, class Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

inline bool is_one_line(const std::string& text) {
  return !text.empty() && text.find('\n') == std::string::npos;
}

}  // namespace tuft::dem::test

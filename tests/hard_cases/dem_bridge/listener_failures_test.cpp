/// A listener that cannot serve says so in one line and ends; it does not try without pause.
#include <cstdlib>
#include <sstream>

#include "dem_bridge/host_process.h"
#include "tests/hard_cases/dem_bridge/traces.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;

class ListenerFailure : public Traces {
 protected:
  struct Outcome {
    int exit_code = -1;
    std::string said, complained;
  };
  /// By a shell, after `before`, at a port that the system chooses. Files that it inherits are closed.
  [[nodiscard]] Outcome listen(const std::string& before, const std::string& options = "") const {
    const fs::path out = folder() / "out", errors = folder() / "errors";
    const std::string command = "exec > " + out.string() + " 2> " + errors.string() +
                                " 3>&- 4>&- 5>&- 6>&-; " + before + " exec timeout 60 " +
                                find_host("").string() + " --listen 'tcp://127.0.0.1:*' " + options;
    const int status = std::system(command.c_str());
    const Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(errors)};
    fs::remove(out);
    fs::remove(errors);
    return outcome;
  }

 private:
  static std::string text_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
};

/// The line without its end.
std::string line_of(const std::string& text) {
  return text.substr(0, text.empty() ? 0 : text.size() - 1);
}

TEST_F(ListenerFailure, WithoutAFolderItCanWriteIsOneClearLine) {
  const Outcome outcome = listen("export TMPDIR=/proc;", "--once");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(is_one_line(line_of(outcome.complained))) << outcome.complained;
  EXPECT_TRUE(outcome.complained.starts_with("ERROR: no folder can be made in /proc")) << outcome.complained;
  EXPECT_NE(outcome.complained.find("set TMPDIR"), std::string::npos) << outcome.complained;
}

/// So few open files that the listener goes but no host does.
TEST_F(ListenerFailure, OfHostsThatFailAtOncePausesAndGivesUp) {
  const auto begin = std::chrono::steady_clock::now();
  const Outcome outcome = listen("ulimit -n 7;");
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1 + 2 + 4 + 8));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.said;
  std::size_t lives = 0;
  for (std::size_t at = 0; (at = outcome.said.find("a run's host ended", at)) != std::string::npos; ++at)
    ++lives;
  EXPECT_EQ(lives, 5u) << outcome.said;
  EXPECT_TRUE(is_one_line(line_of(outcome.complained))) << outcome.complained;
  EXPECT_TRUE(outcome.complained.starts_with("ERROR: 5 hosts in a row")) << outcome.complained;
}

}  // namespace
}  // namespace tuft::dem::test

/// A listener that cannot serve says so in one line and ends.
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

}  // namespace
}  // namespace tuft::dem::test

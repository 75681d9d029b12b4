/// How threads wait, as OpenMP's library says it at its start.
#include <cstdlib>

#include "cli/commands/command.h"

namespace tuft::test {
namespace {

/// The environment as a user has it who set nothing, or this one variable.
class Environment {
 public:
  explicit Environment(const char* name = nullptr, const char* value = "") {
    for (const char* other : {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT"}) unsetenv(other);
    setenv("OMP_DISPLAY_ENV", "verbose", 1);
    if (name != nullptr) setenv(name, value, 1);
  }
  ~Environment() {
    unsetenv("OMP_DISPLAY_ENV");
    unsetenv("OMP_WAIT_POLICY");
    setenv("GOMP_SPINCOUNT", "1000", 1);  // as for all tests (tests/CMakeLists.txt)
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
};

TEST(ShortWaits, AreThoseOfAProgramWhoseUserSaysNothing) {
  const Environment environment;
  const Outcome outcome = run_tuft({"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  const std::size_t last = outcome.error.rfind("GOMP_SPINCOUNT");
  ASSERT_NE(last, std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("'1000'", last), std::string::npos) << outcome.error.substr(last);
}

TEST(ShortWaits, YieldToWhatTheUserSays) {
  for (const auto& [name, value] : {std::pair{"OMP_WAIT_POLICY", "active"}, {"GOMP_SPINCOUNT", "77"}}) {
    const Environment environment(name, value);
    const Outcome outcome = run_tuft({"--version"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_NE(outcome.error.find("GOMP_SPINCOUNT"), std::string::npos) << outcome.error;
    EXPECT_EQ(outcome.error.find("'1000'"), std::string::npos) << outcome.error;
  }
}

}  // namespace
}  // namespace tuft::test

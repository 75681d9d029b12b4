#pragma once
/// Runs the built `tuft` as a user would, and looks at what came back.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace tuft::test {

struct Outcome {
  int exit_code = 0;
  std::string out, error;
};

/// What happens to a run from outside.
struct Trouble {
  double interrupt_after = 0;  ///< s, > 0: SIGINT once after so long
  long largest_file = 0;       ///< bytes, > 0: no file may grow beyond them, as on a full disk
  std::string kill_host_at{};  ///< a file: as soon as it exists the DEM host gets SIGKILL
};

/// Runs `tuft` with these arguments.
[[nodiscard]] Outcome run_tuft(const std::vector<std::string>& arguments, const Trouble& trouble = {});

/// Exit code 2 and one line on standard error that begins "tuft: error: " and holds each of `parts`.
void expect_bad_input(const Outcome& outcome, const std::vector<std::string>& parts);
/// The same with exit code 1.
void expect_failed_run(const Outcome& outcome, const std::vector<std::string>& parts);

/// A folder for one test, removed at the end.
class Workplace {
 public:
  Workplace();
  ~Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;
  [[nodiscard]] std::string path(const std::string& name) const { return (root_ / name).string(); }
  void write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path root_;
};

/// A scene of some hundred particles, some hundred windows long: SCENE and the --set options that make it
/// small.
[[nodiscard]] std::vector<std::string> tiny_scene();
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

}  // namespace tuft::test

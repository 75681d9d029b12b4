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

/// Runs `tuft` with these arguments. `interrupt_after` > 0: sends SIGINT once after so many seconds.
/// `largest_file` > 0: no file may grow beyond so many bytes, as on a full disk.
[[nodiscard]] Outcome run_tuft(const std::vector<std::string>& arguments, double interrupt_after = 0,
                               long largest_file = 0);

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

#pragma once
/// Runs the built `tuft` as a user would, and looks at what came back.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace tuft::test {

struct Outcome {
  int exit_code = 0;  ///< 128 + n: ended by signal n
  std::string out, error;
  bool struck = false;  ///< the blow fell
  double seconds = 0;   ///< from the blow, where it fell, else from the start
};

/// Processes of a run with grains.
struct Processes {
  int tuft = 0, host = 0;
};

/// What happens to a run from outside.
struct Trouble {
  double interrupt_after = 0;  ///< s, > 0: SIGINT once after so long
  long largest_file = 0;       ///< bytes, > 0: no file may grow beyond them, as on a full disk
  std::string blow_at{};       ///< a file: as soon as it exists, and a host, `blow` falls
  std::function<void(const Processes&)> blow{};
};
[[nodiscard]] Trouble kill_host_at(const std::string& file);

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

/// A `tuft` at work, in the environment as it is when it starts.
class RunningTuft {
 public:
  explicit RunningTuft(const std::vector<std::string>& arguments, const Trouble& trouble = {});
  ~RunningTuft();
  RunningTuft(const RunningTuft&) = delete;
  RunningTuft& operator=(const RunningTuft&) = delete;
  /// Lets the trouble come, and waits for the end.
  [[nodiscard]] Outcome wait();

 private:
  Workplace place_;
  Trouble trouble_;
  std::chrono::steady_clock::time_point start_;
  int process_ = 0;  ///< 0: has ended
};

/// Runs `tuft` with these arguments.
[[nodiscard]] Outcome run_tuft(const std::vector<std::string>& arguments, const Trouble& trouble = {});

/// Exit code 2 and one line on standard error that begins "tuft: error: " and holds each of `parts`.
void expect_bad_input(const Outcome& outcome, const std::vector<std::string>& parts);
/// The same with exit code 1.
void expect_failed_run(const Outcome& outcome, const std::vector<std::string>& parts);

/// A scene of some hundred particles, some hundred windows long: SCENE and the --set options that make it
/// small.
[[nodiscard]] std::vector<std::string> tiny_scene();
/// `tuft run` of that scene.
[[nodiscard]] std::vector<std::string> tiny_run(const std::string& folder,
                                                const std::vector<std::string>& more = {});
/// The same on grains, packed anew.
[[nodiscard]] std::vector<std::string> grain_run(const std::string& folder,
                                                 const std::vector<std::string>& more = {});
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

}  // namespace tuft::test

#pragma once
/// A run's folder with made-up records in the form that `tuft run` writes: what the report and the XDMF
/// writer read.
#include <filesystem>
#include <string>

#include "core/scene.h"
#include "rigs/run.h"

namespace tuft::test {

/// A folder of its own for one test, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct FakeRun {
  Approach approach = Approach::sph;
  double peak_g = 50;      ///< of a half-sine pulse
  double pulse = 0.012;    ///< s, length of it
  double touch = 0.001;    ///< s after release
  double duration = 0.03;  ///< s
  double frame_interval = 0.0005;
};

[[nodiscard]] Scene fake_scene(Approach approach);
[[nodiscard]] rigs::RunSummary fake_summary(const FakeRun& run);
/// Writes scene.toml, summary.json and run.h5 with histories, energies, cost and frames.
void write_fake_run(const std::filesystem::path& folder, const FakeRun& run);
/// The same as a run leaves it that failed before anything was recorded.
void write_failed_run(const std::filesystem::path& folder, Approach approach, const std::string& error);

}  // namespace tuft::test

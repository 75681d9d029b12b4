// The peak of a drop on turf must not depend on the step. Among fibres a drop is chaotic, so that two single
// runs differ whatever distinguishes them: what a step can change is the expected peak, and that takes many
// runs.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "core/scene_reader.h"
#include "rigs/run.h"

namespace tuft::rigs {
namespace {

/// With a standard deviation of 0.3 g of 53 g the change of the means has a standard error of under 0.2 %.
constexpr int runs = 24;

struct Sample {
  double mean = 0, variance_of_mean = 0;  ///< g, g^2
};

/// Filtered peak of one drop. `nudge` tells runs apart by that many times 1e-8 m/s of impact speed.
double peak(double step_safety, int nudge) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("tuft-halving-" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  RunRequest request;
  request.scene =
      read_scene("inputs/clegg_small.toml", {{"scene.duration", "15 ms"},
                                             {"output.frames", "5 ms"},
                                             {"numerics.step_safety", fmt::format("{}", step_safety)},
                                             {"rig.speed", fmt::format("\"{}e-8 m/s\"", 285000000 + nudge)}});
  request.folder = folder;
  const RunSummary summary = run(request);
  std::filesystem::remove_all(folder);
  EXPECT_EQ(summary.status, "completed") << summary.error;
  return summary.status == "completed" ? summary.results.at("peak_g").value : 0;
}

Sample sample(double step_safety) {
  double sum = 0, squares = 0;
  for (int i = 0; i < runs; ++i) {
    const double g = peak(step_safety, i);
    std::printf("step_safety %.2f, run %d: %.2f g\n", step_safety, i, g);
    std::fflush(stdout);
    sum += g;
    squares += g * g;
  }
  const double mean = sum / runs;
  return {mean, (squares / runs - mean * mean) / (runs - 1)};
}

TEST(SphDropOnTurf, HalvingTheStepChangesTheExpectedPeakByUnderOnePercent) {
  const Sample whole = sample(0.8), half = sample(0.4);
  const double change = (half.mean - whole.mean) / whole.mean;
  const double error = std::sqrt(whole.variance_of_mean + half.variance_of_mean) / whole.mean;
  std::printf("means %.3f g and %.3f g: change %.2f %%, standard error %.2f %%\n", whole.mean, half.mean,
              100 * change, 100 * error);
  EXPECT_LT(std::abs(change), 0.01);
  // Otherwise the runs scatter too much for the line above to mean anything.
  EXPECT_LT(error, 0.0025);
}

}  // namespace
}  // namespace tuft::rigs

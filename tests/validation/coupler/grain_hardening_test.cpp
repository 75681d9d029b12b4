// A bed of grains that a plate has pressed answers harder, as real turf does: 53 g as laid and 72 g compacted
// (Bustamante et al. 2024). Both beds are at rest before the missile falls. Minutes a drop.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "core/scene_reader.h"
#include "rigs/run.h"

namespace tuft::rigs {
namespace {

/// docs/conditioning.md, "Which grains keep their compaction".
Overrides plastic(const Overrides& more = {}) {
  Overrides overrides{{"infill.approach", "dem"},
                      {"infill.dem.host", TUFT_TEST_HOST},
                      {"infill.dem.contact", "hooke_hysteresis"},
                      {"infill.dem.unloading_ratio", "5"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

RunSummary drop(const Overrides& overrides) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("tuft-hardening-" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  RunRequest request;
  request.scene = read_scene("inputs/clegg_small.toml", overrides);
  request.folder = folder;
  RunSummary summary = run(request);
  std::filesystem::remove_all(folder);
  EXPECT_EQ(summary.status, "completed") << summary.error;
  return summary;
}

/// g, of a bed at rest. Between seeds, and between processors, peaks differ by some 4 %
/// (docs/conditioning.md).
double peak_of(const char* what, const char* seed, const Overrides& more) {
  Overrides overrides = plastic(more);
  overrides.emplace_back("numerics.seed", seed);
  const RunSummary s = drop(overrides);
  if (s.status != "completed") return 0;
  const double peak = s.results.at("peak_g").value;
  std::printf("seed %s, %s: %.1f g on %.1f mm\n", seed, what, peak,
              1e3 * s.notes.at("bed_released_depth").value);
  EXPECT_EQ(s.notes.at("bed_at_rest").value, 1);
  if (!more.empty()) {
    EXPECT_EQ(s.notes.at("conditioning_stays").value, 1);
  }
  return peak;
}

TEST(GrainsOnTurf, PressedByTenMillimetresAnswerThirtyPercentHarder) {
  const Overrides press{{"conditioning.method", "compaction"}, {"conditioning.depth", "10 mm"},
                        {"conditioning.press_time", "12 ms"},  {"conditioning.lift_time", "8 ms"},
                        {"conditioning.settle_time", "5 ms"},  {"conditioning.presses", "5"},
                        {"conditioning.tolerance", "0.5 mm"}};
  double laid = 0, pressed = 0;
  for (const char* seed : {"1", "2"}) {
    laid += peak_of("as laid", seed, {});
    pressed += peak_of("pressed", seed, press);
  }
  ASSERT_GT(laid, 0);
  EXPECT_GE(pressed, 1.3 * laid);
}

}  // namespace
}  // namespace tuft::rigs

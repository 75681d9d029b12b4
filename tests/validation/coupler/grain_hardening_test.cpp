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

TEST(GrainsOnTurf, PressedByTenMillimetresAnswerThirtyPercentHarder) {
  const RunSummary laid = drop(plastic());
  const RunSummary pressed = drop(plastic({{"conditioning.method", "compaction"},
                                           {"conditioning.depth", "10 mm"},
                                           {"conditioning.press_time", "12 ms"},
                                           {"conditioning.lift_time", "8 ms"},
                                           {"conditioning.settle_time", "5 ms"},
                                           {"conditioning.presses", "5"},
                                           {"conditioning.tolerance", "0.5 mm"}}));
  ASSERT_TRUE(laid.status == "completed" && pressed.status == "completed");
  const auto peak = [](const RunSummary& s) { return s.results.at("peak_g").value; };
  const auto note = [](const RunSummary& s, const char* name) { return s.notes.at(name).value; };
  std::printf("as laid %.1f g on %.1f mm, pressed %.1f g on %.1f mm\n", peak(laid),
              1e3 * note(laid, "bed_released_depth"), peak(pressed),
              1e3 * note(pressed, "bed_released_depth"));
  EXPECT_EQ(note(laid, "bed_at_rest"), 1);
  EXPECT_EQ(note(pressed, "bed_at_rest"), 1);
  EXPECT_EQ(note(pressed, "conditioning_stays"), 1);
  EXPECT_GE(peak(pressed), 1.3 * peak(laid));
}

}  // namespace
}  // namespace tuft::rigs

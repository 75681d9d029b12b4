// Whole drops on SPH infill without a carpet: what pitch, sleep and speed do to them.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "coarse_scene.h"

namespace tuft::rigs {
namespace {

RunSummary drop(const std::string& name, Overrides overrides) {
  overrides.insert(overrides.begin(), {"effects.fibres", "false"});
  RunRequest request;
  request.scene = coarse_scene(overrides);
  request.folder = fresh_folder(name);
  RunSummary summary = run(request);
  EXPECT_EQ(summary.error, "");
  return summary;
}

double peak_of(const RunSummary& summary) {
  return summary.results.at("peak_g").value;
}

TEST(BareDrop, WithSleepAndStepsOfTheirOwnHasThePeakOfOneStepForAllAwake) {
  const Overrides one{{"infill.sph.pitch", "4 mm"}, {"scene.duration", "12 ms"}};
  Overrides both = one;
  both.insert(both.end(), {{"numerics.individual_steps", "8"}, {"numerics.sleep_tolerance", "5e-4"}});
  const RunSummary slow = drop("one-step-awake", one), quick = drop("own-steps-asleep", both);
  RecordProperty("change", testing::PrintToString(peak_of(quick) / peak_of(slow) - 1));
  EXPECT_NEAR(peak_of(quick), peak_of(slow), 0.005 * peak_of(slow));
  EXPECT_LT(quick.notes.at("particle_steps").value, 0.65 * slow.notes.at("particle_steps").value);
  EXPECT_LT(quick.energy_error, 0.005);
}

/// The Clegg missile, 2.25 kg, at ten times its speed: a hundred times the energy.
class FastMissile : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Presets, FastMissile, testing::Values("accurate", "paper"));

TEST_P(FastMissile, AtThirtyMetresPerSecondIsStoppedByTheBedWithItsEnergyInBalance) {
  const RunSummary s = drop(std::string("fast-") + GetParam(), {{"infill.sph.preset", GetParam()},
                                                                {"rig.speed", "30 m/s"},
                                                                {"scene.duration", "8 ms"},
                                                                {"output.histories", "10 us"}});
  ASSERT_EQ(s.status, "completed");
  RecordProperty("energy_error", testing::PrintToString(s.energy_error));
  RecordProperty("penetration", testing::PrintToString(s.results.at("max_penetration").value));
  EXPECT_LT(s.energy_error, 0.01);
  EXPECT_LT(s.momentum_error, 1e-9);
  EXPECT_GT(s.results.at("max_penetration").value, 0.02);
  EXPECT_LT(s.results.at("max_penetration").value, 0.05) << "deeper than the bed";
  EXPECT_GT(s.results.at("rebound_velocity").value, 0);
}

/// 23 mm of rubber have six rows up to a pitch of 4.18 mm, five beyond. Where the missile stands over the
/// lattice moves single peaks by 1 % at these pitches, so means over four places in a cell are compared.
TEST(BareDrop, KeepsItsPeakWhereThePitchLosesARowOfALayer) {
  const auto mean_peak = [](double pitch) {
    const double cell = 80.0 / std::round(80.0 / pitch);
    double sum = 0;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.5, 0.0}, {0.5, 0.5}, {0.25, 0.25}})
      sum += peak_of(
          drop("rows", {{"turf.size", "[\"80 mm\", \"80 mm\"]"},
                        {"infill.sph.pitch", fmt::format("{} mm", pitch)},
                        {"scene.duration", "9 ms"},
                        {"rig.position", fmt::format("[\"{} mm\", \"{} mm\"]", x * cell, y * cell)}}));
    return sum / 4;
  };
  const double six = mean_peak(4.18), five = mean_peak(4.19);
  RecordProperty("jump", testing::PrintToString(five / six - 1));
  EXPECT_NEAR(five, six, 0.02 * six);
}

}  // namespace
}  // namespace tuft::rigs

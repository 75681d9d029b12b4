/// Oedometric (P) waves in a bar: their speed, and how ends reflect them.
#include <gtest/gtest.h>

#include "tests/verification/sph_infill/cases/waves.h"

namespace tuft::sph {
namespace {

class PressureWave : public testing::TestWithParam<test::Preset> {
 protected:
  /// At the wall and at the free end.
  static void expect_reflections(const test::PulseResult& r) {
    RecordProperty("wall_velocity", testing::PrintToString(r.wall_velocity));
    RecordProperty("wall_stress", testing::PrintToString(r.wall_stress));
    RecordProperty("free_velocity", testing::PrintToString(r.free_velocity));
    RecordProperty("free_stress", testing::PrintToString(r.free_stress));
    EXPECT_NEAR(r.wall_velocity, -1, 0.02);
    EXPECT_NEAR(r.wall_stress, 1, 0.02);
    // With 18 neighbours a short wave train trails the pulse, and lifts one peak in four by 5 %.
    EXPECT_NEAR(r.free_velocity, 1, GetParam() == test::Preset::paper ? 0.08 : 0.02);
    EXPECT_NEAR(r.free_stress, -1, 0.02);
  }
};
INSTANTIATE_TEST_SUITE_P(Presets, PressureWave,
                         testing::Values(test::Preset::accurate, test::Preset::fast, test::Preset::paper));

constexpr double no_viscosity = 0;

TEST_P(PressureWave, RunsAtTheOedometricSpeedWithinOnePercent) {
  const test::ModeResult r = test::free_bar_mode({GetParam(), no_viscosity}, {60});
  RecordProperty("speed_over_theory", testing::PrintToString(r.speed));
  EXPECT_NEAR(r.speed, 1, 0.01);
  EXPECT_NEAR(r.quarter, 1, 0.01);
}

/// Left alone, zero-energy modes of 18 neighbours grow in a bar this fine until it has no period to speak of.
TEST(FinePressureWave, KeepsItsSpeedWithEighteenNeighboursWhereZeroEnergyModesAreControlled) {
  EXPECT_NEAR(test::free_bar_mode({test::Preset::paper, no_viscosity, 0.05}, {120}).speed, 1, 0.003);
}

/// A pulse of 17 particles' length (two standard deviations) in 120. Signs as one reads them: a wall turns
/// the velocity around and keeps the stress, a free end the other way.
TEST_P(PressureWave, IsReflectedByAWallAndByAFreeEndWithTheRightSignAndAmplitude) {
  const test::PulseResult r = test::reflected_pulse({GetParam(), no_viscosity}, {120}, 0.07);
  RecordProperty("doubled_stress", testing::PrintToString(r.doubled_stress));
  EXPECT_NEAR(r.speed, 1, 0.02);
  expect_reflections(r);
  EXPECT_NEAR(r.doubled_stress, 2, 0.15);
  EXPECT_LT(r.energy_error, 1e-3);
}

/// The same where rows strain shares of their cells and the wall is a spring of half a row, as in a scene.
TEST_P(PressureWave, IsReflectedSoByAWallThatIsASpringOfHalfARow) {
  const test::PulseResult r = test::reflected_pulse({GetParam(), no_viscosity}, {120, 0.12, true}, 0.07);
  RecordProperty("wall_force", testing::PrintToString(r.wall_force));
  RecordProperty("energy_error", testing::PrintToString(r.energy_error));
  expect_reflections(r);
  EXPECT_NEAR(r.wall_force, 2, 0.05);
  EXPECT_LT(r.energy_error, 1e-3);
}

}  // namespace
}  // namespace tuft::sph

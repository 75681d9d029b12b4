/// Columns of dry grains collapse as published ones do. Finer ones, all four aspect ratios and their
/// convergence: tests/validation/sph_infill, docs/verification/sph.md.
#include <gtest/gtest.h>

#include <array>

#include "tests/verification/sph_infill/cases/column_collapse.h"

namespace tuft::sph {
namespace {

test::CollapseResult collapse(double aspect, int particles, double friction, bool axisymmetric = false,
                              const test::Numerics& numerics = {}) {
  test::CollapseCase c;
  c.aspect = aspect;
  c.particles = particles;
  c.friction = friction;
  c.axisymmetric = axisymmetric;
  return test::column_collapse(numerics, c);
}

constexpr double grains = 0.5774, negative_control = 2.0;  // tan 30 degrees

/// Shares of particles nearer than half a pitch to another. Nothing pulls them together: a lattice that
/// spreads to three times its length has rows a third as far apart, which no force of a continuum sets right,
/// and walls press rows together besides. Measured: 0.23 in the slab, 0.30 in the quarter cylinder, where
/// more stand at walls. More would be particles that pair.
constexpr double most_close_in_a_slab = 0.3, most_close_in_a_wedge = 0.4;

TEST(PlaneColumn, OfAspectTwoRunsOutWithinThePublishedBand) {
  const test::CollapseResult r = collapse(2, 12, grains);
  const test::RunOutLaws band = test::published_run_out(false, 2);
  RecordProperty("run_out", testing::PrintToString(r.run_out));
  RecordProperty("close", testing::PrintToString(r.close));
  EXPECT_GT(r.run_out, band.low);
  EXPECT_LT(r.run_out, band.high);
  EXPECT_LT(r.energy_error, 1e-3);
  EXPECT_LT(r.kinetic, 1e-4);
  EXPECT_LT(r.spray, 0.02);
  EXPECT_LT(r.close, most_close_in_a_slab);
}

TEST(PlaneColumn, OfFrictionTwoFallsOutsideTheBand) {
  const test::CollapseResult r = collapse(2, 12, negative_control);
  const test::RunOutLaws band = test::published_run_out(false, 2);
  RecordProperty("run_out", testing::PrintToString(r.run_out));
  EXPECT_LT(r.run_out, 0.95 * band.low);
}

/// Slices of 4 and 8 particles, a third and two thirds of L0 thick: without the share that falls to them, the
/// walls would take 22 % from the one and 11 % from the other.
TEST(ColumnInAChannel, LosesTheSameShareOfItsRunOutToTheWallsHoweverThickTheSliceOfTheChannel) {
  const auto kept = [](int slab) {
    test::CollapseCase rough = test::beads_in_a_channel();
    rough.particles = 12;
    rough.slab = slab;
    test::CollapseCase smooth = rough;
    smooth.wall_friction = 0;
    return test::column_collapse({}, rough).run_out / test::column_collapse({}, smooth).run_out;
  };
  const double thin = kept(4), thick = kept(8);
  RecordProperty("kept", testing::PrintToString(std::array{thin, thick}));
  EXPECT_NEAR(thin, thick, 0.05);
  EXPECT_LT(thick, 0.9);
}

TEST(AxisymmetricColumn, OfAspectTwoRunsOutNearThePublishedLaw) {
  const test::CollapseResult r = collapse(2, 10, grains, true);
  const double law = test::published_run_out(true, 2).low;
  RecordProperty("run_out_over_law", testing::PrintToString(r.run_out / law));
  RecordProperty("close", testing::PrintToString(r.close));
  EXPECT_NEAR(r.run_out / law, 1, 0.25);
  EXPECT_LT(r.energy_error, 1e-3);
  EXPECT_LT(r.close, most_close_in_a_wedge);
}

}  // namespace
}  // namespace tuft::sph

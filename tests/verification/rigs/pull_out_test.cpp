// Pull-out against friction on both faces of a strip, with the continuum and with grains.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/scene_reader.h"
#include "rigs/pull_out.h"
#include "verification/rigs/resumed_run.h"
#include "verification/rigs/specimen_support.h"

namespace tuft::rigs {
namespace {

/// A strip as wide as the box, through all of it: between smooth walls grains above and below it meet only
/// through it, so it carries what the platens press with, and F = 2 mu sigma w L. Friction is a quarter of
/// the material's: grains then slide along the strip before they roll.
constexpr FrictionLaw constant{0.12, 0.12, 0}, rising{0.11, 0.15, 300};

Scene strip_through_box(const char* approach, const FrictionLaw& friction, const Overrides& more = {}) {
  Overrides overrides{{"infill.approach", approach},
                      {"infill.dem.use_cache", "false"},
                      {"infill.dem.material_coarse_graining.sbr", "1.5"},
                      {"infill.sph.pitch", "2 mm"},
                      {"turf.carpet.strand_width", "10 mm"},
                      {"turf.carpet.element_length", "4 mm"},
                      {"rig.size", "[\"16 mm\", \"10 mm\"]"},
                      {"rig.height", "14 mm"},
                      {"rig.embedded_length", "0 mm"},
                      {"rig.speeds", "[\"1 mm/s\"]"},
                      {"rig.run_speed", "200 mm/s"},
                      {"rig.load_time", "3 ms"},
                      {"rig.normal_stress", "50 kPa"},
                      {"rig.travel", "2 mm"},
                      {"rig.checkpoint_rows", "60"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  Scene scene = read_scene("inputs/pull_out_sbr.toml", overrides);
  for (Material& material : scene.materials) material.fibre_friction = friction;
  return scene;
}

class StripPullOut : public ::testing::TestWithParam<const char*> {};

TEST_P(StripPullOut, TakesFrictionTimesWhatPressesOnBothFaces) {
  const bool grains = std::string(GetParam()) == "dem";
  // Facets are a little rough to grains (docs/theory/contact.md): the mean is over the length of one.
  const Scene scene = strip_through_box(
      GetParam(), constant,
      {{"turf.carpet.element_length", grains ? "2.5 mm" : "4 mm"}, {"rig.travel", grains ? "5 mm" : "2 mm"}});
  PullOut rig(scene);
  EXPECT_LT(test::run_test(scene, rig, 0), 0.01);
  const PullResults r = evaluate_pull(rig.rows(0), rig.strip(0));
  ASSERT_TRUE(r.over_platens && r.over_strand);
  EXPECT_NEAR(*r.over_strand, 1, grains ? 0.05 : 0.01);
  EXPECT_NEAR(*r.over_platens, 1, grains ? 0.05 : 0.01);
}

TEST_P(StripPullOut, ResumedGivesTheSameBits) {
  const Scene scene = strip_through_box(GetParam(), constant, {{"rig.travel", "1 mm"}});
  EXPECT_GT(test::expect_resumed_bits(scene, 2, "force"), 0);
}

INSTANTIATE_TEST_SUITE_P(Approaches, StripPullOut, ::testing::Values("sph", "dem"),
                         [](const auto& test) { return std::string(test.param); });

TEST(StripPullOutOfAContinuum, FeelsAThirdOfTheStressWherePairsActPastIt) {
  const Scene scene = strip_through_box("sph", constant, {{"effects.fibre_separation", "false"}});
  PullOut rig(scene);
  EXPECT_LT(test::run_test(scene, rig, 0), 0.01);
  const PullResults r = evaluate_pull(rig.rows(0), rig.strip(0));
  ASSERT_TRUE(r.over_platens && r.over_strand);
  EXPECT_NEAR(*r.over_strand, 1, 0.01);
  EXPECT_NEAR(*r.over_platens, 0.37, 0.05);
}

TEST(StripPullOutOfAContinuum, ForceRisesWithTheFrictionOfItsSpeedAndNotWithTheSpeedItIsRunAt) {
  const Scene scene = strip_through_box(
      "sph", rising, {{"rig.speeds", "[\"1 mm/s\", \"10 mm/s\"]"}, {"rig.travel", "1.2 mm"}});
  PullOut rig(scene);
  EXPECT_NEAR(rig.strip(0).friction, 0.15 - 0.04 * std::exp(-0.3), 1e-12);
  double force[2];
  for (const std::size_t test : {0, 1}) {
    (void)test::run_test(scene, rig, test);
    const PullResults r = evaluate_pull(rig.rows(test), rig.strip(test));
    force[test] = *r.steady_force / *r.normal_stress;
  }
  const double expected = rig.strip(1).friction / rig.strip(0).friction;  // 1.233
  EXPECT_NEAR(force[1] / force[0], expected, 0.05 * expected);
}

TEST(PullOutResults, AreThoseOfTheRows) {
  // 2 mu w L sigma with L falling from 25 to 21 mm, a peak of 12 N at 0.5 mm.
  StripFriction strip{0.5, 0.002, {}};
  strip.rig.embedded_length = 0.025;
  strip.rig.travel = 0.004;
  std::vector<PullRow> rows{{0, 0, 0, 1, 5e4, 0, 0}, {1, 1, 0, 2, 1e5, 0, 0}};
  for (int i = 1; i <= 8; ++i) {
    const double x = 0.0005 * i, formula = 2 * 0.5 * 0.002 * (0.025 - x) * 1e5;
    rows.push_back({2.0 + i, 2, x, i == 1 ? 12 : 1.1 * formula, 1e5, 1.1e5, 0});
  }
  const PullResults r = evaluate_pull(rows, strip);
  EXPECT_EQ(r.peak_force, 12);
  EXPECT_EQ(r.displacement_at_peak, 0.0005);
  EXPECT_NEAR(*r.steady_force, 1.1 * 2 * 0.5 * 0.002 * 0.022 * 1e5, 1e-12);
  EXPECT_NEAR(*r.over_platens, 1.1, 1e-12);
  EXPECT_NEAR(*r.over_strand, 1.0, 1e-12);
  rows.resize(5);  // not to its end
  EXPECT_FALSE(evaluate_pull(rows, strip).steady_force);
}

TEST(PullOutScene, RefusesWhatCannotBeDrawn) {
  const auto message = [](const Overrides& more) {
    try {
      (void)strip_through_box("sph", constant, more);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(message({{"rig.embedded_length", "17 mm"}}).find("more than the box is long (16 mm)"),
            std::string::npos)
      << message({{"rig.embedded_length", "17 mm"}});
  EXPECT_NE(message({{"rig.embedded_length", "2 mm"}}).find("draws the strand out"), std::string::npos);
  EXPECT_NE(message({{"turf.carpet.strand_width", "11 mm"}}).find("narrower than the strand"),
            std::string::npos);
  EXPECT_NE(message({{"rig.speeds", "[\"1 mm/s\", \"1 mm/s\"]"}}).find("given twice"), std::string::npos);
  EXPECT_NE(message({{"rig.load_time", "0.02 ms"}}).find("20 rows of 0.1 ms"), std::string::npos)
      << message({{"rig.load_time", "0.02 ms"}});
  EXPECT_NE(message({{"rig.speed_factor", "2.0"}}).find("speed_factor"), std::string::npos);
}

}  // namespace
}  // namespace tuft::rigs

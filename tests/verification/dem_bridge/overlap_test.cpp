/// Overlaps of pairs of materials, and the limit that a scene may set.
#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

/// Three grains of rubber and one of sand in a row; neighbours overlap by 2, 4 and 10 % of 1 mm.
class Overlaps : public ::testing::Test {
 protected:
  Overlaps() {
    materials_.push_back(grain_material(50e6, 0.3, 2650, 0.5, 0.6));
    materials_[0].name = "sbr";
    materials_[1].name = "sand";
    double x = 0;
    for (const double gap : {0.0, 0.00198, 0.00196, 0.0019})
      add_grain(grains_, Vec3(x += gap, 0, 0), 0.001, 1150);
    grains_.material[3] = 1;
  }
  static void step(DemInfill& infill) {
    infill.begin_window(1e-9, 1, true);
    infill.advance(1e-9, 1, no_impulses(4));
  }
  Grains grains_;
  std::vector<Material> materials_{rubber()};
  DemSettings settings_ = settings_in_box(0.05);
};

TEST_F(Overlaps, AreToldForEachPairOfMaterials) {
  DemInfill infill(grains_, materials_, settings_);
  step(infill);
  const auto pairs = infill.overlaps_by_pair();
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_EQ(pairs[0].now.contacts, 2u);
  EXPECT_NEAR(pairs[0].now.mean, 0.03, 1e-6);
  EXPECT_NEAR(pairs[0].now.largest, 0.04, 1e-6);
  EXPECT_EQ(pairs[1].first, 0);
  EXPECT_EQ(pairs[1].second, 1);
  EXPECT_EQ(pairs[1].now.contacts, 1u);
  EXPECT_NEAR(pairs[1].now.percentile_99, 0.1, 1e-6);
  EXPECT_EQ(pairs[2].now.contacts, 0u) << "sand on sand";
  EXPECT_NEAR(pairs[1].largest_of_run, 0.1, 1e-6);
  EXPECT_NEAR(infill.overlaps().mean, 0.16 / 3, 1e-6);
}

TEST_F(Overlaps, TheLargestOfTheRunIsRememberedAfterTheyHaveParted) {
  DemInfill infill(grains_, materials_, settings_);
  step(infill);
  for (int k = 0; k < 2000; ++k) infill.advance(1e-6, 1, no_impulses(4));
  const auto pairs = infill.overlaps_by_pair();
  EXPECT_EQ(pairs[1].now.contacts, 0u) << "they have not parted: nothing is tested";
  EXPECT_NEAR(pairs[1].largest_of_run, 0.1, 1e-6);
}

TEST_F(Overlaps, BeyondTheLimitStopTheRunAndOnlyThen) {
  settings_.options.overlap_limit = 0.11;
  {
    DemInfill infill(grains_, materials_, settings_);
    step(infill);
  }
  settings_.options.overlap_limit = 0.09;
  DemInfill infill(grains_, materials_, settings_);
  try {
    step(infill);
    FAIL() << "went on";
  } catch (const RunError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("sbr and sand overlap by 0.1 "), std::string::npos) << text;
    EXPECT_NE(text.find("infill.dem.overlap_limit = 0.09"), std::string::npos) << text;
  }
}

TEST_F(Overlaps, TheStepIsToldAsAShareOfTheRayleighTime) {
  DemInfill infill(grains_, materials_, settings_);
  infill.advance(0.5 * infill.stable_step(), 1, no_impulses(4));
  EXPECT_NEAR(infill.rayleigh_share(), 0.1, 1e-12);
}

}  // namespace
}  // namespace tuft::dem::test

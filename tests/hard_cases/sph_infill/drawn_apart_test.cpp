/// Tension: a body drawn apart separates, its particles do not clump.
#include <gtest/gtest.h>

#include "sph_infill/soil_law.h"
#include "tests/verification/sph_infill/cases/drawn_block.h"

namespace tuft::sph {
namespace {

class DrawnApart : public testing::TestWithParam<test::Numerics> {};
INSTANTIATE_TEST_SUITE_P(NumericsOf, DrawnApart,
                         testing::Values(test::Numerics{test::Preset::accurate},
                                         test::Numerics{test::Preset::accurate, 0.3, 0.05},
                                         test::Numerics{test::Preset::fast, 0.3, 0.05},
                                         test::Numerics{test::Preset::paper},
                                         test::Numerics{test::Preset::paper, 0.3, 0.05}));

TEST_P(DrawnApart, ABlockBeyondItsTensionCutoffSeparatesAndDoesNotClump) {
  const test::DrawnResult r = test::drawn_block(GetParam(), {});
  RecordProperty("smallest_distance_over_pitch", testing::PrintToString(r.smallest_distance));
  RecordProperty("energy_error", testing::PrintToString(r.energy_error));
  EXPECT_GT(r.smallest_distance, 0.5);
  EXPECT_EQ(r.close, 0);
  EXPECT_GT(r.widest_gap, 3) << "it holds together";
  EXPECT_LT(r.energy_error, 0.03);
}

TEST_P(DrawnApart, GrainsWithoutCohesionPartWithoutForceOrWork) {
  test::DrawnCase grains;
  grains.material.yield_a0 = grains.material.yield_a1 = grains.material.tension_cutoff = 0;
  const test::DrawnResult r = test::drawn_block(GetParam(), grains);
  EXPECT_GT(r.smallest_distance, 0.85);
  EXPECT_GT(r.widest_gap, 3);
  EXPECT_LT(r.energy_error, 1e-6);
}

/// What the cutoff is for: the same block with unlimited strength in tension clumps. Were an artificial
/// stress ever put in its place, this is the test that it must turn around.
TEST(TensileInstability, WithoutTheCutoffSomeParticlesClump) {
  test::DrawnCase uncut;
  uncut.tension_cutoff = false;
  const test::DrawnResult r = test::drawn_block({test::Preset::accurate}, uncut);
  RecordProperty("smallest_distance_over_pitch", testing::PrintToString(r.smallest_distance));
  EXPECT_LT(r.smallest_distance, 0.5);
  EXPECT_GT(r.close, 0.005);
}

TEST(TornPoint, RemembersItsGapUntilItsDensityHasHalvedAndNoFurther) {
  const SoilLaw law = make_soil_law(test::mixture_material());
  const auto strain_at_contact = [&](double opening) {
    SoilState state = reference_state(law);
    const auto strain = [&](double e) { update_soil(law, {{-e / 3, -e / 3, -e / 3, 0, 0, 0}, {}}, state); };
    for (int k = 0; k < 1000; ++k) strain(-opening / 1000);
    double closed = 0;
    while (state.pressure <= 0 && closed < 10) strain(1e-3), closed += 1e-3;
    return closed;
  };
  EXPECT_NEAR(strain_at_contact(0.3), 0.3, 2e-3);
  EXPECT_NEAR(strain_at_contact(0.6), 0.6, 2e-3);
  EXPECT_NEAR(strain_at_contact(3), std::log(2), 2e-3);
}

}  // namespace
}  // namespace tuft::sph

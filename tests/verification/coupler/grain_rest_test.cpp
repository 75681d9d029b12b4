// Beds of grains are at rest when the rig is released, or the run says that they are not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coarse_scene.h"
#include "core/hdf5_file.h"

namespace tuft::rigs {
namespace {

/// Rubber alone, on a small patch.
Overrides bed(const Overrides& more = {}) {
  Overrides overrides{{"infill.approach", "dem"},
                      {"infill.dem.host", TUFT_TEST_HOST},
                      {"infill.dem.use_cache", "false"},
                      {"infill.dem.material_coarse_graining", "{ sbr = 3.0 }"},
                      {"infill.dem.pairs", "[]"},
                      {"turf.size", "[\"40 mm\", \"40 mm\"]"},
                      {"turf.layers", "[{ material = \"sbr\", depth = \"30 mm\" }]"},
                      {"rig.diameter", "20 mm"},
                      {"scene.duration", "0.5 ms"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

bool says(const RunSummary& summary, const std::string& words) {
  return std::ranges::any_of(summary.remarks,
                             [&](const std::string& r) { return r.find(words) != std::string::npos; });
}

class GrainRest : public ::testing::TestWithParam<const char*> {};

TEST_P(GrainRest, DoublingTheSettlingChangesTheBedLittle) {
  const Overrides fibres{{"effects.fibres", GetParam()}};
  const RunSummary once = run(request_of("rest-once", bed(fibres)));
  ASSERT_EQ(once.status, "completed") << once.error;
  EXPECT_EQ(note(once, "bed_at_rest"), 1);
  EXPECT_EQ(note(once, "packing_at_rest"), 1);
  EXPECT_LE(note(once, "bed_released_unborne_weight"), 0.1);
  EXPECT_FALSE(says(once, "not at rest"));
  const double time = note(once, "bed_settle_time");
  EXPECT_LT(time, 0.1);
  Overrides longer = bed(fibres);
  longer.emplace_back("numerics.settle_time", std::to_string(2e3 * time) + " ms");
  const RunSummary twice = run(request_of("rest-twice", longer));
  ASSERT_EQ(twice.status, "completed") << twice.error;
  const double depth = note(once, "bed_released_depth"), contacts = note(once, "bed_released_coordination");
  EXPECT_NEAR(note(twice, "bed_released_depth"), depth, 0.01 * depth);
  EXPECT_NEAR(note(twice, "bed_released_coordination"), contacts, 0.05 * contacts);
  EXPECT_GT(contacts, 2.5);
}

/// As beds of 20 000 grains and more are packed. The two part by rounding, so that no grain lies where it
/// did.
TEST_P(GrainRest, PackedOnTwoRanksIsTheSameBedAsOnOne) {
  const auto placed = [](const char* ranks) {
    const RunSummary s =
        run(request_of(std::string("rest-ranks-") + ranks, bed({{"effects.fibres", GetParam()},
                                                                {"infill.dem.ranks", ranks},
                                                                {"numerics.settle_time", "0.1 ms"},
                                                                {"numerics.settle_time_limit", "0.1 ms"},
                                                                {"scene.duration", "0.1 ms"}})));
    EXPECT_EQ(s.status, "completed") << s.error;
    return s;
  };
  const RunSummary one = placed("1"), two = placed("2");
  EXPECT_EQ(note(two, "packing_at_rest"), 1);
  EXPECT_EQ(two.particles, one.particles);
  const double depth = note(one, "bed_placed_depth"), contacts = note(one, "bed_placed_coordination");
  EXPECT_NEAR(note(two, "bed_placed_depth"), depth, 0.01 * depth);
  EXPECT_NEAR(note(two, "bed_placed_coordination"), contacts, 0.05 * contacts);
}

/// Without friction grains slip past each other and past strands until no more go in.
TEST_P(GrainRest, LaidWithoutFrictionIsDenserThanAsPoured) {
  const auto placed = [](const char* friction) {
    const RunSummary s =
        run(request_of(std::string("rest-laid-") + friction,
                       bed({{"effects.fibres", GetParam()}, {"infill.dem.packing_friction", friction}})));
    EXPECT_EQ(s.status, "completed") << s.error;
    EXPECT_EQ(note(s, "bed_at_rest"), 1) << friction;
    return s;
  };
  const RunSummary poured = placed("1"), tamped = placed("0");
  EXPECT_EQ(tamped.particles, poured.particles);
  const double mass = note(poured, "bed_released_bulk_density") * note(poured, "bed_released_depth");
  EXPECT_NEAR(note(tamped, "bed_released_bulk_density") * note(tamped, "bed_released_depth"), mass,
              1e-9 * mass);
  EXPECT_LT(note(tamped, "bed_released_depth"), 0.96 * note(poured, "bed_released_depth"));
  EXPECT_GT(note(tamped, "bed_released_coordination"), note(poured, "bed_released_coordination"));
}

TEST(GrainRest, StrandsThatCanFailAreLaidAmongAsThoseThatCannot) {
  Overrides failing = bed({{"turf.carpet.fibre.failure_strain", "0.4"}});
  const RunSummary whole = run(request_of("rest-whole", bed())), torn = run(request_of("rest-torn", failing));
  ASSERT_EQ(torn.status, "completed") << torn.error;
  EXPECT_EQ(note(torn, "bed_placed_depth"), note(whole, "bed_placed_depth"));
  EXPECT_EQ(note(torn, "bed_placed_coordination"), note(whole, "bed_placed_coordination"));
}

/// A missile that hardly touches: what moves, falls.
TEST_P(GrainRest, NothingFallsOnceDragIsTakenAway) {
  const RunSummary s = run(request_of("rest-released", bed({{"effects.fibres", GetParam()},
                                                            {"rig.speed", "0.9 m/s"},
                                                            {"rig.mass", "10 mg"},
                                                            {"scene.duration", "4 ms"},
                                                            {"output.frames", "1 ms"}})));
  ASSERT_EQ(s.status, "completed") << s.error;
  const h5::File file = h5::File::open(scratch_folder("rest-released") / "run.h5");
  const std::vector<double> velocity =
      file.root().open_group("frames").open_group("infill").read_doubles("velocity");
  const std::size_t grains = s.particles;
  double mean = 0;
  for (std::size_t i = velocity.size() - 3 * grains; i < velocity.size(); i += 3) mean += velocity[i + 2];
  mean /= static_cast<double>(grains);
  EXPECT_GT(mean, -0.15 * 9.81 * 4e-3) << "m/s; free fall for 4 ms is -0.039";
}

INSTANTIATE_TEST_SUITE_P(Fibres, GrainRest, ::testing::Values("true", "false"));

TEST(GrainRest, ABedThatIsNotAtRestIsSaidNotToBe) {
  const RunSummary s = run(request_of("rest-missed", bed({{"infill.dem.settle_time_limit", "3 ms"},
                                                          {"infill.dem.rest_tolerance", "0.001"},
                                                          {"numerics.settle_time", "1 ms"},
                                                          {"numerics.settle_time_limit", "2 ms"}})));
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_EQ(note(s, "packing_at_rest"), 0);
  EXPECT_EQ(note(s, "bed_at_rest"), 0);
  EXPECT_NEAR(note(s, "bed_settle_time"), 2e-3, 1e-9);
  EXPECT_TRUE(says(s, "not at rest after 11 ms of packing"));
  EXPECT_TRUE(says(s, "not at rest when the rig was released"));
  EXPECT_TRUE(says(s, "raise numerics.settle_time_limit"));
}

TEST(GrainRest, LargeOverlapsAreSaidAndTheirLimitCountsFromTheReleaseOn) {
  const Overrides soft{{"materials.sbr.grain.young_modulus", "1 MPa"}, {"numerics.settle_time_limit", "0 s"}};
  Overrides dropped = bed(soft);
  dropped.emplace_back("scene.duration", "5 ms");
  const RunSummary s = run(request_of("rest-overlaps", dropped));
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_GT(note(s, "grain_overlap_sbr_sbr_largest_of_run"), 0.1);
  EXPECT_TRUE(says(s, "raise grain.young_modulus, or reduce infill.dem.coarse_graining"));

  // Between what grains overlap by as packed, and as the rig was released.
  const double packed = note(s, "bed_placed_overlap_largest"),
               released = note(s, "bed_released_overlap_largest");
  ASSERT_GT(packed, 1.1 * released) << "nothing is tested";
  Overrides limited = bed(soft);
  limited.emplace_back("infill.dem.overlap_limit", std::to_string(0.5 * (packed + released)));
  RunRequest before = request_of("rest-limit-before", limited);
  before.scene.info.duration = before.scene.output.histories;
  const RunSummary settled = run(before);
  EXPECT_EQ(settled.status, "completed")
      << "overlaps while packed and settled do not count: " << settled.error;
  limited.emplace_back("scene.duration", "5 ms");
  const RunSummary stopped = run(request_of("rest-limit", limited));
  EXPECT_EQ(stopped.status, "failed");
  EXPECT_NE(stopped.error.find("infill.dem.overlap_limit"), std::string::npos) << stopped.error;
}

TEST(GrainRest, ARunStoppedWhileItSettlesGoesOnToTheSameBits) {
  const Overrides often = bed({{"output.checkpoint_every", "4 ms"}, {"numerics.settle_time", "2 ms"}});
  const RunSummary whole = run(request_of("rest-whole", often));
  ASSERT_EQ(whole.status, "completed") << whole.error;
  RunRequest request = request_of("rest-parts", often);
  request.stop_after_checkpoints = 1;
  RunSummary s = run(request);
  ASSERT_EQ(s.status, "stopped");
  ASSERT_LT(s.simulated_time, 0) << "nothing is tested";
  request.stop_after_checkpoints = 0;
  request.resume = true;
  s = run(request);
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_EQ(s.steps, whole.steps);
  for (const char* name :
       {"bed_settle_time", "bed_released_depth", "bed_released_unborne_weight", "bed_released_speed_largest",
        "bed_released_overlap_largest", "packing_time", "grain_overlap_sbr_sbr_largest_of_run"})
    EXPECT_EQ(note(s, name), note(whole, name)) << name;
}

}  // namespace
}  // namespace tuft::rigs

// Grains that are pressed again and again, and rolled; coarse enough to run as tests.
#include <gtest/gtest.h>

#include <cmath>

#include "coarse_scene.h"
#include "core/error.h"

namespace tuft::rigs {
namespace {

/// Large grains among few fibres, pressed far too fast, so that infill is thrown up: what is tested is what
/// follows from where the bed lies, not where that is. 3 ms down, 3 ms up, 1 ms of rest.
Overrides pressed(const Overrides& more = {}) {
  Overrides overrides{{"infill.approach", "dem"},
                      {"infill.dem.host", TUFT_TEST_HOST},
                      {"infill.dem.use_cache", "false"},
                      {"infill.dem.material_coarse_graining", "{ sbr = 6.0, sand = 8.0 }"},
                      {"conditioning.method", "compaction"},
                      {"conditioning.press_time", "3 ms"},
                      {"conditioning.lift_time", "3 ms"},
                      {"conditioning.settle_time", "1 ms"},
                      {"numerics.settle_time", "2 ms"},
                      {"numerics.settle_time_limit", "2 ms"},
                      {"scene.duration", "0.5 ms"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

/// After its first checkpoint.
RunSummary stopped_and_resumed(const std::string& name, const Overrides& overrides) {
  RunRequest request = request_of(name, overrides);
  request.stop_after_checkpoints = 1;
  EXPECT_EQ(run(request).status, "stopped");
  request.stop_after_checkpoints = 0;
  request.resume = true;
  RunSummary resumed = run(request);
  EXPECT_EQ(resumed.status, "completed") << resumed.error;
  return resumed;
}

TEST(GrainConditioning, NoMorePressesThanItTakesForTheBedToStay) {
  const RunSummary s = run(request_of(
      "pressed-enough", pressed({{"conditioning.presses", "4"}, {"conditioning.tolerance", "50 mm"}})));
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_EQ(note(s, "conditioning_presses"), 1);
  EXPECT_EQ(note(s, "conditioning_stays"), 1);
  const RunSummary once = run(request_of("pressed-once", pressed({{"conditioning.presses", "1"}})));
  EXPECT_NEAR(static_cast<double>(s.steps), static_cast<double>(once.steps),
              0.02 * static_cast<double>(once.steps))
      << "times of presses that are not needed are left out";
}

TEST(GrainConditioning, SaysByHowMuchTheBedStayedTooHighAndHowItLiesResumedOrNot) {
  const Overrides in_vain = pressed({{"conditioning.presses", "2"},
                                     {"conditioning.tolerance", "0.01 mm"},
                                     {"output.checkpoint_every", "9 ms"}});
  const RunSummary s = run(request_of("pressed-in-vain", in_vain));
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_EQ(note(s, "conditioning_presses"), 2);
  EXPECT_EQ(note(s, "conditioning_stays"), 0);
  const double asked = note(s, "conditioning_depth_placed") - 0.006;
  EXPECT_NEAR(note(s, "conditioning_missing_compaction"), note(s, "conditioning_depth_at_switch") - asked,
              1e-9);
  EXPECT_LT(note(s, "conditioning_depth_under_plate"), asked - 0.002) << "the second time it goes deeper";
  EXPECT_LT(s.energy_error, 0.02);
  const double solid = note(s, "bed_placed_bulk_density") / (1 - note(s, "bed_placed_porosity"));
  EXPECT_NEAR(note(s, "bed_released_bulk_density") / (1 - note(s, "bed_released_porosity")), solid,
              1e-9 * solid);
  EXPECT_GT(note(s, "bed_placed_coordination"), 1);

  // Stopped within the second press, resumed: the same plate, the same bed.
  const RunSummary resumed = stopped_and_resumed("pressed-stopped", in_vain);
  for (const char* name : {"conditioning_presses", "conditioning_plate_pressure_largest",
                           "conditioning_depth_released", "bed_placed_porosity", "bed_released_porosity"})
    EXPECT_EQ(note(resumed, name), note(s, name)) << name;
}

TEST(GrainConditioning, RollerPassesToAndFroPressesAndKeepsTheLedger) {
  const Overrides rolled =
      pressed({{"conditioning.method", "roller"},
               {"conditioning.depth", "4 mm"},
               {"conditioning.settle_time", "1 ms"},
               {"output.checkpoint_every", "9 ms"},
               {"conditioning.roller",
                "{ diameter = \"40 mm\", studs_around = 5, stud_spacing = \"20 mm\", stud_length = "
                "\"8 mm\", stud_diameter = \"8 mm\", speed = \"15 m/s\", passes = 2 }"}});
  const RunSummary s = run(request_of("rolled", rolled));
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_EQ(note(s, "conditioning_passes"), 2);
  EXPECT_GT(note(s, "conditioning_roller_force_largest"), 10);
  EXPECT_LT(s.energy_error, 0.02);
  EXPECT_LT(s.momentum_error, 1e-9);

  const RunSummary resumed = stopped_and_resumed("rolled-stopped", rolled);
  for (const char* name :
       {"conditioning_passes", "conditioning_roller_force_largest", "bed_released_porosity"})
    EXPECT_EQ(note(resumed, name), note(s, name)) << name;
}

TEST(GrainConditioning, RollerWithPressesIsRefused) {
  try {
    (void)coarse_scene(
        {{"infill.approach", "dem"}, {"conditioning.method", "roller"}, {"conditioning.presses", "3"}});
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("conditioning.presses"), std::string::npos) << error.what();
  }
}

TEST(GrainConditioning, RollerOnAContinuumIsRefused) {
  try {
    (void)coarse_scene({{"conditioning.method", "roller"}});
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("\"roller\" is for grains"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace tuft::rigs

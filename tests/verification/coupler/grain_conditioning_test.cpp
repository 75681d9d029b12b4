// Grains that are pressed again and again, and rolled; coarse enough to run as tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "coarse_scene.h"
#include "core/error.h"
#include "core/hdf5_file.h"

namespace tuft::rigs {
namespace {

/// Half a thousand grains of rubber among few fibres; 3 ms down, 3 ms up, 2 ms of rest.
Overrides pressed(const Overrides& more = {}) {
  Overrides overrides{{"infill.approach", "dem"},
                      {"infill.dem.host", TUFT_TEST_HOST},
                      {"infill.dem.use_cache", "false"},
                      {"infill.dem.material_coarse_graining", "{ sbr = 6.0, sand = 8.0 }"},
                      {"conditioning.method", "compaction"},
                      {"conditioning.press_time", "4 ms"},
                      {"conditioning.lift_time", "4 ms"},
                      {"conditioning.settle_time", "2 ms"},
                      {"numerics.settle_time", "2 ms"},
                      {"scene.duration", "0.5 ms"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

RunRequest request_of(const std::string& name, const Overrides& overrides) {
  RunRequest request;
  request.scene = coarse_scene(overrides);
  request.folder = fresh_folder(name);
  return request;
}

double note(const RunSummary& summary, const std::string& name) {
  return summary.notes.at(name).value;
}

TEST(GrainConditioning, PressesUntilTheBedStaysAndReportsHowItLies) {
  // Grains spring back: after one press of so little the bed is higher than asked.
  const RunSummary once = run(request_of("pressed-once", pressed({{"conditioning.depth", "1 mm"}})));
  ASSERT_EQ(once.status, "completed") << once.error;
  const double reached = note(once, "conditioning_depth_lifted"), surface = 0.050;
  const double wanted = std::min(surface - 0.0002, reached - 0.001);
  const Overrides again = pressed({{"conditioning.depth", fmt::format("{:.6g} mm", 1e3 * (surface - wanted))},
                                   {"conditioning.presses", "8"},
                                   {"conditioning.tolerance", "0.4 mm"},
                                   {"output.checkpoint_every", "9 ms"}});
  const RunRequest request = request_of("pressed-again", again);
  const RunSummary s = run(request);
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_EQ(note(s, "conditioning_stays"), 1);
  EXPECT_GE(note(s, "conditioning_presses"), 2);
  EXPECT_LT(note(s, "conditioning_presses"), 8);
  EXPECT_LT(note(s, "conditioning_depth_at_switch"), wanted + 0.0004 + 1e-9);
  EXPECT_LT(s.energy_error, 0.02);
  // What is pressed is denser, by mass, by volume and by contacts.
  EXPECT_GT(note(s, "bed_released_bulk_density"), note(s, "bed_placed_bulk_density"));
  EXPECT_LT(note(s, "bed_released_porosity"), note(s, "bed_placed_porosity"));
  const double solid = note(s, "bed_placed_bulk_density") / (1 - note(s, "bed_placed_porosity"));
  EXPECT_NEAR(note(s, "bed_released_bulk_density") / (1 - note(s, "bed_released_porosity")), solid,
              1e-9 * solid);
  EXPECT_GT(note(s, "bed_placed_coordination"), 2);
  EXPECT_LT(note(s, "bed_released_coordination"), 12);

  // Stopped between two presses, resumed: the same plate, the same bits.
  RunRequest stopped = request_of("pressed-stopped", again);
  stopped.stop_after_checkpoints = 2;
  ASSERT_EQ(run(stopped).status, "stopped");
  stopped.stop_after_checkpoints = 0;
  stopped.resume = true;
  const RunSummary resumed = run(stopped);
  ASSERT_EQ(resumed.status, "completed") << resumed.error;
  for (const char* name : {"conditioning_presses", "conditioning_plate_pressure_largest",
                           "conditioning_depth_released", "bed_placed_porosity", "bed_released_porosity"})
    EXPECT_EQ(note(resumed, name), note(s, name)) << name;
}

TEST(GrainConditioning, SaysByHowMuchTheBedStayedTooHighWhenPressesDoNotSuffice) {
  const RunSummary s = run(request_of("pressed-in-vain", pressed({{"conditioning.depth", "12 mm"},
                                                                  {"conditioning.presses", "2"},
                                                                  {"conditioning.tolerance", "0.01 mm"}})));
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_EQ(note(s, "conditioning_presses"), 2);
  EXPECT_EQ(note(s, "conditioning_stays"), 0);
  EXPECT_NEAR(note(s, "conditioning_missing_compaction"), note(s, "conditioning_depth_at_switch") - 0.038,
              1e-9);
}

TEST(GrainConditioning, RollerPassesToAndFroPressesAndKeepsTheLedger) {
  const RunSummary s = run(request_of(
      "rolled", pressed({{"conditioning.method", "roller"},
                         {"conditioning.depth", "4 mm"},
                         {"conditioning.settle_time", "1 ms"},
                         {"conditioning.roller",
                          "{ diameter = \"40 mm\", studs_around = 5, stud_spacing = \"20 mm\", stud_length = "
                          "\"8 mm\", stud_diameter = \"8 mm\", speed = \"10 m/s\", passes = 2 }"}})));
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_EQ(note(s, "conditioning_passes"), 2);
  EXPECT_GT(note(s, "conditioning_roller_force_largest"), 10);
  EXPECT_LT(s.energy_error, 0.02);
  EXPECT_LT(s.momentum_error, 1e-9);
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

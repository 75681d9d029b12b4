/// What a run on grains says of grains that leave, and of its step.
#include <nlohmann/json.hpp>

#include "cli/commands/command.h"

namespace tuft::test {
namespace {

nlohmann::json notes_of(const std::string& folder) {
  return nlohmann::json::parse(read_text(folder + "/summary.json"))["notes"];
}

/// The fast missile throws grains of a loose, shallow bed without fibres over the tray's rim.
TEST(GrainReports, TellHowManyGrainsHaveLeftAndWhatTheyTookAlong) {
  const Workplace place;
  const Outcome outcome = run_tuft(
      grain_run(place.path("run"), {"--set", "effects.fibres=false", "--set", "rig.speed=12 m/s", "--set",
                                    "scene.duration=40 ms", "--set", "output.histories=0.2 ms"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json notes = notes_of(place.path("run"));
  ASSERT_TRUE(notes.contains("expelled_particles")) << "nothing is tested";
  const double grains = notes["expelled_particles"]["value"], mass = notes["expelled_mass"]["value"],
               energy = notes["expelled_kinetic_energy"]["value"];
  EXPECT_GE(grains, 1);
  EXPECT_GT(mass, 0);
  EXPECT_EQ(notes["expelled_mass"]["unit"], "kg");
  EXPECT_TRUE(notes.contains("expelled_momentum_z"));
  double squared = 0;
  for (const char* axis : {"x", "y", "z"}) {
    const double momentum = notes[std::string("expelled_momentum_") + axis]["value"];
    squared += momentum * momentum;
  }
  EXPECT_GE(energy, 0.5 * squared / mass * (1 - 1e-9)) << "that of the mean velocity at least";
}

/// A window far beyond what grains bear is made in substeps: their step stays below a fifth of the Rayleigh
/// time.
TEST(GrainReports, TellTheStepOverTheRayleighTimeWhichLongWindowsDoNotRaise) {
  const Workplace place;
  for (const char* window : {"0 s", "40 us"}) {
    const std::string folder = place.path(window[0] == '0' ? "short" : "long");
    const Outcome outcome = run_tuft(grain_run(
        folder, {"--set", "scene.duration=0.2 ms", "--set", std::string("numerics.coupling_window=") + window,
                 "--set", "numerics.energy_error_limit=1"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const double share = notes_of(folder)["grain_step_of_rayleigh_time"]["value"];
    EXPECT_GT(share, 0.01) << window;
    EXPECT_LE(share, 0.2) << window;
  }
}

}  // namespace
}  // namespace tuft::test

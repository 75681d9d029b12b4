// What a run says of mass scaling, beforehand and in its summary.
#include <gtest/gtest.h>

#include <algorithm>

#include "coupler/build_simulation.h"
#include "rigs/run.h"
#include "rigs/run_folder.h"
#include "tests/verification/coupler/coarse_scene.h"

namespace tuft::rigs {
namespace {

/// A drop of a millisecond, settling included.
Scene short_drop(const std::string& limit) {
  return coarse_scene({{"numerics.mass_scaling_limit", limit},
                       {"numerics.settle_time", "0.5 ms"},
                       {"scene.duration", "0.5 ms"},
                       {"numerics.threads", "1"},
                       {"output.frames", "0.5 ms"}});
}

RunSummary summary_of(const Scene& scene) {
  const std::filesystem::path folder = fresh_folder("mass_scaling_summary");
  prepare_run_folder(folder / "run", scene);
  RunRequest request;
  request.scene = scene;
  request.folder = folder / "run";
  (void)run(request);
  RunSummary summary = read_summary(folder / "run");  // what is on disk
  std::filesystem::remove_all(folder);
  return summary;
}

bool speaks_of_mass(const std::vector<std::string>& remarks) {
  return std::any_of(remarks.begin(), remarks.end(),
                     [](const std::string& r) { return r.find("mass scaling adds") != std::string::npos; });
}

TEST(MassScaling, IsInTheSummaryWithWhatItAddedAndTheStepsBeforeAndAfter) {
  const Scene scene = short_drop("0.1");
  const fe::Carpet carpet(coupler::build_carpet_mesh(scene, true),
                          {scene.turf.carpet.backing, scene.turf.carpet.fibre},
                          coupler::carpet_options(scene));
  const fe::MassScaling& expected = carpet.mass_scaling();
  const RunSummary summary = summary_of(scene);
  ASSERT_EQ(summary.status, "completed") << summary.error;
  const auto note = [&](const char* name) { return summary.notes.at(name); };
  EXPECT_EQ(note("mass_scaling_added").unit, "kg");
  EXPECT_DOUBLE_EQ(note("mass_scaling_added").value, expected.added_mass);
  EXPECT_DOUBLE_EQ(note("mass_scaling_share").value, expected.share());
  EXPECT_NEAR(note("mass_scaling_share").value, 0.1, 1e-9);
  EXPECT_DOUBLE_EQ(note("mass_scaling_step_before").value, expected.step_before);
  EXPECT_DOUBLE_EQ(note("mass_scaling_step_after").value, expected.step_after);
  EXPECT_GT(expected.step_after, 1.04 * expected.step_before);
}

TEST(MassScaling, IsInTheSummaryOnlyWhenItIsAskedFor) {
  const RunSummary summary = summary_of(short_drop("0"));
  ASSERT_EQ(summary.status, "completed") << summary.error;
  for (const auto& [name, quantity] : summary.notes)
    EXPECT_EQ(name.find("mass_scaling"), std::string::npos) << name;
}

TEST(MassScaling, IsAnnouncedByThePlanOfARunThatAsksForIt) {
  EXPECT_TRUE(speaks_of_mass(plan(short_drop("0.1")).remarks));
  EXPECT_FALSE(speaks_of_mass(plan(short_drop("0")).remarks));
}

}  // namespace
}  // namespace tuft::rigs

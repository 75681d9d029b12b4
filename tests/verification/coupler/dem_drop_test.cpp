// Whole drops on DEM infill, coarse enough to run as tests.
#include <gtest/gtest.h>

#include "coarse_scene.h"
#include "core/hdf5_file.h"

namespace tuft::rigs {
namespace {

Overrides dem(const Overrides& more) {
  Overrides overrides{{"infill.approach", "dem"},
                      {"infill.dem.host", TUFT_TEST_HOST},
                      {"infill.dem.use_cache", "false"},
                      {"infill.dem.material_coarse_graining", "{ sbr = 5.0, sand = 7.0 }"},
                      {"scene.duration", "16 ms"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

TEST(DemDrop, IsAPulseWithEnergyAndMomentumInBalance) {
  RunRequest request;
  request.scene = coarse_scene(dem({{"scene.duration", "14 ms"}}));
  request.folder = fresh_folder("dem-pulse");
  const RunSummary s = run(request);
  ASSERT_EQ(s.status, "completed") << s.error;
  EXPECT_LT(s.energy_error, 0.02);
  EXPECT_LT(s.momentum_error, 1e-9);
  EXPECT_GT(s.results.at("peak_g").value, 10);
  EXPECT_LT(s.results.at("rebound_velocity").value, s.results.at("impact_velocity").value);
}

TEST(DemDrop, ResumedFromItsCheckpointGivesTheSameBits) {
  const Overrides often = dem({{"scene.duration", "4 ms"},
                               {"numerics.settle_time", "2 ms"},
                               {"numerics.settle_time_limit", "2 ms"},
                               {"output.checkpoint_every", "3 ms"}});
  RunRequest through;
  through.scene = coarse_scene(often);
  through.folder = fresh_folder("dem-through");
  ASSERT_EQ(run(through).status, "completed");
  RunRequest request;
  request.scene = coarse_scene(often);
  request.folder = fresh_folder("dem-resumed");
  request.stop_after_checkpoints = 1;
  ASSERT_EQ(run(request).status, "stopped");
  request.stop_after_checkpoints = 0;
  request.resume = true;
  const RunSummary resumed = run(request);
  ASSERT_EQ(resumed.status, "completed") << resumed.error;
  const auto column = [](const RunRequest& r, const char* name) {
    return h5::File::open(r.folder / "run.h5").root().open_group("history").read_doubles(name);
  };
  for (const char* name : {"velocity", "acceleration"})
    EXPECT_EQ(column(request, name), column(through, name)) << name;
}

}  // namespace
}  // namespace tuft::rigs

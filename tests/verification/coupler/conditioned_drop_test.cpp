// Whole runs with conditioning, coarse and short enough to run as tests.
#include <gtest/gtest.h>

#include <cmath>

#include "coarse_scene.h"
#include "core/hdf5_file.h"
#include "coupler/build_simulation.h"
#include "coupler/conditioned_infill.h"
#include "rigs/compaction.h"

namespace tuft::rigs {
namespace {

/// 9 ms of conditioning: down by 3 ms, up by 6 ms, gone; the switch; 2 ms of settling; 1 ms of the drop.
Overrides conditioned(const Overrides& more = {}) {
  Overrides overrides{{"conditioning.method", "compaction"},
                      {"conditioning.press_time", "3 ms"},
                      {"conditioning.lift_time", "3 ms"},
                      {"conditioning.settle_time", "3 ms"},
                      {"numerics.settle_time", "2 ms"},
                      {"scene.duration", "1 ms"},
                      {"output.frames", "1 ms"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return overrides;
}

RunSummary run_scene(const std::string& name, const Overrides& overrides, int stop_after = 0,
                     bool resume = false) {
  RunRequest request;
  request.scene = coarse_scene(overrides);
  request.folder = resume ? scratch_folder(name) : fresh_folder(name);
  request.stop_after_checkpoints = stop_after;
  request.resume = resume;
  RunSummary summary = run(request);
  EXPECT_EQ(summary.error, "");
  return summary;
}

std::vector<double> column(const std::string& name, const char* group, const char* what) {
  return h5::File::open(scratch_folder(name) / "run.h5").root().open_group(group).read_doubles(what);
}

TEST(Conditioning, PressesTheBedByTheDepthAskedForAndKeepsTheLedgerAcrossTheSwitch) {
  // As fast as below, infill and fibres would be thrown back up.
  Overrides slower = conditioned();
  slower.insert(slower.end(), {{"conditioning.press_time", "60 ms"},
                               {"conditioning.lift_time", "30 ms"},
                               {"conditioning.settle_time", "15 ms"}});
  const RunSummary s = run_scene("pressed", slower);
  ASSERT_EQ(s.status, "completed");
  EXPECT_LT(s.energy_error, 0.01);
  EXPECT_LT(s.momentum_error, 1e-9);
  const auto note = [&](const char* name) { return s.notes.at(std::string("conditioning_") + name).value; };
  EXPECT_NEAR(note("depth_under_plate"), 0.044, 3e-4);
  EXPECT_GT(note("depth_lifted"), 0.0435);
  EXPECT_LT(note("depth_lifted"), note("depth_placed") - 0.003);
  EXPECT_LT(note("sphere_overlap_largest"), 0.05);
  // The surface is where tops of spheres stand, not where their volumes would end: 0.952 of it with a
  // standard deviation of 0.007, over ten placings of this bed.
  EXPECT_NEAR(note("depth_of_volumes") / note("depth_at_switch"), 0.952, 0.03);
  EXPECT_GE(note("energy_let_go"), 0);
  EXPECT_GT(s.cost.at("conditioning"), 0);
  // What the switch let go stands in the ledger from then on, and nothing of it before.
  const auto time = column("pressed", "energy", "time"), let_go = column("pressed", "energy", "conditioning");
  for (std::size_t i = 0; i < time.size(); ++i)
    EXPECT_EQ(let_go[i], time[i] < -0.002 + 1e-9 ? 0 : note("energy_let_go")) << time[i];
  // The continuum is not thrown by what it takes over.
  EXPECT_LT(note("speed_at_release"), 0.2);
}

TEST(Conditioning, ResumedInEachStageGivesTheSameBitsAsNeverStopped) {
  // Checkpoints at -8, -5, -3.5 (plate gone), at the switch (-2) and at -0.5 ms fall on multiples of 1.5 ms
  // from -11.
  const Overrides often = conditioned({{"output.checkpoint_every", "1.5 ms"}});
  run_scene("through", often);
  for (const int checkpoints : {1, 3, 5, 6, 7}) {
    const std::string name = "stopped-" + std::to_string(checkpoints);
    ASSERT_EQ(run_scene(name, often, checkpoints).status, "stopped");
    const RunSummary resumed = run_scene(name, often, 0, true);
    ASSERT_EQ(resumed.status, "completed");
    for (const char* what : {"error", "stored_infill", "kinetic_infill", "kinetic_carpet", "conditioning"})
      EXPECT_EQ(column("through", "energy", what), column(name, "energy", what))
          << what << ", " << checkpoints;
    EXPECT_EQ(column("through", "history", "velocity"), column(name, "history", "velocity"));
  }
}

TEST(Conditioning, GivesTheSameBitsWithOneAndTwoThreads) {
  run_scene("one", conditioned({{"numerics.threads", "1"}}));
  run_scene("two", conditioned({{"numerics.threads", "2"}}));
  for (const char* what : {"error", "stored_infill", "kinetic_infill", "contact_friction"})
    EXPECT_EQ(column("one", "energy", what), column("two", "energy", what)) << what;
}

TEST(Conditioning, FramesGoOnFromSpheresToTheContinuumWithAsManyParticles) {
  run_scene("frames", conditioned({{"conditioning.frames", "2 ms"}}));
  const h5::File file = h5::File::open(scratch_folder("frames") / "run.h5");
  const h5::Group frames = file.root().open_group("frames");
  const std::size_t rows = frames.read_doubles("time").size();
  const h5::Group infill = frames.open_group("infill");
  for (const char* field : {"position", "velocity", "pressure", "density", "plastic_compression"})
    EXPECT_EQ(infill.shape(field).at(0), rows) << field;
  EXPECT_LT(frames.read_doubles("time").front(), -0.0109);
}

TEST(Conditioning, TheLedgerCarriesAKnownKineticEnergyAcrossTheSwitch) {
  const Scene scene = coarse_scene(conditioned({{"effects.fibres", "false"}}));
  const std::vector<EffectDecision> effects = decide_effects(scene);
  coupler::BuildRequest request;
  request.scene = &scene;
  request.effects = effects;
  request.before_conditioning = true;
  request.start_time = -1;
  coupler::BuiltSimulation built = coupler::build_simulation(request);
  coupler::Simulation& simulation = *built.simulation;
  const Vec3 velocity(0, 0, 0.4);  // upwards, off the floor and into nothing
  double thrown = 0;
  const ParticleView p = built.spheres->particles();
  for (std::size_t i = 0; i < p.size(); ++i) {
    built.spheres->set_velocity(i, velocity);
    thrown += 0.5 * p.mass[i] * velocity.squaredNorm();
  }
  simulation.advance_interval(2e-5);
  EXPECT_NEAR(simulation.ledger().last().kinetic_infill, thrown, 2e-3 * thrown);
  coupler::SwitchReport report;
  auto continuum = coupler::take_over(scene, effects, *built.spheres, report);
  auto springs = coupler::body_springs(scene, effects, continuum->particles(), false);
  simulation.replace_infill(std::move(continuum), std::move(springs));
  EXPECT_NEAR(report.kinetic, thrown, 5e-3 * thrown);
  for (int k = 0; k < 10; ++k) simulation.advance_interval(2e-5);
  EXPECT_LT(std::abs(simulation.ledger().imbalance()), 2e-3 * thrown);
  EXPECT_LT(std::abs(simulation.residuals().infill), 2e-3 * thrown);
  EXPECT_EQ(simulation.ledger().last().conditioning, report.let_go);
  EXPECT_NEAR(simulation.ledger().last().kinetic_infill, thrown, 0.05 * thrown);
}

TEST(Conditioning, ThePlateMovesWithoutAJumpAndArrives) {
  const std::uint64_t n = 100;
  EXPECT_EQ(plate_height(2, 1, 0, n), 2);
  EXPECT_EQ(plate_height(2, 1, n, n), 1);
  double before = 0;
  for (std::uint64_t k = 0; k <= n; ++k) {
    const double step = plate_height(2, 1, k + 1, n) - plate_height(2, 1, k, n);
    EXPECT_LE(std::abs(step - before), 5.1e-4) << k;  // pi^2/2 (1/n)^2
    before = step;
  }
}

}  // namespace
}  // namespace tuft::rigs

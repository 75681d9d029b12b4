#include "fe_carpet/relaxation.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

/// End shear on a cantilever strip of length 0.1 m; full load 1e-4 N.
struct Case {
  Strip strip = make_strip({0.1, 0.01, 0.0005, 20, 2}, true);
  ShellMaterial material{2e9, 0, 1000};
  double stiffness = 2e9 * 0.01 * 0.0005 * 0.0005 * 0.0005 / 12;  // N m^2
  LoadAtShare load = [this](const NodeView& /*nodes*/, double share, Vec3Array& force,
                            Vec3Array& /*moment*/) {
    for (Index j = 0; j <= 2; ++j)
      force.set(static_cast<std::size_t>(strip.node(20, j)),
                Vec3(0, 0, share * 1e-4 * (j == 1 ? 0.5 : 0.25)));
  };
};

TEST(Relaxation, FindsTheTipDeflectionOfACantilever) {
  Case c;
  Carpet carpet(c.strip.mesh, {c.material}, no_gravity());
  const RelaxationResult result = relax(carpet, c.load, {});
  EXPECT_TRUE(result.at_rest);
  EXPECT_LT(result.kinetic_share, RelaxationOptions{}.tolerance);
  const double expected = 1e-4 * std::pow(0.1, 3) / (3 * c.stiffness);
  EXPECT_NEAR(position(carpet, c.strip.node(20, 1)).z() / expected, 1, 0.005);
  // Half of the load's work is stored, the rest was stopped.
  const CarpetEnergy energy = carpet.energy();
  EXPECT_NEAR((energy.strain + energy.hourglass) / (0.5 * 1e-4 * expected), 1, 0.01);
  EXPECT_NEAR(energy.damping / (energy.external_work - energy.strain - energy.hourglass), 1, 0.02);
}

TEST(Relaxation, GivesTheSameRestInOneGoAndOnARamp) {
  Case c;
  Carpet sudden(c.strip.mesh, {c.material}, no_gravity()), ramped(c.strip.mesh, {c.material}, no_gravity());
  RelaxationOptions options;
  options.tolerance = 1e-11;
  relax(sudden, c.load, options);
  options.ramp_time = 0.2;
  relax(ramped, c.load, options);
  const Index tip = c.strip.node(20, 1);
  EXPECT_NEAR(position(sudden, tip).z() / position(ramped, tip).z(), 1, 1e-4);
}

TEST(Relaxation, SaysWhenTheStepsWereNotEnough) {
  Case c;
  Carpet carpet(c.strip.mesh, {c.material}, no_gravity());
  RelaxationOptions options;
  options.most_steps = 100;
  const RelaxationResult result = relax(carpet, c.load, options);
  EXPECT_FALSE(result.at_rest);
  EXPECT_EQ(result.steps, 100);
}

/// Strips swinging under gravity and loads, one with damping of its own.
class StoppedStrip : public testing::TestWithParam<double> {};

TEST_P(StoppedStrip, KeepsItsLedgerClosedAcrossTheStopAndTheStepAfter) {
  const Strip strip = make_strip({0.03, 0.004, 0.0002, 12, 2}, true);
  ShellMaterial relaxing = polyethylene();
  relaxing.relaxation = {{0.1e9, 100}};
  for (const ShellMaterial& material : {polyethylene(), relaxing}) {
    CarpetOptions options;
    options.damping = GetParam();
    Carpet carpet(strip.mesh, {material}, options);
    Vec3Array load = no_load(strip.node_count()), moment = load;
    load.set(static_cast<std::size_t>(strip.node(12, 0)), Vec3(2e-3, 1e-3, 3e-3));
    moment.set(static_cast<std::size_t>(strip.node(12, 1)), Vec3(0, 2e-6, 1e-6));
    const double dt = 0.8 * carpet.stable_step();
    for (const int steps : {1, 2, 300, 1000}) {
      for (int i = 0; i < steps; ++i) carpet.step(dt, load, moment);
      const CarpetEnergy moving = carpet.energy();
      const double scale = moving.kinetic + moving.strain + moving.hourglass;
      carpet.stop();
      const CarpetEnergy stopped = carpet.energy();
      EXPECT_EQ(stopped.kinetic, 0);
      EXPECT_EQ(carpet.kinetic_energy(), 0);
      EXPECT_LT(std::abs(total(stopped) - total(moving)), 1e-9 * scale) << steps;
      // What was taken is the energy of motion and nothing else that was missing.
      if (steps > 2) {
        EXPECT_NEAR(stopped.damping - moving.damping, moving.kinetic, 0.02 * scale) << steps;
      }
      carpet.stop();
      EXPECT_LT(std::abs(total(carpet.energy()) - total(stopped)), 1e-9 * scale) << "stopped twice";
      carpet.step(dt, load, moment);
      const CarpetEnergy again = carpet.energy();
      EXPECT_LT(std::abs(total(again) - total(stopped)), 1e-9 * scale) << steps << ", the step after";
      EXPECT_NEAR(again.strain, stopped.strain, 1e-12 * scale);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Damping, StoppedStrip, testing::Values(0.0, 200.0));

TEST(Relaxation, WithManyStopsEndsWithALedgerThatBalances) {
  Case c;
  CarpetOptions options;
  Carpet carpet(c.strip.mesh, {c.material}, options);
  const double start = total(carpet.energy());
  EXPECT_GT(relax(carpet, c.load, {}).swings, 10);
  const CarpetEnergy e = carpet.energy();
  EXPECT_NEAR((total(e) - start) / e.strain, 0, 1e-4);
  // Work of the loads and of gravity is half stored, half stopped.
  EXPECT_NEAR(e.damping / (e.strain + e.hourglass), 1, 1e-2);
}

TEST(Constraints, OfASymmetryPlaneGiveHalfOfTheWhole) {
  // A strip pulled at both ends, and its half with x and the turns about y and z held in the middle.
  const Strip whole = make_strip({0.02, 0.004, 0.0002, 8, 2}, false);
  Strip half = make_strip({0.01, 0.004, 0.0002, 4, 2}, false);
  half.mesh.constraints.assign(half.node_count(), 0);
  for (Index j = 0; j <= 2; ++j)
    half.mesh.constraints[static_cast<std::size_t>(half.node(0, j))] = 1 | 16 | 32;
  Carpet two(whole.mesh, {polyethylene()}, no_gravity()), one(half.mesh, {polyethylene()}, no_gravity());
  const auto pull = [](const Strip& strip, Index i, double force, Vec3Array& load) {
    for (Index j = 0; j <= 2; ++j)
      load.set(static_cast<std::size_t>(strip.node(i, j)), Vec3(force, 0, 0.3 * std::abs(force)));
  };
  Vec3Array load_two = no_load(whole.node_count()), load_one = no_load(half.node_count());
  pull(whole, 0, -0.01, load_two);
  pull(whole, 8, 0.01, load_two);
  pull(half, 4, 0.01, load_one);
  const double dt = 0.5 * one.stable_step();
  for (int i = 0; i < 2000; ++i) {
    two.step(dt, load_two);
    one.step(dt, load_one);
  }
  for (Index i = 0; i <= 4; ++i)
    for (Index j = 0; j <= 2; ++j) {
      const Vec3 of_whole = position(two, whole.node(4 + i, j)) - Vec3(0.01, 0, 0);
      EXPECT_LT((position(one, half.node(i, j)) - of_whole).norm(), 1e-10) << i << ", " << j;
    }
}

TEST(Moments, OnATipBendAStripIntoACircularArc) {
  Case c;
  Carpet carpet(c.strip.mesh, {c.material}, no_gravity());
  const double moment = c.stiffness * (std::numbers::pi / 2) / 0.1;
  RelaxationOptions options;
  options.ramp_time = 1;
  options.tolerance = 1e-10;
  const auto bend = [&](const NodeView& /*nodes*/, double share, Vec3Array& /*force*/, Vec3Array& moments) {
    for (Index j = 0; j <= 2; ++j)
      moments.set(static_cast<std::size_t>(c.strip.node(20, j)),
                  Vec3(0, -share * moment * (j == 1 ? 0.5 : 0.25), 0));
  };
  EXPECT_TRUE(relax(carpet, bend, options).at_rest);
  const double radius = 0.1 / (std::numbers::pi / 2);
  EXPECT_NEAR(position(carpet, c.strip.node(20, 1)).x(), radius, 0.002 * radius);
  EXPECT_NEAR(position(carpet, c.strip.node(20, 1)).z(), radius, 0.002 * radius);
}

}  // namespace
}  // namespace tuft::fe::test

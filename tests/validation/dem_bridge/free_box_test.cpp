/// The isolated system of tests/verification/coupler/free_box.h for long.
#include <gtest/gtest.h>

#include "tests/verification/coupler/free_box.h"

namespace tuft::coupler {
namespace {

FreeBox keep_for_long(double friction, double restitution) {
  GrainCase setup = grains_in_a_box(friction, restitution);
  setup.window = 2.5e-6;
  const FreeBox box = run_free_box(setup, 100000);
  std::printf("momentum %.3g, of a window %.3g, energy %.3g\n", box.momentum_change, box.largest_imbalance,
              box.energy_error);
  EXPECT_LT(box.momentum_change, 1e-12);
  EXPECT_LT(box.largest_imbalance, 1e-12);
  EXPECT_LT(box.energy_error, 0.01);
  return box;
}

TEST(GrainsInAFreeBoxOfShells, KeepMomentumAndEnergyOverAHundredThousandSteps) {
  EXPECT_GT(keep_for_long(0, 1).energy.kinetic_carpet, 0) << "the box was hit";
}

/// With friction of grains and shells and damped contacts: what they take is in the balance, and momentum
/// stays.
TEST(GrainsInAFreeBoxOfShells, BalanceWhatFrictionAndDampingTakeOverAHundredThousandSteps) {
  EXPECT_GT(keep_for_long(0.5, 0.8).energy.dissipated_infill, 0);
}

}  // namespace
}  // namespace tuft::coupler

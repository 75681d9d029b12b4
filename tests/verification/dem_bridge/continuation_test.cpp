/// A run that goes on from a checkpoint is the run that was never interrupted.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <string>

#include "core/error.h"
#include "tests/verification/dem_bridge/same_run.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;

class Continuation : public ::testing::Test {
 protected:
  Continuation() { settings_.rolling_resistance = true; }
  ~Continuation() override { fs::remove(file_); }

  void advance(DemInfill& infill, int windows) const {
    const double window = 2 * 0.5 * infill.stable_step();
    for (int k = 0; k < windows; ++k) infill.advance(window, 2, block_.confine(infill, window));
  }
  void save(DemInfill& infill) const { save_run(infill, file_); }

  ShakenBlock block_{6};
  DemSettings settings_ = settings_in_box(0.05, Vec3(0, 0, -9.81));
  fs::path file_ = fs::temp_directory_path() / ("tuft-continuation-" + std::to_string(::getpid()) + ".h5");
};

TEST_F(Continuation, IsBitwiseTheRunThatSavedAndWentOn) {
  DemInfill whole(block_.grains, block_.materials, settings_);
  block_.shake(whole, 0.5);
  whole.set_damping(50);
  advance(whole, 150);
  save(whole);
  DemInfill resumed(block_.grains, block_.materials, settings_);
  resumed.load(h5::File::open(file_).root());
  expect_same_bits(whole, resumed);
  advance(whole, 150);
  advance(resumed, 150);
  ASSERT_GT(whole.overlaps().contacts, 20u);
  expect_same_bits(whole, resumed);
}

TEST_F(Continuation, FromBeforeTheFirstWindowKeepsVelocities) {
  DemInfill whole(block_.grains, block_.materials, settings_);
  block_.shake(whole, 0.5);
  save(whole);
  DemInfill resumed(block_.grains, block_.materials, settings_);
  resumed.load(h5::File::open(file_).root());
  advance(whole, 50);
  advance(resumed, 50);
  expect_same_bits(whole, resumed);
}

/// Saving brings LIGGGHTS' lists into another order, so the sums of forces differ in their last bits, and no
/// more.
TEST_F(Continuation, SavingDoesNotChangeThePhysics) {
  DemInfill saving(block_.grains, block_.materials, settings_),
      plain(block_.grains, block_.materials, settings_);
  for (DemInfill* infill : {&saving, &plain}) {
    block_.shake(*infill, 0.5);
    advance(*infill, 100);
  }
  save(saving);
  for (DemInfill* infill : {&saving, &plain}) advance(*infill, 20);
  for (std::size_t i = 0; i < block_.grains.size(); ++i) {
    const ParticleView one = saving.particles(), two = plain.particles();
    ASSERT_LT((one.velocity(i) - two.velocity(i)).norm(), 1e-10);
    ASSERT_LT((one.position(i) - two.position(i)).norm(), 1e-15);
  }
}

TEST_F(Continuation, RefusesACheckpointOfOtherGrains) {
  DemInfill infill(block_.grains, block_.materials, settings_);
  advance(infill, 2);
  save(infill);
  const ShakenBlock other(5);
  DemInfill wrong(other.grains, other.materials, settings_);
  try {
    wrong.load(h5::File::open(file_).root());
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("not those of this scene"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace tuft::dem::test

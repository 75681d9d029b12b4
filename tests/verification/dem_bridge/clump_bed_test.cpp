/// Clumps among each other: momentum, energy, checkpoints, leaving the box, what is refused.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <string>

#include "core/error.h"
#include "tests/verification/dem_bridge/clump_scene.h"
#include "tests/verification/dem_bridge/same_run.h"
#include "tests/verification/dem_bridge/squeezed_block.h"

namespace tuft::dem::test {
namespace {

constexpr double diameter = 0.002;

DemSettings settings_of_bed() {
  DemSettings settings = settings_in_box(0.05, Vec3(0, 0, -9.81));
  settings.rolling_resistance = true;
  return settings;
}

TEST(CollidingClumps, KeepMomentumAndAngularMomentum) {
  for (const bool with_sphere : {false, true}) {
    Grains grains;
    std::vector<Material> materials{clumped({ClumpShape::tetrahedron, 0.4}), rubber()};
    add_clump(grains, materials[0], Vec3(-0.0013, 0, 0), diameter, turn_about(Vec3(1, 2, 0), 0.5));
    if (with_sphere) {
      add_grain(grains, Vec3(0.0013, 0.0006, 0.0002), 0.0009, 1150);
      grains.material.back() = 1;
      grains.body.push_back(-1);
    } else {
      add_clump(grains, materials[0], Vec3(0.0013, 0.0006, 0.0002), 0.9 * diameter,
                turn_about(Vec3(0, 1, 1), 2));
    }
    DemSettings settings = settings_in_box(0.05);
    settings.rolling_resistance = true;
    DemInfill infill(grains, materials, settings);
    infill.set_velocity(0, Vec3(0.6, 0, 0.1), Vec3(0, 30, 0));
    infill.set_velocity(4, Vec3(-0.6, 0, 0), Vec3(0, 0, 0));
    const double window = 0.1 * infill.stable_step();
    infill.advance(window, 1, no_impulses(grains.size()));
    const Motion before = motion_of(infill, grains, materials);
    double touching = 0, energy = 0, defect = 0;
    for (int k = 0; k < 2500; ++k) {
      infill.advance(window, 1, no_impulses(grains.size()));
      const InfillEnergy now = infill.energy();
      touching = std::max(touching, now.stored / now.kinetic);
      if (k == 0) energy = total_energy(now);
      defect = std::max(defect, std::abs(total_energy(now) - energy));
    }
    const Motion after = motion_of(infill, grains, materials);
    const double size = before.angular_momentum.norm();
    ASSERT_GT(touching, 0.1);
    EXPECT_EQ(infill.energy().stored, 0);
    EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12 * 1e-5);
    EXPECT_LT((after.angular_momentum - before.angular_momentum).norm(), 2e-4 * size)
        << "but for spins that are half a step older than places";
    EXPECT_LT(defect, 1e-4 * energy);
    EXPECT_GT(infill.energy().dissipated, 0.05 * energy);
  }
}

TEST(Clump, DoesNotTouchItself) {
  Grains grains;
  const std::vector<Material> materials{clumped({ClumpShape::tetrahedron, 0.5})};
  add_clump(grains, materials[0], Vec3(0, 0, 0), diameter);
  add_clump(grains, materials[0], Vec3(0.0016, 0, 0), diameter);
  DemInfill infill(grains, materials, settings_in_box(0.05));
  const auto contacts = infill.overlaps().contacts;
  EXPECT_GE(contacts, 1u);
  EXPECT_LE(contacts, 4u);
  const auto fields = infill.fields();
  for (const double value : fields.at(0).values)
    EXPECT_EQ(value, static_cast<double>(contacts)) << "of the clump";
  const ParticleView view = infill.particles();
  double mass = 0;
  for (std::size_t i = 0; i < 4; ++i) mass += view.mass[i];
  EXPECT_NEAR(mass / (1150 * 3.141592653589793 / 6 * std::pow(diameter, 3)), 1, 1e-12)
      << "the union's, which sums of view.mass are";
}

class ClumpLedger : public ::testing::TestWithParam<std::tuple<GrainContact, bool>> {};
INSTANTIATE_TEST_SUITE_P(Contacts, ClumpLedger,
                         ::testing::Combine(::testing::Values(GrainContact::hertz, GrainContact::hooke),
                                            ::testing::Bool()));

TEST_P(ClumpLedger, OfAShakenBlockUnderGravityWallsAndDampingBalances) {
  const auto [contact, with_spheres] = GetParam();
  const ClumpBlock block({ClumpShape::tetrahedron, 0.5}, 4, with_spheres);
  DemSettings settings = settings_of_bed();
  settings.options.contact = contact;
  if (contact != GrainContact::hertz) settings.options.characteristic_velocity = 1;
  DemInfill infill(block.grains, block.materials, settings);
  block.shake(infill, 1);
  const double scale = infill.energy().kinetic;
  double start = 0, before = 0;
  for (int k = 0; k < 500; ++k) {
    if (k == 300) infill.set_damping(500);
    const double window = 0.8 * infill.stable_step();
    infill.begin_window(window, 1, true);
    infill.advance(window, 1, block.confine(infill, window));
    const InfillEnergy energy = infill.energy();
    if (k == 0) start = total_energy(energy);
    ASSERT_NEAR(total_energy(energy), start, 1e-4 * scale) << "window " << k;
    ASSERT_GE(energy.dissipated, before);
    before = energy.dissipated;
  }
  EXPECT_GT(infill.energy().dissipated, 0.2 * scale);
  EXPECT_GT(infill.energy().damping, 0.01 * scale);
  EXPECT_GT(infill.overlaps().contacts, 8u);
}

/// The step of each sphere's share bears the body's contacts, and twice as long a one does not.
double created_energy(const Clump& clump, double steps_of_stability) {
  return created_by_squeezing(ClumpBlock(clump, 4, false), settings_in_box(0.05), steps_of_stability, 0.1,
                              2e-3);
}

TEST(StableStepOfClumps, OfASqueezedBlockShowsAStepBeyondStability) {
  for (const double overlap : {0.2, 0.7}) {
    EXPECT_LT(created_energy({ClumpShape::tetrahedron, overlap}, 0.8), 1e-5) << overlap;
    EXPECT_LT(created_energy({ClumpShape::pair, overlap}, 0.8), 1e-5) << overlap;
  }
  EXPECT_GT(created_energy({ClumpShape::tetrahedron, 0.5}, 2), 0.1);
  EXPECT_GT(created_energy({ClumpShape::pair, 0.2}, 2), 0.1);
}

class ClumpContinuation : public ::testing::Test {
 protected:
  ~ClumpContinuation() override { std::filesystem::remove(file_); }
  void advance(DemInfill& infill, int windows, double share) const {
    const double window = 2 * share * infill.stable_step();
    for (int k = 0; k < windows; ++k) infill.advance(window, 2, block_.confine(infill, window));
  }
  void save(DemInfill& infill) const { save_run(infill, file_); }

  ClumpBlock block_{{ClumpShape::tetrahedron, 0.5}, 4, true};
  DemSettings settings_ = settings_of_bed();
  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("tuft-clumps-" + std::to_string(::getpid()) + ".h5");
};

TEST_F(ClumpContinuation, IsBitwiseTheRunThatSavedAndWentOn) {
  DemInfill whole(block_.grains, block_.materials, settings_);
  block_.shake(whole, 0.5);
  whole.set_damping(50);
  advance(whole, 100, 0.5);
  save(whole);
  DemInfill resumed(block_.grains, block_.materials, settings_);
  resumed.load(h5::File::open(file_).root());
  expect_same_bits(whole, resumed);
  advance(whole, 60, 0.5);
  advance(resumed, 60, 0.5);
  expect_same_bits(whole, resumed);
  for (DemInfill* infill : {&whole, &resumed}) advance(*infill, 60, 0.35);
  ASSERT_GT(whole.overlaps().contacts, 8u);
  expect_same_bits(whole, resumed);
}

TEST_F(ClumpContinuation, FromBeforeTheFirstWindowKeepsVelocities) {
  DemInfill whole(block_.grains, block_.materials, settings_);
  block_.shake(whole, 0.5);
  save(whole);
  DemInfill resumed(block_.grains, block_.materials, settings_);
  resumed.load(h5::File::open(file_).root());
  advance(whole, 50, 0.5);
  advance(resumed, 50, 0.5);
  expect_same_bits(whole, resumed);
}

TEST_F(ClumpContinuation, IsTheSameEveryTime) {
  DemInfill one(block_.grains, block_.materials, settings_), two(block_.grains, block_.materials, settings_);
  for (DemInfill* infill : {&one, &two}) {
    block_.shake(*infill, 0.5);
    advance(*infill, 100, 0.5);
  }
  expect_same_bits(one, two);
}

TEST(ExpelledClump, LeavesAsAWholeAndIsCountedOnce) {
  constexpr double window = 2e-6;
  Grains grains;
  const std::vector<Material> materials{clumped({ClumpShape::tetrahedron, 0.3})};
  add_clump(grains, materials[0], Vec3(0.007, 0, 0), diameter, turn_about(Vec3(1, 1, 0), 0.4));
  add_clump(grains, materials[0], Vec3(-0.004, 0, 0.004), diameter);
  add_clump(grains, materials[0], Vec3(0.004, 0, 0), 0.9 * diameter);  // follows the first to where it stands
  DemInfill infill(grains, materials, settings_in_box(0.01, Vec3(0, 0, -9.81)));
  const Vec3 velocity(5, 0, 1), spin(0, 300, 100);
  infill.set_velocity(0, velocity, spin);
  infill.set_velocity(8, Vec3(5, 0, 0), Vec3(0, 0, 0));
  infill.advance(window, 1, no_impulses(12));
  const double start = total_energy(infill.energy());
  double centre = 0;
  for (int k = 0; infill.expelled().particles == 0 && k < 1000; ++k) {
    centre = bodies_now(infill, grains, materials).bodies[0].centre.x();
    infill.advance(window, 1, no_impulses(12));
    EXPECT_NEAR(total_energy(infill.energy()) / start, 1, 1e-7);
  }
  EXPECT_LT(centre, 0.01);
  EXPECT_GT(centre, 0.01 - 2 * 5 * window);
  const Expelled gone = infill.expelled();
  const GrainBody body = find_bodies(grains, materials).bodies[0];
  EXPECT_EQ(gone.particles, 1u);
  EXPECT_NEAR(gone.mass / body.mass, 1, 1e-12);
  const Vec3 of_centre = velocity - spin.cross(grains.position[0] - body.centre);
  EXPECT_NEAR(gone.momentum.x() / (of_centre.x() * body.mass), 1, 1e-6);
  const Vec3 where = infill.particles().position(1);
  double meeting = 0;
  for (int k = 0; k < 900; ++k) {
    infill.advance(window, 1, no_impulses(12));
    ASSERT_NEAR(total_energy(infill.energy()) / start, 1, 1e-7) << k;
    meeting = std::max(meeting, infill.energy().stored);
  }
  EXPECT_EQ(meeting, 0) << "nothing touches what has left";
  EXPECT_EQ(infill.expelled().particles, 2u);
  const ParticleView view = infill.particles();
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(view.is_expelled(i), i < 4 || i >= 8) << i;
  EXPECT_EQ(view.position(1), where) << "it stands where it left";
  EXPECT_EQ(view.velocity(1), Vec3(0, 0, 0));
  EXPECT_LT(view.vz[5], -900 * window * 9.8) << "the other one falls on";
}

/// LIGGGHTS keeps what has left within 2 mm of the end of its own box: less than this clump reaches.
TEST(ExpelledClump, MayBeLargerThanTheRoomInWhichItIsKept) {
  Grains grains;
  const std::vector<Material> materials{clumped({ClumpShape::pair, 0.1})};
  add_clump(grains, materials[0], Vec3(0.008, 0, 0), 0.008, turn_about(Vec3(0, 1, 0), 1.5));
  DemInfill infill(grains, materials, settings_in_box(0.012));
  infill.set_velocity(0, Vec3(5, 0, 0), Vec3(0, 0, 0));
  for (int k = 0; k < 1000; ++k) infill.advance(2e-6, 1, no_impulses(2));
  EXPECT_EQ(infill.expelled().particles, 1u);
}

TEST(ExpelledClump, StaysExpelledToTheSameBitsAcrossACheckpoint) {
  const auto file =
      std::filesystem::temp_directory_path() / ("tuft_expelled_clump_" + std::to_string(::getpid()) + ".h5");
  Grains grains;
  const std::vector<Material> materials{clumped({ClumpShape::pair, 0.3})};
  add_clump(grains, materials[0], Vec3(0.009, 0, 0), diameter);
  add_clump(grains, materials[0], Vec3(-0.004, 0, 0.004), diameter);
  for (const int later : {0, 5}) {
    DemInfill whole(grains, materials, settings_in_box(0.01, Vec3(0, 0, -9.81))),
        resumed(grains, materials, settings_in_box(0.01, Vec3(0, 0, -9.81)));
    whole.set_velocity(0, Vec3(5, 0, 1), Vec3(0, 300, 0));
    whole.set_velocity(2, Vec3(0, 0, 1), Vec3(100, 300, 0));
    for (int k = 0; k < 1000 && whole.expelled().particles == 0; ++k) whole.advance(2e-6, 1, no_impulses(4));
    ASSERT_EQ(whole.expelled().particles, 1u);
    for (int k = 0; k < later; ++k) whole.advance(2e-6, 1, no_impulses(4));
    {
      h5::File saved = h5::File::create_atomically(file);
      h5::Group root = saved.root();
      whole.save(root);
      saved.commit();
    }
    resumed.load(h5::File::open(file).root());
    for (int k = 0; k < 20; ++k)
      for (DemInfill* infill : {&whole, &resumed}) infill->advance(2e-6, 2, no_impulses(4));
    tuft::test::expect_same_energy(whole.energy(), resumed.energy());
    EXPECT_EQ(resumed.expelled().momentum, whole.expelled().momentum);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(resumed.particles().position(i), whole.particles().position(i));
      EXPECT_EQ(resumed.particles().spin(i), whole.particles().spin(i));
      EXPECT_EQ(resumed.particles().is_expelled(i), i < 2);
    }
  }
  std::filesystem::remove(file);
}

std::string complaint(Grains grains, std::vector<Material> materials, int ranks = 1) {
  DemSettings settings = settings_in_box(0.05);
  settings.options.ranks = ranks;
  try {
    const DemInfill infill(grains, materials, settings);
    return "accepted";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(ClumpsThatAreNone, AreRefused) {
  const std::vector<Material> materials{clumped({ClumpShape::tetrahedron, 0.5})};
  Grains good;
  add_clump(good, materials[0], Vec3(0, 0, 0), diameter);
  add_clump(good, materials[0], Vec3(0.01, 0, 0), diameter);
  EXPECT_EQ(complaint(good, materials), "accepted");
  EXPECT_NE(complaint(good, materials, 2).find("infill.dem.ranks is 2; clumps of grains need one process"),
            std::string::npos);
  Grains moved = good;
  moved.position.z[2] += 1e-5;
  EXPECT_NE(complaint(moved, materials).find("is off its place in a clump of test grain"), std::string::npos);
  Grains fewer = good;
  fewer.body[3] = 1;
  EXPECT_NE(complaint(fewer, materials).find("clump 0 has 3 spheres, one of test grain has 4"),
            std::string::npos)
      << complaint(fewer, materials);
  Grains torn = good;
  torn.body[7] = 0;
  EXPECT_NE(complaint(torn, materials).find("has 3 spheres"), std::string::npos)
      << complaint(torn, materials);
  Grains mixed = good;
  add_grain(mixed, Vec3(0, 0.01, 0), 0.001, 1150);
  mixed.body.push_back(-1);
  EXPECT_NE(complaint(mixed, materials).find("grain 8 of test grain is a sphere, others are clumps"),
            std::string::npos);
  Grains shorter = good;
  shorter.body.pop_back();
  EXPECT_NE(complaint(shorter, materials).find("8 grains, but 7 are said"), std::string::npos)
      << complaint(shorter, materials);
}

}  // namespace
}  // namespace tuft::dem::test

/// Grains that leave their box: out of the run, and on the books.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "core/hdf5_file.h"
#include "tests/verification/dem_bridge/bridge_scene.h"
#include "tests/verification/same_energy.h"

namespace tuft::dem::test {
namespace {

constexpr double window = 2e-6;

double total(const InfillEnergy& e) {
  return e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping + e.expelled - e.contact_work;
}

/// One that flies out sideways, spinning, and one that falls and stays.
Grains two_grains() {
  Grains grains;
  add_grain(grains, Vec3(0.008, 0, 0), 0.001, 1150);
  add_grain(grains, Vec3(-0.004, 0, 0.004), 0.001, 1150);
  return grains;
}

DemInfill flying(const Grains& grains) {
  return {grains, {rubber()}, settings_in_box(0.01, Vec3(0, 0, -9.81))};
}

TEST(ExpelledGrains, TakeAlongWhatTheyHadAndBalanceTheEnergyToRounding) {
  DemInfill infill = flying(two_grains());
  infill.set_velocity(0, Vec3(5, 0, 1), Vec3(0, 300, 0));
  infill.advance(window, 1, no_impulses(2));
  const double start = total(infill.energy());
  const double mass = infill.particles().mass[0];
  double before = infill.particles().x[0];
  while (infill.expelled().particles == 0 && before < 0.02) {
    before = infill.particles().x[0];
    infill.advance(window, 1, no_impulses(2));
    EXPECT_NEAR(total(infill.energy()) / start, 1, 1e-12);
  }
  EXPECT_LT(before, 0.01);
  const Expelled gone = infill.expelled();
  const ParticleView view = infill.particles();
  ASSERT_TRUE(view.is_expelled(0));
  EXPECT_FALSE(view.is_expelled(1));
  EXPECT_EQ(gone.particles, 1u);
  EXPECT_EQ(gone.mass, mass);
  EXPECT_NEAR(gone.momentum.x() / (5 * mass), 1, 1e-12);
  const double spinning = 0.5 * 0.4 * mass * 1e-6 * 300 * 300, time = (view.x[0] - 0.008) / 5;
  EXPECT_NEAR(gone.kinetic_energy, 0.5 * mass * (25 + std::pow(1 - 9.81 * time, 2)) + spinning,
              1e-4 * gone.kinetic_energy);
  const Vec3 where = view.position(0);
  for (int k = 0; k < 200; ++k) {
    infill.advance(window, 1, no_impulses(2));
    EXPECT_NEAR(total(infill.energy()) / start, 1, 1e-12) << k;
  }
  EXPECT_EQ(infill.particles().position(0), where) << "it stands where it left";
  EXPECT_EQ(infill.particles().velocity(0), Vec3(0, 0, 0));
  EXPECT_LT(infill.particles().vz[1], -200 * window * 9.8) << "the other one falls on";
}

TEST(ExpelledGrains, AreNotThereForThoseThatFollow) {
  Grains grains;
  add_grain(grains, Vec3(0.0085, 0, 0), 0.001, 1150);
  add_grain(grains, Vec3(0.0055, 0, 0), 0.001, 1150);  // flies to the place where the first one stands
  DemInfill infill(grains, {rubber()}, settings_in_box(0.01));
  infill.set_velocity(0, Vec3(5, 0, 0), Vec3(0, 0, 0));
  infill.set_velocity(1, Vec3(5, 0, 0), Vec3(0, 0, 0));
  while (infill.expelled().particles == 0) infill.advance(window, 1, no_impulses(2));
  const Vec3 where = infill.particles().position(0);
  while (infill.expelled().particles == 1 && infill.particles().x[1] < 0.00998) {
    infill.advance(window, 1, no_impulses(2));
    ASSERT_EQ(infill.particles().vx[1], 5) << "with its centre at " << infill.particles().x[1];
  }
  EXPECT_GT(infill.particles().x[1], 0.0099);
  EXPECT_EQ(infill.particles().position(0), where);
}

/// While all are there, grains are kicked a block at a time; once one among them has left, blocks begin anew
/// behind it, and what does not fill one is kicked one by one. Both ways are the same motion, with the same
/// energies.
TEST(ExpelledGrains, ChangeNothingForABedFarFromThem) {
  constexpr std::size_t leaving = 37;
  const auto shaken = [](bool leaves) {
    Grains grains;
    for (int i = 0; i < 75; ++i) {  // touching, two blocks and a part
      if (i == leaving) add_grain(grains, Vec3(0.017, 0, 0.017), 0.001, 1150);
      add_grain(grains, 0.00199 * Vec3(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 1), 0.001, 1150);
    }
    DemInfill infill(grains, {rubber()}, settings_in_box(0.018, Vec3(0, 0, -9.81)));
    infill.set_velocity(leaving, Vec3(leaves ? 20 : 0, 0, 0), Vec3(0, 0, 0));
    infill.set_damping(50);
    ContactImpulses push = no_impulses(76);
    for (int k = 0; k < 300; ++k) {
      for (std::size_t i = 0; i < 45; ++i) {  // none in the last blocks
        if (i == leaving) continue;
        const auto a = static_cast<double>(i);
        push.linear.set(i, 1e-8 * Vec3(std::sin(0.1 * k + a), std::cos(0.2 * k + 2 * a), 0.3));
        push.angular.set(i, 1e-11 * Vec3(0.5, std::sin(0.3 * k), std::cos(a)));
      }
      infill.advance(window, 2, push);
    }
    EXPECT_EQ(infill.expelled().particles, leaves ? 1u : 0u);
    Vec3Array velocity;
    for (std::size_t i = 0; i < 76; ++i)
      if (i != leaving) velocity.push_back(infill.particles().velocity(i));
    return std::pair(velocity, infill.energy());
  };
  const auto [in_blocks, whole] = shaken(false);
  const auto [one_by_one, rest] = shaken(true);
  double fastest = 0;
  for (std::size_t i = 0; i < 75; ++i) fastest = std::max(fastest, in_blocks[i].norm());
  ASSERT_GT(fastest, 0.01);
  for (std::size_t i = 0; i < 75; ++i) EXPECT_LT((in_blocks[i] - one_by_one[i]).norm(), 1e-9 * fastest) << i;
  EXPECT_GT(whole.contact_work, 0);
  EXPECT_NEAR(rest.contact_work, whole.contact_work, 1e-9 * whole.contact_work);
}

TEST(ExpelledGrains, AreListedWithTheContactsOfTheEvaluationThatTheyLeaveWith) {
  Grains grains;
  add_grain(grains, Vec3(0.0099, 0, 0), 0.001, 1150);
  add_grain(grains, Vec3(0.008, 0, 0), 0.001, 1150);  // pressed by 0.1 mm
  DemInfill infill(grains, {rubber()}, settings_in_box(0.01));
  infill.set_velocity(0, Vec3(20, 0, 0), Vec3(0, 0, 0));
  infill.set_velocity(1, Vec3(20, 0, 0), Vec3(0, 0, 0));
  while (infill.expelled().particles == 0) infill.advance(window, 1, no_impulses(2));
  EXPECT_NO_THROW((void)infill.contacts()) << "the sums of forces must be each grain's own";
  infill.advance(window, 1, no_impulses(2));
  infill.advance(window, 1, no_impulses(2));
  EXPECT_NO_THROW((void)infill.contacts());
}

/// With a checkpoint as one leaves, and later.
class ExpelledGrainsWithACheckpoint : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(After, ExpelledGrainsWithACheckpoint, ::testing::Values(0, 5));

TEST_P(ExpelledGrainsWithACheckpoint, StayExpelledToTheSameBits) {
  const auto file =
      std::filesystem::temp_directory_path() / ("tuft_expelled_grains_" + std::to_string(::getpid()) + ".h5");
  DemInfill whole = flying(two_grains()), resumed = flying(two_grains());
  whole.set_velocity(0, Vec3(5, 0, 1), Vec3(0, 300, 0));
  while (whole.expelled().particles == 0) whole.advance(window, 1, no_impulses(2));
  for (int k = 0; k < GetParam(); ++k) whole.advance(window, 1, no_impulses(2));
  {
    h5::File saved = h5::File::create_atomically(file);
    h5::Group root = saved.root();
    whole.save(root);
    saved.commit();
  }
  resumed.load(h5::File::open(file).root());
  for (int k = 0; k < 20; ++k) {
    whole.advance(window, 2, no_impulses(2));
    resumed.advance(window, 2, no_impulses(2));
  }
  tuft::test::expect_same_energy(whole.energy(), resumed.energy());
  EXPECT_EQ(whole.energy().expelled, resumed.energy().expelled);
  EXPECT_EQ(resumed.expelled().momentum, whole.expelled().momentum);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(resumed.particles().position(i), whole.particles().position(i));
    EXPECT_EQ(resumed.particles().is_expelled(i), i == 0);
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace tuft::dem::test

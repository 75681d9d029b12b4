/// The energies that the coupler's ledger adds up.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/verification/dem_bridge/squeezed_block.h"

namespace tuft::dem::test {
namespace {

double total(const InfillEnergy& energy) {
  return energy.kinetic + energy.stored + energy.dissipated + energy.gravity_potential + energy.damping -
         energy.contact_work;
}

struct Collision {
  double start = 0, largest_stored = 0, largest_defect = 0, dissipated = 0, kinetic = 0, largest_drop = 0;
};

Collision collide(double restitution) {
  Grains grains;
  add_grain(grains, Vec3(-0.001005, 0, 0), 0.001, 1150);
  add_grain(grains, Vec3(0.001005, 0.0007, 0), 0.001, 1150);
  DemInfill infill(grains, {grain_material(8e6, 0.45, 1150, restitution, 0.4)}, settings_in_box(0.05));
  infill.set_velocity(0, Vec3(0.5, 0, 0), Vec3(0, 0, 0));
  infill.set_velocity(1, Vec3(-0.5, 0, 0), Vec3(0, 0, 0));
  Collision result;
  const ContactImpulses contact = no_impulses(2);
  result.start = infill.energy().kinetic;
  double before = 0;
  for (int k = 0; k < 1500; ++k) {
    infill.advance(0.1 * infill.stable_step(), 1, contact);
    const InfillEnergy energy = infill.energy();
    result.largest_stored = std::max(result.largest_stored, energy.stored);
    result.largest_defect = std::max(result.largest_defect, std::abs(total(energy) - result.start));
    result.largest_drop = std::max(result.largest_drop, before - energy.dissipated);
    before = result.dissipated = energy.dissipated;
    result.kinetic = energy.kinetic;
  }
  EXPECT_EQ(infill.energy().stored, 0) << "still in contact";
  return result;
}

TEST(InfillEnergy, HeadOnElasticCollisionDissipatesNothing) {
  Grains grains;
  add_grain(grains, Vec3(-0.001005, 0, 0), 0.001, 1150);
  add_grain(grains, Vec3(0.001005, 0, 0), 0.001, 1150);
  DemInfill infill(grains, {grain_material(8e6, 0.45, 1150, 1.0, 0.4)}, settings_in_box(0.05));
  infill.set_velocity(0, Vec3(0.5, 0, 0), Vec3(0, 0, 0));
  infill.set_velocity(1, Vec3(-0.5, 0, 0), Vec3(0, 0, 0));
  const double start = infill.energy().kinetic;
  const ContactImpulses contact = no_impulses(2);
  double stored = 0, dissipated = 0;
  for (int k = 0; k < 1500; ++k) {
    infill.advance(0.1 * infill.stable_step(), 1, contact);
    const InfillEnergy energy = infill.energy();
    stored = std::max(stored, energy.stored);
    dissipated = std::max(dissipated, std::abs(energy.dissipated));
  }
  // Energy of the overlaps and energy that left the motion are computed apart: this compares them all the
  // way.
  EXPECT_NEAR(stored, start, 1e-3 * start) << "at the peak all of it is elastic";
  EXPECT_LT(dissipated, 1e-3 * start);
}

TEST(InfillEnergy, ObliqueCollisionWithFrictionBalancesAndDissipationOnlyGrows) {
  const Collision result = collide(0.6);
  EXPECT_LT(result.largest_defect, 1e-4 * result.start);
  EXPECT_EQ(result.largest_drop, 0);
  EXPECT_GT(result.dissipated, 0.3 * result.start);
  EXPECT_NEAR(result.dissipated, result.start - result.kinetic, 1e-4 * result.start);
}

TEST(InfillEnergy, ShakenBlockUnderGravityWallsAndDampingBalances) {
  const ShakenBlock block(5);
  DemSettings settings = settings_in_box(0.05, Vec3(0, 0, -9.81));
  settings.rolling_resistance = true;
  DemInfill infill(block.grains, block.materials, settings);
  block.shake(infill, 0.5);
  const double scale = infill.energy().kinetic;
  double start = 0, before = 0;
  for (int k = 0; k < 400; ++k) {
    if (k == 200) infill.set_damping(500);
    const double window = 0.8 * infill.stable_step();
    try {
      infill.advance(window, 1, block.confine(infill, window));
    } catch (const RunError&) {
      break;  // a grain was shot out; the balance has shown it before
    }
    if (k == 0) start = total(infill.energy());
    if (k % 10 != 9) continue;
    const InfillEnergy energy = infill.energy();
    ASSERT_NEAR(total(energy), start, 1e-6 * scale) << "window " << k;
    ASSERT_GE(energy.dissipated, before);
    before = energy.dissipated;
  }
  EXPECT_GT(infill.energy().dissipated, 0.2 * scale);
  EXPECT_GT(infill.energy().damping, 0.05 * scale);
}

double created_energy(double steps_of_stability) {
  DemSettings settings = settings_in_box(0.05);
  settings.rolling_resistance = true;
  return created_by_squeezing(ShakenBlock(6), settings, steps_of_stability);
}

TEST(InfillEnergy, BalanceOfASqueezedBlockShowsAStepBeyondStability) {
  EXPECT_LT(created_energy(0.8), 1e-4);
  EXPECT_GT(created_energy(2.5), 0.1);
}

TEST(InfillEnergy, OfAWindowOfThreeSubstepsIsThatOfThreeWindows) {
  const auto run = [](int substeps) {
    const ShakenBlock block(3);
    DemSettings settings = settings_in_box(0.05);
    settings.rolling_resistance = true;
    DemInfill infill(block.grains, block.materials, settings);
    block.shake(infill, 0.5);
    const double window = 0.2 * substeps * infill.stable_step();
    const ContactImpulses none = no_impulses(block.grains.size());
    for (int k = 0; k < 90 / substeps; ++k) {
      // Energies of a run are asked for now and then, in both runs as of the same kicks.
      infill.begin_window(window, substeps, (k + 1) * substeps % 3 == 0);
      infill.advance(window, substeps, none);
      if ((k + 1) * substeps % 3 == 0) (void)infill.energy();
    }
    return infill.energy();
  };
  const InfillEnergy one = run(1), three = run(3);
  EXPECT_GT(one.stored, 1e-3 * one.kinetic) << "hardly a contact";
  EXPECT_GT(one.dissipated, 1e-3 * one.kinetic);
  EXPECT_NEAR(three.stored, one.stored, 1e-9 * one.stored);
  EXPECT_NEAR(three.kinetic, one.kinetic, 1e-9 * one.kinetic);
  EXPECT_NEAR(three.dissipated, one.dissipated, 1e-9 * one.dissipated);
}

/// Kicks leave out what only energies need: what moves must not notice, and the work of grains on each other
/// is summed all the same.
TEST(InfillEnergy, OfARunIsTheSameHoweverSeldomItIsWanted) {
  struct Run {
    std::vector<double> motion;
    InfillEnergy energy;
  };
  const auto run = [](int every) {
    const ShakenBlock block(6);
    DemSettings settings = settings_in_box(0.05);
    settings.gravity = {0, 0, -9.81};
    DemInfill infill(block.grains, block.materials, settings);
    block.shake(infill, 0.5);
    const double window = 0.2 * infill.stable_step();
    ContactImpulses contact = no_impulses(block.grains.size());
    contact.linear.set(100, Vec3(1e-9, 0, 0));  // one of a block of grains that are kicked at once
    for (int k = 1; k <= 60; ++k) {
      infill.begin_window(window, 1, k % every == 0);
      infill.advance(window, 1, contact);
    }
    const ParticleView p = infill.particles();
    Run result;
    for (const std::span<const double> values : {p.x, p.y, p.z, p.vx, p.vy, p.vz, p.wx, p.wy, p.wz})
      result.motion.insert(result.motion.end(), values.begin(), values.end());
    result.energy = infill.energy();
    return result;
  };
  const Run always = run(1), seldom = run(30);
  EXPECT_EQ(always.motion, seldom.motion);
  EXPECT_GT(always.energy.kinetic, 0);
  EXPECT_EQ(always.energy.kinetic, seldom.energy.kinetic);
  EXPECT_EQ(always.energy.contact_work, seldom.energy.contact_work);
  // dissipated adds up increases from one look to the next, which here are two and sixty
  EXPECT_NEAR(always.energy.dissipated, seldom.energy.dissipated, 0.01 * always.energy.dissipated);
  EXPECT_GT(always.energy.dissipated, 0.01 * always.energy.kinetic);
}

TEST(InfillEnergy, ContactWorkIsTheEnergyThatASpringGave) {
  Grains grains;
  add_grain(grains, Vec3(0.003, 0, 0), 0.001, 1150);
  DemInfill infill(grains, {rubber()}, settings_in_box(0.05));
  const double dt = 1e-5, stiffness = 0.1;
  ContactImpulses contact = no_impulses(1);
  const double start = 0.5 * stiffness * 0.003 * 0.003;
  for (int k = 0; k < 1000; ++k) {
    const double x = infill.particles().x[0];
    contact.linear.set(0, Vec3(-stiffness * x * dt, 0, 0));
    infill.advance(dt, 1, contact);
    const InfillEnergy energy = infill.energy();
    // Both as of the kick at x.
    ASSERT_NEAR(energy.contact_work, start - 0.5 * stiffness * x * x, 1e-3 * start);
    ASSERT_NEAR(energy.kinetic, energy.contact_work, 1e-12 * start);
  }
}

}  // namespace
}  // namespace tuft::dem::test

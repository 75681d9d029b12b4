/// Plastic springs (hooke/hysteresis) through the real host: loops against their closed form, and energy.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "dem_bridge/hertz.h"
#include "dem_bridge/hooke.h"
#include "dem_bridge/hooke_hysteresis.h"
#include "tests/verification/dem_bridge/squeezed_block.h"

namespace tuft::dem::test {
namespace {

constexpr double young = 8e6, poisson = 0.45, density = 1150, radius = 0.001, velocity = 2;

Material grain(double restitution) {
  return grain_material(young, poisson, density, restitution, 0.4);
}

DemSettings plastic(const Hysteresis& law) {
  DemSettings settings = settings_in_box(0.05);
  settings.options.contact = GrainContact::hooke_hysteresis;
  settings.options.characteristic_velocity = velocity;
  settings.options.unloading_ratio = law.unloading_ratio;
  settings.options.plastic_depth = law.plastic_depth;
  settings.options.adhesion_ratio = law.adhesion_ratio;
  return settings;
}

Grains two_grains(double gap, double offset = 0) {
  Grains grains;
  add_grain(grains, Vec3(-radius - 0.5 * gap, 0, 0), radius, density);
  add_grain(grains, Vec3(radius + 0.5 * gap, offset, 0), radius, density);
  return grains;
}

double stiffness_of_pair() {
  const double mass = 4.0 / 3 * std::numbers::pi * radius * radius * radius * density;
  return hooke_stiffness(effective_young_modulus(young, poisson, young, poisson), 0.5 * radius, 0.5 * mass,
                         velocity);
}

struct Collision {
  double start = 0, rebound = 0, dissipated = 0, largest_defect = 0, deepest = 0;
};

Collision collide(const DemSettings& settings, double restitution, double offset, double speed) {
  DemInfill infill(two_grains(1e-6, offset), {grain(restitution)}, settings);
  infill.set_velocity(0, Vec3(speed, 0, 0), Vec3(0, 0, 0));
  infill.set_velocity(1, Vec3(-speed, 0, 0), Vec3(0, 0, 0));
  Collision result;
  result.start = infill.energy().kinetic;
  const double dt = 0.02 * infill.stable_step();
  const ContactImpulses contact = no_impulses(2);
  for (int k = 0; k < 5000; ++k) {
    infill.begin_window(dt, 1, true);
    infill.advance(dt, 1, contact);
    const InfillEnergy energy = infill.energy();
    result.dissipated = energy.dissipated;
    result.largest_defect = std::max(
        result.largest_defect, std::abs(energy.kinetic + energy.stored + energy.dissipated - result.start));
    result.deepest =
        std::max(result.deepest, 2 * radius - (infill.particles().x[1] - infill.particles().x[0]));
  }
  EXPECT_EQ(infill.overlaps().contacts, 0u) << "still in contact";
  result.rebound = 0.5 * (infill.particles().vx[1] - infill.particles().vx[0]) / speed;
  return result;
}

/// Loaded with k to D, unloaded with k2 to the dent D (1 - k/k2), and pulled apart along -kc d. Of k D^2/2 a
/// share k/k2 comes back; pulling takes the triangle over the dent whose corner is where the lines meet.
double rebound_of(const Hysteresis& law, double largest) {
  const double k = stiffness_of_pair(), k2 = unloading_stiffness(law, k, 0.5 * radius, largest),
               kc = law.adhesion_ratio * k, dent = largest * (1 - k / k2), corner = k2 * dent / (k2 + kc);
  return std::sqrt(k / k2 - dent * kc * corner / (k * largest * largest));
}

TEST(PlasticCollision, ReboundsByTheRatioOfStiffnessesLessTheWorkOfAdhesion) {
  for (const double adhesion : {0.0, 0.3})
    for (const double speed : {0.2, 0.6}) {
      const Hysteresis law{3, 0.2, adhesion};
      const Collision result = collide(plastic(law), 1, 0, speed);
      const double mass = 4.0 / 3 * std::numbers::pi * radius * radius * radius * density,
                   largest = 2 * speed * std::sqrt(0.5 * mass / stiffness_of_pair());
      ASSERT_LT(largest, largest_plastic_overlap(law, 0.5 * radius));
      EXPECT_NEAR(result.deepest, largest, 2e-3 * largest);
      const double expected = rebound_of(law, largest);
      EXPECT_LT(expected, 0.95);
      EXPECT_NEAR(result.rebound, expected, 3e-3) << adhesion << " " << speed;
      // What does not come back has been booked as lost, all of it.
      EXPECT_NEAR(result.dissipated, (1 - expected * expected) * result.start, 5e-3 * result.start);
      EXPECT_LT(result.largest_defect, 1e-3 * result.start);
      RecordProperty("rebound" + std::to_string(adhesion) + "_" + std::to_string(speed),
                     std::to_string(result.rebound / expected));
    }
}

TEST(PlasticCollision, DentsNoDeeperThanThePlasticDepth) {
  const Hysteresis law{3, 0.02, 0};
  const Collision result = collide(plastic(law), 1, 0, 1.5);
  const double limit = largest_plastic_overlap(law, 0.5 * radius);
  ASSERT_GT(result.deepest, 1.5 * limit);
  // Beyond the limit the contact is elastic: only the triangle between both lines below it is lost.
  const double lost = 0.5 * stiffness_of_pair() * limit * limit * (1 - 1 / law.unloading_ratio);
  EXPECT_NEAR(result.dissipated, lost, 0.02 * lost);
}

TEST(PlasticCollision, ObliqueWithFrictionAndRollingBalances) {
  for (const RollingModel rolling : {RollingModel::epsd2, RollingModel::cdt}) {
    DemSettings settings = plastic({3, 0.2, 0.2});
    settings.rolling_resistance = true;
    settings.options.rolling = rolling;
    const Collision result = collide(settings, 0.6, 0.7 * radius, 0.5);
    EXPECT_LT(result.largest_defect, 1e-9 * result.start);
    EXPECT_GT(result.dissipated, 0.3 * result.start);
  }
}

/// Two grains that a slow force presses to F, lets go to a quarter of it, and presses to 1.5 F: at every
/// moment the listed force is that of the law, with the largest overlap so far.
TEST(PlasticContact, ForceFollowsFirstLoadingUnloadingAndLoadingAgain) {
  const Hysteresis law{4, 0.2, 0.5};
  DemInfill infill(two_grains(-1e-9), {grain(0.5)}, plastic(law));
  infill.set_damping(2000);
  const double dt = 0.5 * infill.stable_step(), k = stiffness_of_pair(), peak = k * 0.05 * radius;
  const double rise = 0.02;
  ContactImpulses contact = no_impulses(2);
  double largest = 0, worst = 0, stiffest = 0, before_overlap = 0, before_force = 0;
  for (int step = 0; step * dt < 4 * rise; ++step) {
    const double t = step * dt / rise;
    const double force = peak * (t < 1   ? t
                                 : t < 2 ? 1 - 0.75 * (t - 1)
                                 : t < 3 ? 0.25 + 1.25 * (t - 2)
                                         : 1.5);
    contact.linear.set(0, Vec3(force * dt, 0, 0));
    contact.linear.set(1, Vec3(-force * dt, 0, 0));
    infill.advance(dt, 1, contact);
    if (step % 50 != 0) continue;
    const double overlap = 2 * radius - (infill.particles().x[1] - infill.particles().x[0]);
    largest = std::max(largest, overlap);
    const ContactNetwork network = infill.contacts();
    ASSERT_EQ(network.size(), 1u);
    const double listed = -network.force(0).x();
    worst = std::max(worst, std::abs(listed - hysteretic_force(law, k, 0.5 * radius, overlap, largest)));
    if (t > 1.3 && t < 1.8)
      stiffest = std::max(stiffest, (listed - before_force) / (overlap - before_overlap));
    before_overlap = overlap, before_force = listed;
  }
  EXPECT_LT(worst, 0.02 * peak) << "damping is all that differs";
  EXPECT_NEAR(stiffest, unloading_stiffness(law, k, 0.5 * radius, 0.05 * radius), 0.1 * stiffest);
  EXPECT_GT(stiffest, 1.2 * k);
}

TEST(PlasticContact, SqueezedBlockCreatesNoEnergyAtTheStableStep) {
  DemSettings settings = plastic({4, 0.1, 0.5});
  settings.rolling_resistance = true;
  EXPECT_LT(created_by_squeezing(settings, grain(0.5), 0.8), 1e-9);
}

TEST(PlasticContact, DentsOutliveACheckpoint) {
  const auto file =
      std::filesystem::temp_directory_path() / ("tuft-plastic-" + std::to_string(::getpid()) + ".h5");
  ShakenBlock block(4);
  block.half_width *= 0.93;
  const DemSettings settings = plastic({4, 0.1, 0.5});
  const auto advance = [&](DemInfill& infill) {
    const double window = 0.5 * infill.stable_step();
    for (int k = 0; k < 150; ++k) infill.advance(window, 1, block.confine(infill, window));
  };
  DemInfill whole(block.grains, block.materials, settings);
  advance(whole);
  {
    auto stored = h5::File::create_atomically(file);
    h5::Group root = stored.root();
    whole.save(root);
    stored.commit();
  }
  DemInfill resumed(block.grains, block.materials, settings);
  resumed.load(h5::File::open(file).root());
  std::filesystem::remove(file);
  EXPECT_EQ(resumed.energy().stored, whole.energy().stored);
  advance(whole);
  advance(resumed);
  for (std::size_t i = 0; i < block.grains.size(); ++i)
    ASSERT_EQ(whole.particles().position(i), resumed.particles().position(i)) << i;
  EXPECT_EQ(resumed.energy().stored, whole.energy().stored);
}

}  // namespace
}  // namespace tuft::dem::test

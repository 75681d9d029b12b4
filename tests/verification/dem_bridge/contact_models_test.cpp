/// Every contact model that a scene can choose, through the real host: Hertz and Hooke, epsd2 and cdt,
/// cohesion, unlike pairs, and coarse graining as similarity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "dem_bridge/cohesion.h"
#include "dem_bridge/hertz.h"
#include "dem_bridge/hooke.h"
#include "tests/verification/dem_bridge/squeezed_block.h"

namespace tuft::dem::test {
namespace {

constexpr double young = 8e6, poisson = 0.45, density = 1150, radius = 0.001, velocity = 2;

DemSettings with(GrainContact contact, bool cohesion = false) {
  DemSettings settings = settings_in_box(0.05);
  settings.options.contact = contact;
  settings.options.characteristic_velocity = contact == GrainContact::hooke ? velocity : 0;
  settings.cohesion = cohesion;
  return settings;
}

Material grain(double restitution, double cohesion = 0) {
  Material material = grain_material(young, poisson, density, restitution, 0.4);
  material.grain->cohesion_energy_density = cohesion;
  return material;
}

Grains two_grains(double gap, double offset = 0) {
  Grains grains;
  add_grain(grains, Vec3(-radius - 0.5 * gap, 0, 0), radius, density);
  add_grain(grains, Vec3(radius + 0.5 * gap, offset, 0), radius, density);
  return grains;
}

void approach(DemInfill& infill, double speed) {
  infill.set_velocity(0, Vec3(speed, 0, 0), Vec3(0, 0, 0));
  infill.set_velocity(1, Vec3(-speed, 0, 0), Vec3(0, 0, 0));
}

double own_modulus() {
  return effective_young_modulus(young, poisson, young, poisson);
}

TEST(HookeCollision, LastsHalfAPeriodOverlapsAsASpringAndReboundsAsAsked) {
  for (const double restitution : {1.0, 0.6, 0.3}) {
    DemInfill infill(two_grains(1e-7), {grain(restitution)}, with(GrainContact::hooke));
    const double speed = 0.5, mass = 0.5 * infill.particles().mass[0];
    approach(infill, speed);
    const double stiffness = hooke_stiffness(own_modulus(), 0.5 * radius, mass, velocity);
    const double expected = hooke_contact_time(stiffness, mass, restitution), dt = 1e-3 * expected;
    const ContactImpulses contact = no_impulses(2);
    double touching = 0, deepest = 0;
    for (int k = 0; k < 1300; ++k) {
      infill.advance(dt, 1, contact);
      const double overlap = 2 * radius - (infill.particles().x[1] - infill.particles().x[0]);
      deepest = std::max(deepest, overlap);
      if (overlap > 0) touching += dt;
    }
    ASSERT_EQ(infill.overlaps().contacts, 0u);
    EXPECT_NEAR(touching, expected, 3e-3 * expected) << restitution;
    EXPECT_NEAR(-infill.particles().vx[0], restitution * speed, 3e-3 * speed) << restitution;
    if (restitution == 1) {
      EXPECT_NEAR(deepest, 2 * speed * std::sqrt(mass / stiffness), 1e-3 * deepest);
    }
    RecordProperty("time_error" + std::to_string(restitution), std::to_string(touching / expected - 1));
    RecordProperty("rebound" + std::to_string(restitution),
                   std::to_string(-infill.particles().vx[0] / speed));
  }
}

struct Collision {
  double start = 0, largest_stored = 0, least_stored = 0, largest_defect = 0, dissipated = 0;
};

Collision collide(const DemSettings& settings, const Material& material, double offset, double speed) {
  DemInfill infill(two_grains(1e-5, offset), {material}, settings);
  approach(infill, speed);
  Collision result;
  result.start = infill.energy().kinetic;
  const ContactImpulses contact = no_impulses(2);
  for (int k = 0; k < 3000; ++k) {
    infill.begin_window(0.05 * infill.stable_step(), 1, true);
    infill.advance(0.05 * infill.stable_step(), 1, contact);
    const InfillEnergy energy = infill.energy();
    result.largest_stored = std::max(result.largest_stored, energy.stored);
    result.least_stored = std::min(result.least_stored, energy.stored);
    result.dissipated = energy.dissipated;
    result.largest_defect = std::max(
        result.largest_defect, std::abs(energy.kinetic + energy.stored + energy.dissipated - result.start));
  }
  EXPECT_EQ(infill.energy().stored, 0) << "still in contact";
  return result;
}

TEST(EnergyOfModels, HeadOnElasticCollisionStoresAllMotionAndLosesNone) {
  // Energy of the contacts, a closed form of overlaps, and energy that left the motion, summed from forces,
  // are computed apart.
  for (const GrainContact contact : {GrainContact::hertz, GrainContact::hooke})
    for (const double cohesion : {0.0, 2e5}) {
      const Collision result = collide(with(contact, cohesion > 0), grain(1, cohesion), 0, 0.5);
      EXPECT_NEAR(result.largest_stored, result.start, 5e-4 * result.start);
      EXPECT_LT(result.dissipated, 5e-4 * result.start) << static_cast<int>(contact) << " " << cohesion;
      EXPECT_LT(result.largest_defect, 5e-4 * result.start);
      if (cohesion > 0 && contact == GrainContact::hertz) {
        EXPECT_LT(result.least_stored, -1e-4 * result.start) << "cohesion gives energy first";
      }
      RecordProperty("defect" + std::to_string(static_cast<int>(contact)) + (cohesion > 0 ? "c" : ""),
                     std::to_string(result.largest_defect / result.start));
    }
}

TEST(EnergyOfModels, ObliqueCollisionWithFrictionAndRollingBalances) {
  for (const GrainContact contact : {GrainContact::hertz, GrainContact::hooke})
    for (const RollingModel rolling : {RollingModel::epsd2, RollingModel::cdt})
      for (const double cohesion : {0.0, 5e4}) {
        DemSettings settings = with(contact, cohesion > 0);
        settings.rolling_resistance = true;
        settings.options.rolling = rolling;
        const Collision result = collide(settings, grain(0.6, cohesion), 0.7 * radius, 0.5);
        EXPECT_LT(result.largest_defect, 1e-9 * result.start)
            << static_cast<int>(contact) << static_cast<int>(rolling) << cohesion;
        EXPECT_GT(result.dissipated, 0.3 * result.start);
        EXPECT_LT(result.dissipated, 0.9 * result.start);
      }
}

TEST(EnergyOfModels, SqueezedBlockBalancesAtTheStableStepAndShowsOneBeyond) {
  for (const GrainContact contact : {GrainContact::hertz, GrainContact::hooke})
    for (const RollingModel rolling : {RollingModel::epsd2, RollingModel::cdt})
      for (const double cohesion : {0.0, 5e4}) {
        DemSettings settings = with(contact, cohesion > 0);
        settings.rolling_resistance = true;
        settings.options.rolling = rolling;
        const double created = created_by_squeezing(settings, grain(0.5, cohesion), 0.8);
        EXPECT_LT(created, 1e-9) << static_cast<int>(contact) << static_cast<int>(rolling) << cohesion;
        RecordProperty("created" + std::to_string(static_cast<int>(contact)) +
                           std::to_string(static_cast<int>(rolling)) + (cohesion > 0 ? "c" : ""),
                       std::to_string(1e6 * created) + "e-6");
      }
  EXPECT_GT(created_by_squeezing(with(GrainContact::hooke), grain(0.5, 0), 4), 0.1);
}

/// Two cohesive grains at balance, pulled apart with a force for 100 ms: whether they still touch.
bool hold(double force_over_pull_off, double cohesion) {
  const double pull_off = pull_off_force(cohesion, own_modulus(), 0.5 * radius);
  const double overlap = cohesive_overlap(cohesion, own_modulus()) * 0.5 * radius;
  DemInfill infill(two_grains(-overlap), {grain(0.5, cohesion)}, with(GrainContact::hertz, true));
  infill.set_damping(500);
  const double dt = 0.5 * infill.stable_step();
  ContactImpulses contact = no_impulses(2);
  for (int k = 0; k * dt < 0.1; ++k) {
    const double force = std::min(1.0, k * dt / 0.03) * force_over_pull_off * pull_off;
    contact.linear.set(0, Vec3(-force * dt, 0, 0));
    contact.linear.set(1, Vec3(force * dt, 0, 0));
    infill.advance(dt, 1, contact);
  }
  return infill.overlaps().contacts == 1;
}

TEST(Cohesion, HoldsUpToThePullOffForceAndNoFurther) {
  EXPECT_TRUE(hold(0.98, 5e4));
  EXPECT_FALSE(hold(1.02, 5e4));
}

TEST(Cohesion, RestsAtTheOverlapWhereItBalancesTheSpring) {
  const double cohesion = 5e4, expected = cohesive_overlap(cohesion, own_modulus()) * 0.5 * radius;
  DemInfill infill(two_grains(-0.3 * expected), {grain(0.5, cohesion)}, with(GrainContact::hertz, true));
  infill.set_damping(1000);
  for (int k = 0; k < 10000; ++k) infill.advance(0.5 * infill.stable_step(), 1, no_impulses(2));
  const double overlap = 2 * radius - (infill.particles().x[1] - infill.particles().x[0]);
  EXPECT_NEAR(overlap, expected, 2e-3 * expected);
  RecordProperty("overlap_over_expected", std::to_string(overlap / expected));
}

/// Two equal grains pressed together, their springs in balance with the press.
struct PressedPair {
  double normal = 0.01, rolling_friction = 0.1, spin = 100;  // N, -, rad/s
  double mass = 4.0 / 3 * std::numbers::pi * radius * radius * radius * density;
  double inertia = 0.4 * mass * radius * radius;
  double torque = rolling_friction * normal * 0.5 * radius;  // the largest
  double overlap, tangential;

  explicit PressedPair(GrainContact contact) {
    const double effective = 0.5 * radius;
    if (contact == GrainContact::hooke) {
      tangential = hooke_stiffness(own_modulus(), effective, 0.5 * mass, velocity);
      overlap = normal / tangential;
    } else {
      overlap = std::pow(normal / (4.0 / 3 * own_modulus() * std::sqrt(effective)), 2.0 / 3);
      tangential =
          tangential_stiffness(effective_shear_modulus(young, poisson, young, poisson), effective, overlap);
    }
  }
  [[nodiscard]] double rolling_stiffness() const { return tangential * 0.25 * radius * radius; }
  /// Constant torque until rest.
  [[nodiscard]] double spin_under_cdt(double t) const { return std::max(0.0, spin - torque / inertia * t); }
  /// The spring winds up, yields at the largest torque, and swings back when the grains have stopped.
  [[nodiscard]] double spin_under_epsd2(double t) const {
    const double omega = std::sqrt(2 * rolling_stiffness() / inertia), swing = torque / (inertia * omega);
    const double yields = std::asin(swing / spin) / omega, yielding = std::sqrt(spin * spin - swing * swing);
    const double stops = yields + yielding * inertia / torque;
    if (t < yields) return spin * std::cos(omega * t);
    if (t < stops) return yielding - torque / inertia * (t - yields);
    return -swing * std::sin(omega * (t - stops));
  }
};

/// What became of a pressed pair with given spins.
struct PressedMotion {
  double largest_difference = 0;                                       ///< of spin from a law of time, rad/s
  double largest_stored = 0;                                           ///< J, beyond that of the press
  double stored = 0, kinetic = 0, dissipated = 0, largest_defect = 0;  ///< J, at the end; of the sum
};

PressedMotion turn(const PressedPair& pair, const Material& material, const DemSettings& settings,
                   double other_spin, double until, const std::function<double(double)>& law) {
  DemInfill infill(two_grains(-pair.overlap), {material}, settings);
  infill.set_velocity(0, Vec3(0, 0, 0), Vec3(0, 0, pair.spin));
  infill.set_velocity(1, Vec3(0, 0, 0), Vec3(0, 0, other_spin));
  const double dt = 0.05 * infill.stable_step();
  ContactImpulses contact = no_impulses(2);
  contact.linear.set(0, Vec3(pair.normal * dt, 0, 0));
  contact.linear.set(1, Vec3(-pair.normal * dt, 0, 0));
  const InfillEnergy start = infill.energy();
  PressedMotion motion;
  for (int k = 0; k * dt < until; ++k) {
    infill.begin_window(dt, 1, true);
    infill.advance(dt, 1, contact);
    // Velocities are those half a step before the positions; the first kick is at t = 0.
    motion.largest_difference =
        std::max(motion.largest_difference, std::abs(infill.particles().wz[0] - law((k + 0.5) * dt)));
    const InfillEnergy energy = infill.energy();
    motion.stored = energy.stored - start.stored;
    motion.kinetic = energy.kinetic;
    motion.dissipated = energy.dissipated;
    motion.largest_stored = std::max(motion.largest_stored, motion.stored);
    motion.largest_defect = std::max(
        motion.largest_defect,
        std::abs(energy.kinetic + motion.stored + energy.dissipated - energy.contact_work - start.kinetic));
  }
  return motion;
}

TEST(RollingResistance, CdtSlowsRollingAtAConstantRateAndStoresNothing) {
  for (const GrainContact contact : {GrainContact::hertz, GrainContact::hooke}) {
    const PressedPair pair(contact);
    DemSettings settings = with(contact);
    settings.rolling_resistance = true;
    settings.options.rolling = RollingModel::cdt;
    const double until = 1.3 * pair.spin * pair.inertia / pair.torque;
    // Against each other, like gears: no sliding.
    const PressedMotion motion =
        turn(pair, grain(0.5), settings, -pair.spin, until, [&](double t) { return pair.spin_under_cdt(t); });
    const double energy = pair.inertia * pair.spin * pair.spin;
    EXPECT_LT(motion.largest_difference, 5e-3 * pair.spin);
    EXPECT_NEAR(motion.dissipated, energy, 1e-4 * energy);
    EXPECT_LT(motion.largest_stored, 1e-4 * energy);
    EXPECT_LT(motion.largest_defect, 1e-4 * energy);
    RecordProperty("difference" + std::to_string(static_cast<int>(contact)),
                   std::to_string(motion.largest_difference / pair.spin));
  }
}

TEST(RollingResistance, Epsd2WindsUpYieldsAndSwingsBackOnWhatItStored) {
  for (const GrainContact contact : {GrainContact::hertz, GrainContact::hooke}) {
    const PressedPair pair(contact);
    DemSettings settings = with(contact);
    settings.rolling_resistance = true;
    const double until = 1.3 * pair.spin * pair.inertia / pair.torque;
    const PressedMotion motion = turn(pair, grain(0.5), settings, -pair.spin, until,
                                      [&](double t) { return pair.spin_under_epsd2(t); });
    const double energy = pair.inertia * pair.spin * pair.spin;
    const double spring = 0.5 * pair.torque * pair.torque / pair.rolling_stiffness();
    ASSERT_GT(spring, 0.01 * energy);
    EXPECT_LT(motion.largest_difference, 1e-3 * pair.spin);
    EXPECT_NEAR(motion.largest_stored, spring, 1e-3 * spring);
    EXPECT_NEAR(motion.dissipated, energy - spring, 1e-4 * energy);
    EXPECT_NEAR(motion.stored + motion.kinetic, spring, 5e-3 * spring);
    EXPECT_LT(motion.largest_defect, 1e-4 * energy);
    RecordProperty("difference" + std::to_string(static_cast<int>(contact)),
                   std::to_string(motion.largest_difference / pair.spin));
    RecordProperty("stored" + std::to_string(static_cast<int>(contact)),
                   std::to_string(motion.largest_stored / spring));
  }
}

/// Both turn the same way: the contact's points part at 2 w r. The spring stops them (m s''/7 = -kt s) and
/// gives back what it took: without damping nothing is lost.
TEST(TangentialSpring, TakesTwoSeventhsOfMassTimesSquaredSpeedAndGivesItBack) {
  for (const GrainContact contact : {GrainContact::hertz, GrainContact::hooke}) {
    PressedPair pair(contact);
    pair.spin = 50;
    const double omega = std::sqrt(7 * pair.tangential / pair.mass), share = 5.0 / 7;
    Material material = grain(1);
    material.grain->friction = 2;
    const PressedMotion motion =
        turn(pair, material, with(contact), pair.spin, 2 * std::numbers::pi / omega,
             [&](double t) { return pair.spin * (1 - share + share * std::cos(omega * t)); });
    const double energy = pair.inertia * pair.spin * pair.spin,
                 spring = 2.0 / 7 * pair.mass * std::pow(radius * pair.spin, 2);
    EXPECT_LT(motion.largest_difference, 0.02 * pair.spin);
    EXPECT_NEAR(motion.largest_stored, spring, 0.02 * spring);
    EXPECT_LT(motion.dissipated, 2e-3 * energy);
    EXPECT_LT(motion.largest_defect, 2e-3 * energy);
    RecordProperty("difference" + std::to_string(static_cast<int>(contact)),
                   std::to_string(motion.largest_difference / pair.spin));
    RecordProperty("stored" + std::to_string(static_cast<int>(contact)),
                   std::to_string(motion.largest_stored / spring));
    RecordProperty("lost" + std::to_string(static_cast<int>(contact)),
                   std::to_string(motion.dissipated / energy));
  }
}

TEST(UnlikeGrains, ReboundAsTheirPairSaysAndElseAsTheMean) {
  for (const GrainContact contact : {GrainContact::hertz, GrainContact::hooke})
    for (const bool given : {false, true}) {
      DemSettings settings = with(contact);
      if (given) settings.options.pairs = {{.materials = {1, 0}, .restitution = 0.9}};
      Grains grains = two_grains(1e-6);
      grains.material[1] = 1;
      grains.density[1] = 2650;
      const Material sand = grain_material(50e6, 0.25, 2650, 0.8, 0.5);
      DemInfill infill(grains, {grain(0.4), sand}, settings);
      approach(infill, 0.5);
      for (int k = 0; k < 3000; ++k) infill.advance(0.1 * infill.stable_step(), 1, no_impulses(2));
      ASSERT_EQ(infill.overlaps().contacts, 0u);
      const double rebound = infill.particles().vx[1] - infill.particles().vx[0];
      EXPECT_NEAR(rebound, given ? 0.9 : 0.6, 0.01);
    }
}

/// Grains of a shaken, squeezed block after 150 windows, all lengths and times `factor` times as large.
struct Scaled {
  std::vector<double> place;  ///< over factor
  double stored, dissipated;  ///< over factor^3
};

Scaled run_scaled(DemSettings settings, double factor) {
  ShakenBlock block(4, factor * radius);
  block.half_width *= 0.95;
  Material material = grain(0.5, 1e5);
  material.grain->rolling_friction = 0.2;
  settings.box = {Vec3::Constant(-0.02 * factor), Vec3::Constant(0.02 * factor)};
  DemInfill infill(block.grains, {material}, settings);
  for (std::size_t i = 0; i < block.grains.size(); ++i) {
    const double a = 1.0 + static_cast<double>(i) * 0.7;
    infill.set_velocity(i, 0.3 * Vec3(std::sin(a), std::cos(2 * a), std::sin(3 * a)),
                        100 / factor * Vec3(std::cos(a), std::sin(2 * a), std::cos(3 * a)));
  }
  const double window = 0.5 * infill.stable_step();
  for (int k = 0; k < 150; ++k) {
    ContactImpulses contact = block.confine(infill, window);
    for (auto* const component : {&contact.linear.x, &contact.linear.y, &contact.linear.z})
      for (double& value : *component) value *= factor;  // walls' stiffness, N/m
    infill.advance(window, 1, contact);
  }
  Scaled result;
  for (const double x : infill.particles().x) result.place.push_back(x / factor);
  const InfillEnergy energy = infill.energy();
  result.stored = energy.stored / std::pow(factor, 3);
  result.dissipated = energy.dissipated / std::pow(factor, 3);
  return result;
}

TEST(CoarseGraining, LargerGrainsOfTheSameMaterialMoveAlikeInLengthsAndTimesOfTheirOwn) {
  for (const GrainContact contact : {GrainContact::hertz, GrainContact::hooke})
    for (const RollingModel rolling : {RollingModel::epsd2, RollingModel::cdt}) {
      DemSettings settings = with(contact, true);
      settings.rolling_resistance = true;
      settings.options.rolling = rolling;
      const Scaled own = run_scaled(settings, 1), large = run_scaled(settings, 3);
      double worst = 0;
      for (std::size_t i = 0; i < own.place.size(); ++i)
        worst = std::max(worst, std::abs(own.place[i] - large.place[i]));
      EXPECT_LT(worst, 1e-6 * radius) << static_cast<int>(contact) << static_cast<int>(rolling);
      EXPECT_GT(own.dissipated, 1e-6) << "nothing happened";
      EXPECT_NEAR(large.stored, own.stored, 1e-6 * std::abs(own.stored));
      EXPECT_NEAR(large.dissipated, own.dissipated, 1e-6 * own.dissipated);
      RecordProperty(
          "worst" + std::to_string(static_cast<int>(contact)) + std::to_string(static_cast<int>(rolling)),
          std::to_string(1e12 * worst / radius) + "e-12");
    }
}

}  // namespace
}  // namespace tuft::dem::test

#include "dem_bridge/host/kick.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace tuft::dem {
namespace {

class Kick : public ::testing::Test {
 protected:
  Vec3 vector(double size) { return size * Vec3(uniform_(engine_), uniform_(engine_), uniform_(engine_)); }
  /// A random grain with velocities v- and w-, as kick_grain wants them.
  GrainState grain(const Vec3& velocity, const Vec3& spin, double step) {
    GrainState state{velocity, spin, vector(0.1), vector(1e-4), 4e-6, 1.6e-12};
    state.velocity += 0.5 * step / state.mass * state.pair_force;
    state.spin += 0.5 * step / state.inertia * state.pair_torque;
    return state;
  }
  GrainLoad load(double damping) { return {vector(0.1), vector(1e-4), Vec3(0, 0, -9.81), damping, 1e-6}; }

  std::mt19937_64 engine_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

TEST_F(Kick, ChangeOfKineticEnergyIsTheWorkOfAllForces) {
  for (int trial = 0; trial < 50; ++trial) {
    const GrainLoad given = load(trial % 2 == 0 ? 0 : 1e5);
    const Vec3 before = vector(1), spin_before = vector(100);
    const GrainState state = grain(before, spin_before, given.step);
    const GrainKick kick = kick_grain(state, given);
    const Vec3 after = before + given.step / state.mass * (state.pair_force + kick.added_force);
    const Vec3 spin_after =
        spin_before + given.step / state.inertia * (state.pair_torque + kick.added_torque);
    const auto kinetic = [&](const Vec3& v, const Vec3& w) {
      return 0.5 * state.mass * v.squaredNorm() + 0.5 * state.inertia * w.squaredNorm();
    };
    const double gravity_work = given.step * state.mass * given.gravity.dot(kick.middle);
    const double gain = kinetic(after, spin_after) - kinetic(before, spin_before);
    const double scale = kinetic(after, spin_after) + kinetic(before, spin_before);
    EXPECT_NEAR(gain, kick.pair_work + kick.contact_work + kick.damping_work + gravity_work, 1e-13 * scale);
    EXPECT_NEAR(kick.kinetic, 0.5 * scale, 1e-13 * scale);
    EXPECT_LT((kick.middle - 0.5 * (before + after)).norm(), 1e-13);
  }
}

TEST_F(Kick, DampingNeverAddsEnergyAndIsStableForAnyStep) {
  for (const double damping : {1.0, 1e3, 1e6, 1e12}) {
    GrainState state{Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(0, 0, 0), Vec3(0, 0, 0), 4e-6, 1.6e-12};
    const GrainLoad given{Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0), damping, 1e-5};
    const GrainKick kick = kick_grain(state, given);
    const Vec3 after = state.velocity + given.step / state.mass * kick.added_force;
    EXPECT_LE(kick.damping_work, 0);
    EXPECT_LT(after.norm(), state.velocity.norm() * (1 + 1e-12));
  }
}

TEST_F(Kick, WithoutDampingNothingIsAddedBeyondContactAndGravity) {
  const GrainLoad given = load(0);
  const GrainState state = grain(vector(1), vector(10), given.step);
  const GrainKick kick = kick_grain(state, given);
  EXPECT_EQ(kick.added_force, Vec3(given.contact_force + state.mass * given.gravity));
  EXPECT_EQ(kick.added_torque, given.contact_torque);
  EXPECT_EQ(kick.damping_work, 0);
}

TEST_F(Kick, OfAGrainThatNothingElseTouchesIsTheFreeKickToTheLastBit) {
  for (int trial = 0; trial < 50; ++trial) {
    GrainLoad given = load(0);
    given.contact_force = given.contact_torque = Vec3::Zero();
    const GrainState state = grain(vector(1), vector(10), given.step);
    const GrainKick whole = kick_grain(state, given);
    const Vec3 gain = 0.5 * given.step * given.gravity;
    const auto free =
        free_kick(state.velocity, state.spin, state.pair_force, state.pair_torque, gain, given.step);
    EXPECT_EQ(free.velocity, Vec3(whole.middle + whole.gain));
    EXPECT_EQ(free.pair_work, whole.pair_work);
    EXPECT_EQ(Vec3(whole.middle_spin + whole.spin_gain), state.spin);
  }
}

TEST_F(Kick, GivesInTwoHalvesWhatIsAddedToTheForces) {
  for (const double damping : {0.0, 1e5}) {
    const GrainLoad given = load(damping);
    const GrainState state = grain(vector(1), vector(10), given.step);
    const GrainKick kick = kick_grain(state, given);
    const double half = 0.5 * given.step;
    EXPECT_LT((half / state.mass * kick.added_force - kick.gain).norm(), 1e-14);
    EXPECT_LT((half / state.inertia * kick.added_torque - kick.spin_gain).norm(), 1e-12);
    EXPECT_LT((state.velocity + kick.gain - kick.middle).norm(), 1e-14);
  }
}

Pack3 of_lanes(const std::array<Vec3, lanes>& values) {
  const auto component = [&](Eigen::Index c) { return Pack([&](auto lane) { return values[lane][c]; }); };
  return {component(0), component(1), component(2)};
}

TEST_F(Kick, OfManyGrainsAtOnceIsThatOfEach) {
  std::array<GrainState, lanes> grains;
  std::array<GrainLoad, lanes> loads;
  std::array<Vec3, lanes> velocity, spin, pair_force, pair_torque, force, torque;
  for (std::size_t l = 0; l < lanes; ++l) {
    grains[l] = grain(vector(1), vector(10), 1e-6);
    grains[l].mass *= 1.0 + 0.1 * static_cast<double>(l);
    loads[l] = load(1e5);
    velocity[l] = grains[l].velocity, spin[l] = grains[l].spin;
    pair_force[l] = grains[l].pair_force, pair_torque[l] = grains[l].pair_torque;
    force[l] = loads[l].contact_force, torque[l] = loads[l].contact_torque;
  }
  const GrainStateOf<Pack3, Pack> together{of_lanes(velocity),
                                           of_lanes(spin),
                                           of_lanes(pair_force),
                                           of_lanes(pair_torque),
                                           Pack([&](auto lane) { return grains[lane].mass; }),
                                           grains[0].inertia};
  std::array<Vec3, lanes> gravity;
  gravity.fill(loads[0].gravity);
  const auto kicks = kick_grain(
      together, GrainLoadOf<Pack3>{of_lanes(force), of_lanes(torque), of_lanes(gravity), 1e5, 1e-6});
  for (std::size_t l = 0; l < lanes; ++l) {
    const GrainKick one = kick_grain(grains[l], loads[l]);
    EXPECT_NEAR(kicks.middle.y[l], one.middle.y(), 1e-14);
    EXPECT_NEAR(kicks.middle_spin.z[l], one.middle_spin.z(), 1e-13);
    EXPECT_NEAR(kicks.added_force.x[l], one.added_force.x(), 1e-14);
    EXPECT_NEAR(kicks.added_torque.y[l], one.added_torque.y(), 1e-17);
    EXPECT_NEAR(kicks.kinetic[l], one.kinetic, 1e-14 * one.kinetic);
    const double scale = 1e-14 * one.kinetic;
    EXPECT_NEAR(kicks.pair_work[l], one.pair_work, scale);
    EXPECT_NEAR(kicks.contact_work[l], one.contact_work, scale);
    EXPECT_NEAR(kicks.damping_work[l], one.damping_work, scale);
  }
}

}  // namespace
}  // namespace tuft::dem

#include "dem_bridge/host/kick.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace tuft::dem {
namespace {

class Kick : public ::testing::Test {
 protected:
  Vec3 vector(double size) { return size * Vec3(uniform_(engine_), uniform_(engine_), uniform_(engine_)); }
  GrainState grain() { return {vector(1), vector(100), vector(0.1), vector(1e-4), 4e-6, 1.6e-12}; }
  GrainLoad load(double damping) { return {vector(0.1), vector(1e-4), Vec3(0, 0, -9.81), damping, 1e-6}; }

  std::mt19937_64 engine_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

TEST_F(Kick, ChangeOfKineticEnergyIsTheWorkOfAllForces) {
  for (int trial = 0; trial < 50; ++trial) {
    const GrainLoad given = load(trial % 2 == 0 ? 0 : 1e5);
    const GrainState state = grain();
    const GrainKick kick = kick_grain(state, given);
    const auto kinetic = [&](const Vec3& v, const Vec3& w) {
      return 0.5 * state.mass * v.squaredNorm() + 0.5 * state.inertia * w.squaredNorm();
    };
    const Vec3 middle = 0.5 * (state.velocity + kick.velocity);
    const double gravity_work = given.step * state.mass * given.gravity.dot(middle);
    const double before = kinetic(state.velocity, state.spin), after = kinetic(kick.velocity, kick.spin);
    const double scale = before + after;
    EXPECT_NEAR(after - before, kick.pair_work + kick.contact_work + kick.damping_work + gravity_work,
                1e-13 * scale);
    EXPECT_NEAR(kick.kinetic, 0.5 * scale, 1e-13 * scale);
  }
}

/// m (v+ - v-) = dt (f + f_contact + m g - c m v), and of spin alike.
TEST_F(Kick, ChangesMomentaByAllForcesAndByDampingAtTheMiddle) {
  for (const double damping : {0.0, 1e5}) {
    const GrainLoad given = load(damping);
    const GrainState state = grain();
    const GrainKick kick = kick_grain(state, given);
    const Vec3 middle = 0.5 * (state.velocity + kick.velocity), middle_spin = 0.5 * (state.spin + kick.spin);
    const Vec3 force =
                   state.pair_force + given.contact_force + state.mass * (given.gravity - damping * middle),
               torque = state.pair_torque + given.contact_torque - damping * state.inertia * middle_spin;
    EXPECT_LT((state.mass * (kick.velocity - state.velocity) - given.step * force).norm(),
              1e-13 * given.step * force.norm() + 1e-14 * state.mass);
    EXPECT_LT((state.inertia * (kick.spin - state.spin) - given.step * torque).norm(),
              1e-13 * given.step * torque.norm() + 1e-12 * state.inertia);
  }
}

TEST_F(Kick, DampingNeverAddsEnergyAndIsStableForAnyStep) {
  for (const double damping : {1.0, 1e3, 1e6, 1e12}) {
    GrainState state{Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(0, 0, 0), Vec3(0, 0, 0), 4e-6, 1.6e-12};
    const GrainLoad given{Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0, 0, 0), damping, 1e-5};
    const GrainKick kick = kick_grain(state, given);
    EXPECT_LE(kick.damping_work, 0);
    EXPECT_LT(kick.velocity.norm(), state.velocity.norm() * (1 + 1e-12));
  }
}

TEST_F(Kick, WithoutDampingNoneIsBooked) {
  EXPECT_EQ(kick_grain(grain(), load(0)).damping_work, 0);
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
    grains[l] = grain();
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
    EXPECT_NEAR(kicks.velocity.y[l], one.velocity.y(), 1e-14);
    EXPECT_NEAR(kicks.spin.z[l], one.spin.z(), 1e-12);
    EXPECT_NEAR(kicks.kinetic[l], one.kinetic, 1e-14 * one.kinetic);
    const double scale = 1e-14 * one.kinetic;
    EXPECT_NEAR(kicks.pair_work[l], one.pair_work, scale);
    EXPECT_NEAR(kicks.contact_work[l], one.contact_work, scale);
    EXPECT_NEAR(kicks.damping_work[l], one.damping_work, scale);
  }
}

}  // namespace
}  // namespace tuft::dem

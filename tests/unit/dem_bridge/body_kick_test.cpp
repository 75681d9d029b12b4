#include "dem_bridge/host/body_kick.h"

#include <gtest/gtest.h>

#include <random>

#include "dem_bridge/host/kick.h"

namespace tuft::dem {
namespace {

class KickOfABody : public ::testing::Test {
 protected:
  Vec3 vector(double size) { return size * Vec3(uniform_(engine_), uniform_(engine_), uniform_(engine_)); }
  /// A random body with velocity v- and angular momentum L-, as kick_body wants them.
  BodyState body(const Vec3& velocity, const Vec3& angular_momentum, double step) {
    const Mat3 axes = Eigen::AngleAxisd(2, vector(1).normalized()).toRotationMatrix();
    BodyState state{velocity,    angular_momentum,
                    vector(0.1), vector(1e-4),
                    4e-6,        axes * Vec3(3e11, 5e11, 9e11).asDiagonal() * axes.transpose()};
    state.velocity += 0.5 * step / state.mass * state.pair_force;
    state.angular_momentum += 0.5 * step * state.pair_torque;
    return state;
  }
  BodyLoad load(double damping) { return {vector(0.1), vector(1e-4), Vec3(0, 0, -9.81), damping, 1e-6}; }

  std::mt19937_64 engine_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

TEST_F(KickOfABody, ChangeOfKineticEnergyIsTheWorkOfAllForces) {
  for (int trial = 0; trial < 50; ++trial) {
    const BodyLoad given = load(trial % 2 == 0 ? 0 : 1e5);
    const Vec3 before = vector(1), turning_before = vector(3e-10);
    const BodyState state = body(before, turning_before, given.step);
    const BodyKick kick = kick_body(state, given);
    const Vec3 after = before + given.step / state.mass * (state.pair_force + kick.added_force);
    const Vec3 turning_after = turning_before + given.step * (state.pair_torque + kick.added_torque);
    const auto kinetic = [&](const Vec3& v, const Vec3& turning) {
      return 0.5 * state.mass * v.squaredNorm() + 0.5 * turning.dot(state.inverse_inertia * turning);
    };
    const double gravity_work = given.step * state.mass * given.gravity.dot(kick.middle);
    const double gain = kinetic(after, turning_after) - kinetic(before, turning_before);
    const double scale = kinetic(after, turning_after) + kinetic(before, turning_before);
    EXPECT_NEAR(gain, kick.pair_work + kick.contact_work + kick.damping_work + gravity_work, 1e-13 * scale);
    EXPECT_NEAR(kick.kinetic, 0.5 * scale, 1e-13 * scale);
    EXPECT_LT((kick.middle - 0.5 * (before + after)).norm(), 1e-13);
    EXPECT_LT((kick.middle_angular_momentum - 0.5 * (turning_before + turning_after)).norm(), 1e-22);
  }
}

TEST_F(KickOfABody, OfEqualMomentsIsThatOfAGrain) {
  for (const double damping : {0.0, 1e5}) {
    const BodyLoad given = load(damping);
    BodyState state = body(vector(1), vector(3e-10), given.step);
    const double inertia = 1.6e-12;
    state.inverse_inertia = Mat3::Identity() / inertia;
    const double half = 0.5 * given.step;
    const Vec3 before = state.velocity - half / state.mass * state.pair_force,
               spin_before = (state.angular_momentum - half * state.pair_torque) / inertia;
    const GrainState grain{before, spin_before, state.pair_force, state.pair_torque, state.mass, inertia};
    const BodyKick a = kick_body(state, given);
    const GrainKick b = kick_grain(
        grain, GrainLoad{given.contact_force, given.contact_torque, given.gravity, damping, given.step});
    EXPECT_LT((a.middle - 0.5 * (before + b.velocity)).norm(), 1e-14);
    EXPECT_LT((a.middle_angular_momentum / inertia - 0.5 * (spin_before + b.spin)).norm(), 1e-11);
    EXPECT_LT((before + given.step / state.mass * (state.pair_force + a.added_force) - b.velocity).norm(),
              1e-14);
    EXPECT_LT((spin_before + given.step / inertia * (state.pair_torque + a.added_torque) - b.spin).norm(),
              1e-11);
    EXPECT_NEAR(a.kinetic / b.kinetic, 1, 1e-13);
    EXPECT_NEAR(a.pair_work, b.pair_work, 1e-13 * b.kinetic);
    EXPECT_NEAR(a.contact_work, b.contact_work, 1e-13 * b.kinetic);
    EXPECT_NEAR(a.damping_work, b.damping_work, 1e-13 * b.kinetic);
  }
}

}  // namespace
}  // namespace tuft::dem

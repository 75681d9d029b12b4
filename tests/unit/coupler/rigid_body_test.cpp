#include "coupler/rigid_body.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tuft::coupler {
namespace {

TEST(CylinderDistance, IsTheDistanceToTheNearestSurfacePoint) {
  const Cylinder c{0.025, 0.1};
  EXPECT_NEAR(distance_to(c, Vec3(0, 0, -0.01)).distance, 0.01, 1e-15);
  EXPECT_NEAR(distance_to(c, Vec3(0.03, 0, 0.05)).distance, 0.005, 1e-15);
  EXPECT_NEAR(distance_to(c, Vec3(0.028, 0, -0.004)).distance, 0.005, 1e-15);
  EXPECT_NEAR(distance_to(c, Vec3(0, 0.01, 0.004)).distance, -0.004, 1e-15);
  EXPECT_NEAR(distance_to(c, Vec3(0, 0.024, 0.05)).distance, -0.001, 1e-15);
  EXPECT_NEAR(distance_to(c, Vec3(0, 0, 0.13)).distance, 0.03, 1e-15);
}

TEST(CylinderDistance, NormalIsTheGradientOfTheDistance) {
  const Cylinder c{0.025, 0.1};
  for (const Vec3& p : {Vec3(0.01, 0.005, -0.003), Vec3(0.03, 0.01, 0.04), Vec3(0.02, 0.02, -0.004),
                        Vec3(0.003, -0.002, 0.002), Vec3(0.02, 0.013, 0.05), Vec3(0.02, 0.02, 0.11)}) {
    const SurfacePoint s = distance_to(c, p);
    const double h = 1e-7;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = h * Vec3::Unit(axis);
      const double slope = (distance_to(c, p + step).distance - distance_to(c, p - step).distance) / (2 * h);
      EXPECT_NEAR(s.normal[axis], slope, 1e-6) << p.transpose();
    }
    EXPECT_NEAR(s.normal.norm(), 1, 1e-14);
  }
}

TEST(CylinderDistance, OfARoundedEdgeIsThatToTheRingInsideItLessTheRim) {
  const Cylinder c{0.025, 0.1};
  constexpr double rim = 0.003;
  EXPECT_NEAR(distance_to(c, Vec3(0.01, 0, -0.004), rim).distance, 0.004, 1e-15) << "below the flat face";
  EXPECT_NEAR(distance_to(c, Vec3(0, 0.03, 0.05), rim).distance, 0.005, 1e-15) << "beside the shaft";
  EXPECT_NEAR(distance_to(c, Vec3(0.022 + 0.003, 0, 0.003 - 0.004), rim).distance, 0.002, 1e-15);
  EXPECT_NEAR(distance_to(c, Vec3(0.025, 0, 0), rim).distance, (std::sqrt(2.0) - 1) * rim, 1e-15);
  EXPECT_NEAR(distance_to(c, Vec3(0, 0, 0.13), rim).distance, 0.03, 1e-15) << "the upper end has no rim";
  for (const Vec3& p : {Vec3(0.024, 0.01, -0.003), Vec3(0.02, 0.013, 0.001), Vec3(0.01, 0.005, 0.002),
                        Vec3(0.016, 0.018, 0.05), Vec3(0.02, 0.02, 0.11)})
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = 1e-7 * Vec3::Unit(axis);
      const double slope =
          (distance_to(c, p + step, rim).distance - distance_to(c, p - step, rim).distance) / 2e-7;
      EXPECT_NEAR(distance_to(c, p, rim).normal[axis], slope, 1e-6) << p.transpose();
    }
}

/// The normal against differences of the distance.
template <class Shape>
void expect_gradient(const Shape& shape, const Vec3& p) {
  const SurfacePoint s = distance_to(shape, p);
  const double h = 1e-7;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = h * Vec3::Unit(axis);
    const double slope =
        (distance_to(shape, p + step).distance - distance_to(shape, p - step).distance) / (2 * h);
    EXPECT_NEAR(s.normal[axis], slope, 1e-6) << p.transpose();
  }
  EXPECT_NEAR(s.normal.norm(), 1, 1e-14);
}

TEST(BoreDistance, IsWhatIsLeftToTheWallAndTheNormalPointsInwards) {
  const Bore bore{0.025};
  EXPECT_NEAR(distance_to(bore, Vec3(0.02, 0, 7)).distance, 0.005, 1e-15);
  EXPECT_NEAR(distance_to(bore, Vec3(0, -0.03, 0)).distance, -0.005, 1e-15);
  for (const Vec3& p : {Vec3(0.01, 0.02, 0), Vec3(-0.02, 0.02, 0.1)}) expect_gradient(bore, p);
}

TEST(BlockDistance, IsTheDistanceToTheNearestSurfacePoint) {
  const Block block{Vec3(0.01, 0.02, 0.03)};
  EXPECT_NEAR(distance_to(block, Vec3(0.015, 0.01, -0.02)).distance, 0.005, 1e-15);
  EXPECT_NEAR(distance_to(block, Vec3(0.013, -0.024, 0)).distance, 0.005, 1e-15) << "an edge";
  EXPECT_NEAR(distance_to(block, Vec3(0.01 + 2e-3, 0.02 + 3e-3, -0.03 - 6e-3)).distance, 7e-3, 1e-15)
      << "a corner";
  EXPECT_NEAR(distance_to(block, Vec3(0.008, 0, 0)).distance, -0.002, 1e-15);
  for (const Vec3& p : {Vec3(0.015, 0.01, -0.02), Vec3(0.013, -0.024, 0.001), Vec3(-0.012, 0.023, 0.036),
                        Vec3(0.002, -0.019, 0.003)})
    expect_gradient(block, p);
}

TEST(RoundDistances, AreFromAxisAndCentreAndNormalsPointOutwards) {
  const SurfacePoint side = distance_to(LyingCylinder{0.05}, Vec3(0.03, 7, -0.04) * 2);
  EXPECT_NEAR(side.distance, 0.05, 1e-15);
  EXPECT_NEAR((side.normal - Vec3(0.6, 0, -0.8)).norm(), 0, 1e-15);
  const SurfacePoint inside = distance_to(Ball{0.05}, Vec3(0.02, -0.01, 0.02));
  EXPECT_NEAR(inside.distance, -0.02, 1e-15);
  EXPECT_NEAR((inside.normal - Vec3(2, -1, 2) / 3).norm(), 0, 1e-15);
}

/// Of a force that lasts evenly around its moment.
BodyPush even_push(const Vec3& impulse) {
  return {impulse, 0.5 * impulse};
}

TEST(RigidBody, DrivenMovesAtItsSpeedAndBooksTheWorkAgainstContact) {
  RigidBody body;
  body.driven = true;
  body.drive = Vec3(0, 0, -0.2);
  const double dt = 1e-5;
  const BodyAdvance first = advance_body(body, even_push(Vec3(0, 0, 3e-3)), Vec3(0, 0, -9.81), dt);
  EXPECT_EQ(body.velocity.z(), -0.2);
  EXPECT_NEAR(body.position.z(), -0.2 * dt, 1e-20);
  EXPECT_NEAR(first.external.whole, 0.5 * 3e-3 * 0.2, 1e-18) << "the mean of rest and full speed";
  EXPECT_EQ(first.external.until_now, 0);
  const BodyAdvance second = advance_body(body, even_push(Vec3(0, 0, 3e-3)), Vec3(0, 0, -9.81), dt);
  EXPECT_NEAR(second.external.whole, 3e-3 * 0.2, 1e-18);
  EXPECT_NEAR(second.external.until_now, 0.5 * second.external.whole, 1e-18);
  EXPECT_EQ((second.impulse_taken - Vec3(0, 0, 3e-3)).norm(), 0);
}

TEST(RigidBody, LoadedAndDampedOnASpringComesToRestWhereTheyBalanceAndKeepsItsBooks) {
  RigidBody body;
  body.mass = 0.1;
  body.freedom = Vec3(0, 0, 1);
  body.load = Vec3(0, 0, -50);
  const double stiffness = 1e5, dt = 1e-5;
  body.guide_damping = 2 * std::sqrt(stiffness * body.mass);
  double work = 0, damped = 0;
  for (int i = 0; i < 4000; ++i) {
    const BodyAdvance a =
        advance_body(body, even_push(Vec3(0, 0, -stiffness * body.position.z() * dt)), Vec3::Zero(), dt);
    work += a.external.whole;
    damped += a.damped.whole;
    EXPECT_LT(
        (a.impulse_taken - Vec3(0, 0, -stiffness * (body.position.z() - body.velocity.z() * dt) * dt)).norm(),
        1e-12);
  }
  EXPECT_NEAR(body.position.z(), -50 / stiffness, 1e-12);
  EXPECT_NEAR(work, 50 * 50 / stiffness, 1e-9);
  EXPECT_NEAR(damped, 0.5 * work, 1e-4 * work) << "the other half is in the spring";
}

TEST(RigidBody, HasItsEnergyOfTheMomentOfAForceThatLastsUnevenlyAroundIt) {
  RigidBody body;
  body.mass = 2;
  body.freedom = Vec3(0, 0, 1);
  body.velocity = Vec3(0, 0, -3);
  // 600 N from 1 ms before the moment until 3 ms after it.
  const double lag = 1e-3, length = 4e-3;
  const Vec3 force(50, 0, 600);
  const BodyAdvance a = advance_body(body, {length * force, lag * force}, Vec3::Zero(), 1e-3);
  const double then = -3 + 600 * lag / 2, half_a_kick = 0.5 * 600 * length / 2;
  EXPECT_NEAR(a.kinetic, 0.5 * 2 * (then * then + half_a_kick * half_a_kick), 1e-12)
      << "with the square of half the change, as at even kicks";
  RigidBody driven;
  driven.driven = true;
  driven.velocity = driven.drive = Vec3(0, 0, -3);
  EXPECT_NEAR(advance_body(driven, {length * force, lag * force}, Vec3::Zero(), 1e-3).external.until_now,
              3 * 600 * lag, 1e-12);
}

TEST(RigidBody, FreeFallFollowsTheParabola) {
  RigidBody body;
  body.mass = 2.25;
  body.freedom = Vec3(0, 0, 1);
  const double dt = 1e-4;
  body.velocity = Vec3(0, 0, 9.81 * dt / 2);  // half a step before rest
  for (int i = 0; i < 1000; ++i) advance_body(body, {}, Vec3(0, 0, -9.81), dt);
  EXPECT_NEAR(body.position.z(), -0.5 * 9.81 * 0.1 * 0.1, 1e-12);
}

TEST(RigidBody, TakesExactlyTheImpulseItIsGiven) {
  RigidBody body;
  body.mass = 2.25;
  body.freedom = Vec3(0, 0, 1);
  body.velocity = Vec3(0, 0, -2.85);
  const Vec3 impulse(0.3, -0.1, 1.7);
  const BodyAdvance a = advance_body(body, even_push(impulse), Vec3(0, 0, -9.81), 1e-5);
  EXPECT_LT((a.impulse_taken - impulse).norm(), 1e-14)
      << "free directions by momentum, held ones by the guides";
  EXPECT_EQ(body.velocity.x(), 0);
  EXPECT_NEAR(body.velocity.z(), -2.85 + 1.7 / 2.25 - 9.81e-5, 1e-14);
}

}  // namespace
}  // namespace tuft::coupler

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

TEST(RigidBody, FreeFallFollowsTheParabola) {
  RigidBody body;
  body.mass = 2.25;
  body.freedom = Vec3(0, 0, 1);
  const double dt = 1e-4;
  body.velocity = Vec3(0, 0, 9.81 * dt / 2);  // half a step before rest
  for (int i = 0; i < 1000; ++i) advance_body(body, Vec3::Zero(), Vec3(0, 0, -9.81), dt);
  EXPECT_NEAR(body.position.z(), -0.5 * 9.81 * 0.1 * 0.1, 1e-12);
}

TEST(RigidBody, TakesExactlyTheImpulseItIsGiven) {
  RigidBody body;
  body.mass = 2.25;
  body.freedom = Vec3(0, 0, 1);
  body.velocity = Vec3(0, 0, -2.85);
  const Vec3 impulse(0.3, -0.1, 1.7);
  const BodyAdvance a = advance_body(body, impulse, Vec3(0, 0, -9.81), 1e-5);
  EXPECT_LT((a.impulse_taken - impulse).norm(), 1e-14)
      << "free directions by momentum, held ones by the guides";
  EXPECT_EQ(body.velocity.x(), 0);
  EXPECT_NEAR(body.velocity.z(), -2.85 + 1.7 / 2.25 - 9.81e-5, 1e-14);
}

}  // namespace
}  // namespace tuft::coupler

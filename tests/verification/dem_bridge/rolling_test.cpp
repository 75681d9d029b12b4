/// Rolling resistance: a grain that rolls over another 1000 times as large, which is a plane to it and does
/// not move.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

class RollingDecay : public ::testing::TestWithParam<RollingModel> {};

// The torque mu_r N r* against the spin of a grain that rolls without slip: (I + m r^2) dw/dt = -mu_r N r*,
// so dv/dt = -5/7 mu_r N/m. epsd2 winds up its spring first, over a turn of mu_r N/(kt r*).
TEST_P(RollingDecay, SlowsAGrainByFiveSeventhsOfRollingFrictionTimesWeight) {
  constexpr double radius = 0.001, plane = 1000 * radius, speed = 0.1, weight = 50;  // m, m, m/s, m/s^2
  for (const double mu_r : {0.05, 0.2}) {
    Material material = rubber();
    material.grain->rolling_friction = mu_r;
    Grains grains;
    add_grain(grains, Vec3(0, 0, -plane), plane, 1150);
    add_grain(grains, Vec3(0, 0, radius - 2e-6), radius, 1150);
    DemSettings settings = settings_in_box(1.1 * plane);
    settings.rolling_resistance = true;
    settings.options.rolling = GetParam();
    DemInfill infill(grains, {material}, settings);
    infill.set_velocity(1, Vec3(speed, 0, 0), Vec3(0, speed / radius, 0));
    const double dt = 0.2 * infill.stable_step(), mass = infill.particles().mass[1];
    ContactImpulses contact = no_impulses(2);
    const double deceleration = 5.0 / 7 * mu_r * weight, until = 0.8 * speed / deceleration;
    const auto windows = static_cast<int>(until / dt);
    double early = 0;
    int at = 0;
    for (int k = 0; k < windows; ++k) {
      const Vec3 up = (infill.particles().position(1) - infill.particles().position(0)).normalized();
      contact.linear.set(1, -mass * weight * dt * up);
      infill.advance(dt, 1, contact);
      if (k == windows / 4) early = infill.particles().vx[1], at = k;
    }
    const double late = infill.particles().vx[1];
    EXPECT_NEAR((early - late) / ((windows - 1 - at) * dt), deceleration, 0.01 * deceleration) << mu_r;
    EXPECT_NEAR(infill.particles().wy[1] * radius, late, 0.01 * speed) << "rolls";
  }
}
INSTANTIATE_TEST_SUITE_P(Models, RollingDecay, ::testing::Values(RollingModel::cdt, RollingModel::epsd2),
                         [](const auto& test) { return test.param == RollingModel::cdt ? "cdt" : "epsd2"; });

}  // namespace
}  // namespace tuft::dem::test

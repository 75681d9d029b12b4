/// One grain of LIGGGHTS on a plane of the coupler: sliding, rolling, slopes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "grain_case.h"

namespace tuft::coupler {
namespace {

constexpr double radius = 0.002, gravity = 9.81;

/// A grain at rest on the plane z = 0 under a weight that is turned by `slope` (rad) about y: downhill is +x.
GrainCase on_plane(double mu, double slope) {
  GrainCase setup;
  setup.gravity = gravity * Vec3(std::sin(slope), 0, -std::cos(slope));
  setup.bodies.push_back(half_space("plane", Vec3(0, 0, 0), Vec3(0, 0, 1)));
  setup.body_friction = {mu, mu, 0};
  setup.stiffness = 500;
  setup.damping_ratio = 0.2;  // else the tangential spring swings on
  const double mass = 4.0 / 3 * std::numbers::pi * radius * radius * radius * 1150;
  const double sunk = mass * gravity * std::cos(slope) / setup.stiffness;
  dem::test::add_grain(setup.grains, Vec3(0, 0, radius - sunk), radius, 1150);
  return setup;
}

TEST(GrainOnAPlane, SlidesUntilItRollsAtFiveSeventhsOfItsSpeed) {
  constexpr double mu = 0.3, speed = 0.5;
  Simulation s = make(on_plane(mu, 0), {{Vec3(speed, 0, 0), Vec3(0, 0, 0)}});
  // u = u0 - mu g t up to 2 u0/(7 mu g).
  const double rolls_from = 2 * speed / (7 * mu * gravity);
  s.advance_interval(0.5 * rolls_from);
  EXPECT_NEAR(s.infill().particles().vx[0], speed - 0.5 * mu * gravity * rolls_from, 1e-3 * speed);
  s.advance_interval(1.5 * rolls_from);
  EXPECT_NEAR(s.infill().particles().vx[0], 5.0 / 7 * speed, 1e-3 * speed);
  EXPECT_NEAR(s.infill().particles().wy[0] * radius, 5.0 / 7 * speed, 1e-3 * speed);
  const EnergyTerms& e = s.ledger().last();
  const double mass = s.infill().particles().mass[0];
  EXPECT_NEAR(e.contact_friction, mass * speed * speed / 7, 2e-3 * mass * speed * speed)
      << "2/7 of its energy";
}

/// Of a grain released on a slope, after `time`.
struct Descent {
  double velocity = 0, surface = 0;  ///< m/s, of the centre; spin times radius
};
Descent descend(double mu, double slope, double time) {
  Simulation s = make(on_plane(mu, slope));
  s.advance_interval(time);
  return {s.infill().particles().vx[0], s.infill().particles().wy[0] * radius};
}

TEST(GrainOnASlope, RollsWithoutSlipUpToSevenHalvesOfItsFriction) {
  constexpr double slope = 0.5, time = 0.05;  // tan 0.5 = 0.546: rolls from mu = 0.156 on
  const double rolled = 5.0 / 7 * gravity * std::sin(slope) * time;
  for (const double mu : {0.17, 0.5}) {
    const Descent d = descend(mu, slope, time);
    EXPECT_NEAR(d.velocity, rolled, 0.002 * rolled) << mu;
    EXPECT_NEAR(d.surface, rolled, 0.005 * rolled) << mu;
  }
}

TEST(GrainOnASlope, SlidesAndSpinsAsCoulombSaysBeyond) {
  constexpr double slope = 0.5, time = 0.05;
  for (const double mu : {0.05, 0.14}) {
    const Descent d = descend(mu, slope, time);
    const double velocity = gravity * (std::sin(slope) - mu * std::cos(slope)) * time,
                 surface = 2.5 * mu * gravity * std::cos(slope) * time;
    EXPECT_NEAR(d.velocity, velocity, 0.002 * velocity) << mu;
    EXPECT_NEAR(d.surface, surface, 0.005 * surface) << mu;
  }
}

}  // namespace
}  // namespace tuft::coupler

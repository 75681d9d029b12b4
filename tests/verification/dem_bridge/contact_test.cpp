/// Grains against each other (LIGGGHTS' contact models) and against a body that a test makes of contact
/// impulses.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "dem_bridge/hertz.h"
#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

struct Benchmark {
  std::string bodies;
  double young, poisson, density, radius, speed, peak_force, peak_overlap;
};

std::vector<Benchmark> read_benchmarks() {
  std::ifstream file("tests/verification/dem_bridge/chung_ooi_2011.csv");
  std::vector<Benchmark> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#' || line.starts_with("bodies")) continue;
    Benchmark row;
    std::istringstream stream(line);
    std::getline(stream, row.bodies, ',');
    char comma = 0;
    stream >> row.young >> comma >> row.poisson >> comma >> row.density >> comma >> row.radius >> comma >>
        row.speed >> comma >> row.peak_force >> comma >> row.peak_overlap;
    row.young *= 1e9;
    rows.push_back(row);
  }
  return rows;
}

/// Two equal grains on the x axis, `gap` apart, each moving at `speed` towards the other.
Grains pair_of_grains(double radius, double density, double gap) {
  Grains grains;
  add_grain(grains, Vec3(-radius - 0.5 * gap, 0, 0), radius, density);
  add_grain(grains, Vec3(radius + 0.5 * gap, 0, 0), radius, density);
  return grains;
}

TEST(HertzCollision, PeakForceAndOverlapMatchChungAndOoiWithinTwoPercent) {
  const auto benchmarks = read_benchmarks();
  ASSERT_EQ(benchmarks.size(), 2u);
  for (const Benchmark& row : benchmarks) {
    const Material material = grain_material(row.young, row.poisson, row.density, 1.0, 0.3);
    DemInfill infill(pair_of_grains(row.radius, row.density, 1e-6), {material}, settings_in_box(0.1));
    infill.set_velocity(0, Vec3(row.speed, 0, 0), Vec3(0, 0, 0));
    infill.set_velocity(1, Vec3(-row.speed, 0, 0), Vec3(0, 0, 0));
    const double dt = 0.05 * infill.stable_step(), mass = infill.particles().mass[0];
    double overlap = 0, force = 0, speed = row.speed;
    const ContactImpulses contact = no_impulses(2);
    for (int k = 0; k < 800; ++k) {
      infill.advance(dt, 1, contact);
      const ParticleView view = infill.particles();
      overlap = std::max(overlap, 2 * row.radius - (view.x[1] - view.x[0]));
      force = std::max(force, mass * (speed - view.vx[0]) / dt);
      speed = view.vx[0];
    }
    EXPECT_NEAR(overlap, row.peak_overlap, 0.02 * row.peak_overlap) << row.bodies;
    EXPECT_NEAR(force, row.peak_force, 0.02 * row.peak_force) << row.bodies;
    EXPECT_NEAR(speed, -row.speed, 1e-3 * row.speed) << row.bodies << ": elastic rebound";
  }
}

TEST(HertzCollision, ReboundHasTheCoefficientOfRestitution) {
  for (const double restitution : {0.3, 0.6, 0.9}) {
    const Material material = grain_material(8e6, 0.45, 1150, restitution, 0.3);
    DemInfill infill(pair_of_grains(0.001, 1150, 1e-6), {material}, settings_in_box(0.05));
    infill.set_velocity(0, Vec3(0.5, 0, 0), Vec3(0, 0, 0));
    infill.set_velocity(1, Vec3(-0.5, 0, 0), Vec3(0, 0, 0));
    const ContactImpulses contact = no_impulses(2);
    for (int k = 0; k < 1500; ++k) infill.advance(0.1 * infill.stable_step(), 1, contact);
    ASSERT_EQ(infill.overlaps().contacts, 0u);
    EXPECT_NEAR(-infill.particles().vx[0] / 0.5, restitution, 0.02) << restitution;
    EXPECT_NEAR(infill.particles().vx[0] + infill.particles().vx[1], 0, 1e-13);
  }
}

TEST(GrainOnABody, RestsAtTheOverlapThatCarriesItsWeight) {
  const double radius = 0.001, stiffness = 100;  // N/m
  Grains grains;
  add_grain(grains, Vec3(0, 0, radius), radius, 1150);
  DemInfill infill(grains, {rubber()}, settings_in_box(0.05, Vec3(0, 0, -9.81)));
  infill.set_damping(2000);
  const double mass = infill.particles().mass[0], dt = 1e-5;
  ContactImpulses contact = no_impulses(1);
  for (int k = 0; k < 4000; ++k) {
    const double overlap = radius - infill.particles().z[0];
    contact.linear.set(0, Vec3(0, 0, overlap > 0 ? stiffness * overlap * dt : 0));
    infill.advance(dt, 1, contact);
  }
  const double expected = mass * 9.81 / stiffness;
  EXPECT_NEAR(radius - infill.particles().z[0], expected, 1e-9 * expected);
  EXPECT_LT(infill.particles().velocity(0).norm(), 1e-12);
}

TEST(GrainOnABody, ReboundsElasticallyFromAPenaltyFloor) {
  const double radius = 0.001, stiffness = 2000, speed = 0.5;
  Grains grains;
  add_grain(grains, Vec3(0, 0, radius + 1e-5), radius, 1150);
  DemInfill infill(grains, {rubber()}, settings_in_box(0.05));
  infill.set_velocity(0, Vec3(0, 0, -speed), Vec3(0, 0, 0));
  const double mass = infill.particles().mass[0];
  const double dt = 0.02 * std::sqrt(mass / stiffness);
  ContactImpulses contact = no_impulses(1);
  double deepest = 0;
  for (int k = 0; k < 600; ++k) {
    const double overlap = radius - infill.particles().z[0];
    deepest = std::max(deepest, overlap);
    contact.linear.set(0, Vec3(0, 0, overlap > 0 ? stiffness * overlap * dt : 0));
    infill.advance(dt, 1, contact);
  }
  EXPECT_NEAR(infill.particles().vz[0], speed, 1e-3 * speed);
  EXPECT_NEAR(deepest, speed * std::sqrt(mass / stiffness), 1e-3 * deepest);
}

TEST(GrainOnABody, SlidingGrainEndsRollingAtFiveSevenths) {
  const double radius = 0.002, speed = 1.0, friction = 0.3, gravity = 9.81;
  Grains grains;
  add_grain(grains, Vec3(-0.3, 0, radius), radius, 1150);
  DemInfill infill(grains, {rubber()}, settings_in_box(0.35, Vec3(0, 0, -gravity)));
  infill.set_velocity(0, Vec3(speed, 0, 0), Vec3(0, 0, 0));
  const double mass = infill.particles().mass[0], dt = 2e-5;
  ContactImpulses contact = no_impulses(1);
  double slid_until = 0;
  for (int k = 0; k < 6000; ++k) {
    const ParticleView view = infill.particles();
    // The floor carries the weight; friction acts on the lowest point, until it stops it.
    const Vec3 arm(0, 0, -radius);
    const Vec3 slip = view.velocity(0) + view.spin(0).cross(arm);
    const double slip_speed = std::hypot(slip.x(), slip.y());
    const double stopping =
        2.0 / 7.0 * mass * slip_speed;  // impulse that stops the point: 1/(1/m + r^2/I) = 2 m/7
    const double sliding = friction * mass * gravity * dt;
    Vec3 impulse(0, 0, 0);
    if (slip_speed > 0) impulse = -std::min(sliding, stopping) / slip_speed * Vec3(slip.x(), slip.y(), 0);
    if (stopping > sliding) slid_until = (k + 1) * dt;
    contact.angular.set(0, arm.cross(impulse));
    contact.linear.set(0, impulse + Vec3(0, 0, mass * gravity * dt));
    infill.advance(dt, 1, contact);
  }
  const ParticleView view = infill.particles();
  EXPECT_NEAR(view.vx[0], 5.0 / 7.0 * speed, 1e-6 * speed);
  EXPECT_NEAR(view.wy[0] * radius, 5.0 / 7.0 * speed, 1e-6 * speed);
  // u(t) = u0 - mu g t until 2 u0 / (7 mu g)
  EXPECT_NEAR(slid_until, 2 * speed / (7 * friction * gravity), 2 * dt);
}

/// Two grains pressed together by +-normal and sheared by +-tangential; couples hold them from rolling (a
/// pressed pair is unstable in rolling: it buckles).
double sliding_speed_of_pressed_pair(double friction, double tangential_over_normal) {
  const double radius = 0.001, normal = 0.01;
  const Material material = grain_material(8e6, 0.45, 1150, 0.5, friction);
  const double young = effective_young_modulus(8e6, 0.45, 8e6, 0.45);
  const double overlap = std::pow(normal / (4.0 / 3.0 * young * std::sqrt(0.5 * radius)), 2.0 / 3.0);
  DemInfill infill(pair_of_grains(radius, 1150, -overlap), {material}, settings_in_box(0.05));
  infill.set_damping(3000);
  const double inertia = 0.4 * infill.particles().mass[0] * radius * radius;
  const double dt = 0.2 * infill.stable_step(), tangential = tangential_over_normal * normal;
  ContactImpulses contact = no_impulses(2);
  for (int k = 0; k < 4000; ++k) {
    const double rise = std::min(1.0, k / 1000.0);
    const Vec3 force(normal, rise * tangential, 0);
    contact.linear.set(0, dt * force);
    contact.linear.set(1, -dt * force);
    const Vec3 couple(0, 0, rise * tangential * (radius - 0.5 * overlap) * dt);
    for (std::size_t i = 0; i < 2; ++i) contact.angular.set(i, couple - inertia * infill.particles().spin(i));
    infill.advance(dt, 1, contact);
  }
  return infill.particles().vy[0] - infill.particles().vy[1];
}

TEST(GrainFriction, SticksBelowCoulombsLimitAndSlidesAboveIt) {
  EXPECT_LT(std::abs(sliding_speed_of_pressed_pair(0.5, 0.4)), 1e-3);
  EXPECT_GT(std::abs(sliding_speed_of_pressed_pair(0.5, 0.6)), 0.05);
}

TEST(GrainFriction, SpringOfAContactIsForgottenWhenTheGrainsPart) {
  // An oblique collision leaves a stretched spring behind. Then the pair is brought together again head on,
  // at once, so that LIGGGHTS has not built its neighbour list anew: there must be no force across.
  const double radius = 0.001;
  DemInfill infill(pair_of_grains(radius, 1150, 1e-6), {grain_material(8e6, 0.45, 1150, 0.5, 0.6)},
                   settings_in_box(0.01));
  infill.set_velocity(0, Vec3(0.02, 0.01, 0), Vec3(0, 0, 0));
  infill.set_velocity(1, Vec3(-0.02, -0.01, 0), Vec3(0, 0, 0));
  const double dt = 0.1 * infill.stable_step(), mass = infill.particles().mass[0];
  const double inertia = 0.4 * mass * radius * radius;
  bool touched = false, parted = false, touched_again = false;
  double across = 0;
  for (int k = 0; k < 6000; ++k) {
    const ParticleView view = infill.particles();
    const Vec3 apart = view.position(1) - view.position(0), along = apart.normalized();
    const bool touching = apart.norm() < 2 * radius;
    ContactImpulses contact = no_impulses(2);
    if (touched && !touching &&
        !parted) {  // all motion is replaced by a slow approach along the line of centres
      parted = true;
      for (std::size_t i = 0; i < 2; ++i) {
        contact.linear.set(i, mass * ((i == 0 ? 0.01 : -0.01) * along - view.velocity(i)));
        contact.angular.set(i, -inertia * view.spin(i));
      }
    } else if (parted) {
      touched_again |= touching;
      const Vec3 relative = view.velocity(0) - view.velocity(1);
      across = std::max(across, (relative - relative.dot(along) * along).norm());
    }
    touched |= touching;
    infill.advance(dt, 1, contact);
  }
  ASSERT_TRUE(touched && parted && touched_again);
  EXPECT_LT(across, 1e-9);
}

}  // namespace
}  // namespace tuft::dem::test

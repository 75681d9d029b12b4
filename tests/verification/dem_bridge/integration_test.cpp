/// The host moves grains under the impulses it is sent exactly as central differences do.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

TEST(Exchange, GrainOnALinearSpringFollowsCentralDifferencesWithoutLag) {
  Grains grains;
  add_grain(grains, Vec3(0.003, 0, 0), 0.001, 1150);
  DemInfill infill(grains, {rubber()}, settings_in_box(0.05));
  const double mass = infill.particles().mass[0], dt = 1e-5;
  const double stiffness = mass * std::pow(2 * 3.141592653589793 / (60 * dt), 2);  // 60 steps a period
  ContactImpulses contact = no_impulses(1);
  // x(t - dt) from v(t - dt/2) = 0.
  double before = 0.003, now = 0.003;
  for (int step = 0; step < 600; ++step) {
    contact.linear.set(0, Vec3(-stiffness * infill.particles().x[0] * dt, 0, 0));
    infill.advance(dt, 1, contact);
    const double next = 2 * now - before - stiffness / mass * now * dt * dt;
    before = now;
    now = next;
    ASSERT_NEAR(infill.particles().x[0], now, 1e-12 * 0.003 * (step + 1)) << "step " << step;
    ASSERT_NEAR(infill.particles().vx[0], (now - before) / dt, 1e-9 * 0.003 / dt) << "step " << step;
  }
}

TEST(Exchange, SubstepsSpreadTheImpulseEvenly) {
  Grains grains;
  add_grain(grains, Vec3(0, 0, 0), 0.001, 1150);
  DemInfill infill(grains, {rubber()}, settings_in_box(0.05, Vec3(0, 0, -9.81)));
  const double mass = infill.particles().mass[0], radius = 0.001, window = 4e-5;
  const Vec3 linear(2e-7, -1e-7, 3e-7), angular(1e-10, 2e-10, -3e-10);
  ContactImpulses contact = no_impulses(1);
  contact.linear.set(0, linear);
  contact.angular.set(0, angular);
  Vec3 x(0, 0, 0), v(0, 0, 0), w(0, 0, 0);
  for (int k = 0; k < 20; ++k) {
    infill.advance(window, 4, contact);
    for (int s = 0; s < 4; ++s) {
      v += linear / (4 * mass) + 1e-5 * Vec3(0, 0, -9.81);
      w += angular / (4 * 0.4 * mass * radius * radius);
      x += 1e-5 * v;
    }
    const ParticleView view = infill.particles();
    ASSERT_LT((view.position(0) - x).norm(), 1e-12 * x.norm());
    ASSERT_LT((view.velocity(0) - v).norm(), 1e-12 * v.norm());
    ASSERT_LT((view.spin(0) - w).norm(), 1e-12 * w.norm());
  }
  EXPECT_EQ(infill.particle_steps(), 80u);
}

TEST(Exchange, ImpulseGivenIsImpulseReceivedAndMomentumGained) {
  const ShakenBlock block(4);
  DemInfill infill(block.grains, block.materials, settings_in_box(0.05));
  block.shake(infill, 0.5);
  const auto momentum = [&] {
    const ParticleView view = infill.particles();
    Vec3 sum(0, 0, 0);
    for (std::size_t i = 0; i < view.size(); ++i) sum += view.mass[i] * view.velocity(i);
    return sum;
  };
  const double window = 2 * 0.5 * infill.stable_step();
  double inertia = 0;  // sum of the grains' own momenta, the scale of rounding
  for (std::size_t i = 0; i < block.grains.size(); ++i)
    inertia += infill.particles().mass[i] * infill.particles().velocity(i).norm();
  for (int k = 0; k < 200; ++k) {
    ContactImpulses contact = block.confine(infill, window);
    for (std::size_t i = 0; i < block.grains.size(); ++i)
      contact.linear.add(
          i, 1e-9 * Vec3(std::sin(static_cast<double>(i) + k), std::cos(2.0 * static_cast<double>(i)), 1));
    Vec3 given(0, 0, 0), scale(0, 0, 0);
    for (std::size_t i = 0; i < block.grains.size(); ++i) {
      given += contact.linear[i];
      scale += contact.linear[i].cwiseAbs();
    }
    const Vec3 before = momentum();
    const AdvanceReport report = infill.advance(window, 2, contact);
    for (int c = 0; c < 3; ++c) {
      ASSERT_NEAR(report.impulse_received[c], given[c], 1e-12 * scale[c]) << "window " << k;
      ASSERT_NEAR(report.impulse_scale[c], scale[c], 1e-12 * scale[c]);
    }
    // Grain-grain forces come in pairs, so the grains gain what they were given.
    ASSERT_LT((momentum() - before - given).norm(), 1e-12 * (inertia + scale.norm())) << "window " << k;
  }
  EXPECT_GT(infill.overlaps().contacts, 0u) << "the grains never touched: nothing was tested";
}

TEST(Exchange, MomentumOfFreeGrainsIsWhatTheyWereGiven) {
  const ShakenBlock block(4);
  DemInfill infill(block.grains, block.materials, settings_in_box(0.2));
  block.shake(infill, 0.5);
  const auto momentum = [&] {
    const ParticleView view = infill.particles();
    Vec3 sum(0, 0, 0);
    for (std::size_t i = 0; i < view.size(); ++i) sum += view.mass[i] * view.velocity(i);
    return sum;
  };
  const Vec3 start = momentum();
  double scale = 0;
  const ParticleView view = infill.particles();
  for (std::size_t i = 0; i < view.size(); ++i) scale += view.mass[i] * view.velocity(i).norm();
  const double window = 0.5 * infill.stable_step();
  Vec3 given(0, 0, 0);
  std::size_t touched = 0;
  for (int k = 0; k < 300; ++k) {
    ContactImpulses contact = no_impulses(block.grains.size());
    for (std::size_t i = 0; i < block.grains.size(); i += 3) {
      contact.linear.set(
          i, 1e-9 * Vec3(std::sin(static_cast<double>(i) + k), 1, std::cos(2.0 * static_cast<double>(i))));
      given += contact.linear[i];
    }
    infill.advance(window, 1, contact);
    if (k % 50 == 49) touched += infill.overlaps().contacts;
  }
  EXPECT_GT(touched, 0u) << "the grains never touched: nothing was tested";
  EXPECT_LT((momentum() - start - given).norm(), 1e-12 * (scale + given.norm()));
}

TEST(Exchange, DampingSlowsExponentially) {
  Grains grains;
  add_grain(grains, Vec3(0, 0, 0), 0.001, 1150);
  DemInfill infill(grains, {rubber()}, settings_in_box(0.05));
  infill.set_velocity(0, Vec3(0.3, -0.2, 0.1), Vec3(10, 20, 30));
  const double rate = 400, dt = 1e-5;
  infill.set_damping(rate);
  const ContactImpulses contact = no_impulses(1);
  for (int k = 0; k < 500; ++k) infill.advance(dt, 1, contact);
  const double expected = std::exp(-rate * 500 * dt);
  EXPECT_NEAR(infill.particles().vx[0] / 0.3, expected, 1e-4 * expected);
  EXPECT_NEAR(infill.particles().wz[0] / 30, expected, 1e-4 * expected);
}

TEST(Exchange, ChangedWindowKeepsARestingGrainAtRest) {
  Grains grains;
  add_grain(grains, Vec3(0, 0, 0), 0.001, 1150);
  DemInfill infill(grains, {rubber()}, settings_in_box(0.05, Vec3(0, 0, -9.81)));
  const double weight = infill.particles().mass[0] * 9.81;
  ContactImpulses contact = no_impulses(1);
  for (const double window : {1e-5, 2.5e-5, 0.4e-5, 1e-5})
    for (int k = 0; k < 10; ++k) {
      contact.linear.set(0, Vec3(0, 0, weight * window));
      infill.advance(window, 1, contact);
      ASSERT_NEAR(infill.particles().vz[0], 0, 1e-18);
    }
}

}  // namespace
}  // namespace tuft::dem::test

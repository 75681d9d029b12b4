// Forces of contact as they are listed are those that the coming window begins with, and listing them changes
// nothing.
#include <gtest/gtest.h>

#include "strip_case.h"

namespace tuft::coupler {
namespace {

/// Balls that fall on a held strip and, past its edge, on a floor.
Simulation falling_balls() {
  auto infill = std::make_unique<PointInfill>();
  infill->add(Vec3(0.003, 0.0005, 0.0025), Vec3(0.4, 0.1, -2), 0.002, 2e-5);
  infill->add(Vec3(-0.012, -0.0004, 0.003), Vec3(-0.2, 0.3, -1.4), 0.002, 4e-5);
  infill->add(Vec3(0.014, 0.02, 0.0005), Vec3(0.5, 0, -1.8), 0.002, 1e-5);
  StripCase setup;
  setup.clamp = true;
  setup.damping_ratio = 0.1;
  setup.gravity = Vec3(0, 0, -9.81);
  setup.window = 1e-6;
  setup.body_stiffness = 5e4;
  setup.floor = -0.002;
  return make(setup, std::move(infill));
}

TEST(ListedForces, AreThoseThatMoveTheParticlesInTheComingWindow) {
  Simulation s = falling_balls();
  constexpr double window = 1e-6;
  double largest = 0, worst = 0;
  std::array<bool, contact_kinds> seen{};
  for (int k = 0; k < 800; ++k) {
    const ContactNetwork network = s.boundary_contacts();
    const ParticleView before = s.infill().particles();
    std::vector<Vec3> velocity, force;
    for (std::size_t i = 0; i < before.size(); ++i) {
      velocity.push_back(before.velocity(i));
      force.push_back(before.mass[i] * Vec3(0, 0, -9.81));
    }
    for (std::size_t c = 0; c < network.size(); ++c) {
      const auto i = static_cast<std::size_t>(network.particle[c]);
      force[i] += network.force(c);
      seen[static_cast<std::size_t>(network.kind[c])] = true;
      EXPECT_LE(network.normal_force[c].dot(network.branch[c]), 0)
          << "contact pushes, or its dashpot eases it";
      EXPECT_NEAR(network.branch[c].norm(), 0.002, 1e-12);
      EXPECT_GT(network.overlap[c], 0);
    }
    s.advance_interval(window);
    ASSERT_EQ(s.step_plan().windows, 1);
    ASSERT_EQ(s.step_plan().carpet_substeps, 1);
    if (k == 0) continue;  // nothing had been looked for
    const ParticleView after = s.infill().particles();
    for (std::size_t i = 0; i < after.size(); ++i) {
      const Vec3 gained = after.mass[i] * (after.velocity(i) - velocity[i]) / window;
      worst = std::max(worst, (gained - force[i]).norm());
      largest = std::max(largest, force[i].norm());
    }
  }
  EXPECT_TRUE(seen[static_cast<std::size_t>(ContactKind::fibre)]);
  EXPECT_TRUE(seen[static_cast<std::size_t>(ContactKind::body)]);
  EXPECT_GT(largest, 1);
  EXPECT_LT(worst, 1e-8 * largest) << "of " << largest << " N; v/window loses digits";
}

TEST(ListedForces, ChangeNoBit) {
  Simulation listed = falling_balls(), plain = falling_balls();
  for (int k = 0; k < 800; ++k) {
    (void)listed.boundary_contacts();
    for (Simulation* s : {&listed, &plain}) s->advance_interval(1e-6);
  }
  ASSERT_GT(plain.particle_shell().energy().friction, 0);
  const ParticleView a = listed.infill().particles(), b = plain.infill().particles();
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.position(i), b.position(i));
    EXPECT_EQ(a.velocity(i), b.velocity(i));
  }
  EXPECT_EQ(listed.ledger().last().values(), plain.ledger().last().values());
}

}  // namespace
}  // namespace tuft::coupler

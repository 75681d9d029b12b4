/// Grains where they should not be, or among things unlike them. Each case ends finite, with its energy in
/// balance.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/verification/coupler/grain_case.h"

namespace tuft::coupler {
namespace {

using dem::test::add_grain;
using dem::test::grain_material;

/// A strip along x, both ends held.
fe::ShellMesh held_strip(int n, double length, double width, double thickness) {
  fe::ShellMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (const double side : {-0.5, 0.5}) {
      mesh.nodes.push_back(Vec3(length * (static_cast<double>(i) / n - 0.5), side * width, 0));
      mesh.clamped.push_back(i == 0 || i == n ? 1 : 0);
    }
  for (Index i = 0; i < n; ++i) {
    mesh.quads.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    mesh.thickness.push_back(thickness);
    mesh.material.push_back(0);
    mesh.surface.push_back(1);
  }
  mesh.surface_count = 2;
  return mesh;
}

double fastest_grain(const Simulation& s) {
  const ParticleView p = s.infill().particles();
  double fastest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) fastest = std::max(fastest, p.velocity(i).norm());
  return fastest;
}

TEST(GrainsBornInsideAFibre, AreLetOutSlowlyAndNotShot) {
  // Centres in the fibre's middle, at a tenth and at half of a radius above it.
  GrainCase setup;
  setup.mesh = held_strip(10, 0.04, 0.004, 1e-4);
  add_grain(setup.grains, Vec3(-0.01, 0, 0), 0.001, 1150);
  add_grain(setup.grains, Vec3(0, 0.0003, 0.0001), 0.001, 1150);
  add_grain(setup.grains, Vec3(0.01, 0, -0.0005), 0.001, 1150);
  setup.stiffness = 2000;
  setup.window = 2e-6;
  setup.release_time = 0.02;
  Simulation s = make(setup);
  double fastest = 0;
  for (int k = 0; k < 300; ++k) {
    s.advance_interval(1e-4);
    fastest = std::max(fastest, fastest_grain(s));
  }
  EXPECT_EQ(s.particle_shell().initial_overlap().pairs, 3u);
  EXPECT_NEAR(s.particle_shell().initial_overlap().largest, 0.001 + 0.5e-4, 1e-6);
  // Let go at once, a spring of 2000 N/m over 1.05 mm would give 4.8 mg some 20 m/s.
  EXPECT_LT(fastest, 1.0);
  EXPECT_GT(fastest, 0.01) << "nothing was let go";
  EXPECT_LT(s.ledger().largest_error(), 0.02);
  const ParticleView p = s.infill().particles();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(std::abs(p.z[i]), 0.0005) << i << " is still inside";
}

TEST(AGrainSqueezedBetweenAStiffRigAndASoftGrain, StaysThereAndGivesBackWhatItTook) {
  // Floor, soft rubber, a grain of sand twelve times smaller in mass and 200 times stiffer, a plate: pressed
  // by a radius of the sand and let up.
  GrainCase setup;
  setup.materials = {grain_material(5e6, 0.45, 1150, 1, 0), grain_material(1e9, 0.2, 2650, 1, 0)};
  add_grain(setup.grains, Vec3(0, 0, 0.002), 0.002, 1150);
  add_grain(setup.grains, Vec3(0, 0, 0.0045), 0.0005, 2650);
  setup.grains.material[1] = 1;
  setup.bodies.push_back(half_space("floor", Vec3(0, 0, 0), Vec3(0, 0, 1)));
  setup.bodies.push_back(half_space("plate", Vec3(0, 0, 0.005), Vec3(0, 0, -1)));
  setup.bodies[1].driven = true;
  setup.stiffness = 1e6;
  Simulation s = make(setup);
  double largest = 0, last = 0;
  for (int k = 0; k < 50; ++k) {
    s.drive_body(1, Vec3(0, 0, k < 25 ? -0.2 : 0.2));
    s.advance_interval(1e-4);
    last = s.interval_impulse()[1].z() / 1e-4;
    largest = std::max(largest, last);
  }
  // Hertz of sand on rubber, r* = 0.4 mm, Y* = 6.24 MPa, pressed in by nearly all of 0.5 mm, the floor's and
  // plate's springs in series hardly give: F = 4/3 Y* sqrt(r*) d^1.5 = 1.86 N.
  EXPECT_NEAR(largest, 1.86, 0.1);
  EXPECT_LT(std::abs(last), 0.05);
  EXPECT_LT(s.ledger().largest_error(), 0.01);
  EXPECT_NEAR(s.infill().particles().x[1], 0, 1e-6) << "squeezed out";
}

TEST(GrainsOfAThousandthOfTheMass, CarryABallAndBalanceItsEnergy) {
  // A ball ten times as large comes down on 25 grains on a floor.
  GrainCase setup;
  setup.materials = {grain_material(5e6, 0.45, 1150, 0.5, 0.5)};
  for (int j = -2; j <= 2; ++j)
    for (int i = -2; i <= 2; ++i) add_grain(setup.grains, Vec3(0.00205 * i, 0.00205 * j, 0.001), 0.001, 1150);
  add_grain(setup.grains, Vec3(0, 0, 0.0123), 0.01, 1150);
  setup.bodies.push_back(half_space("floor", Vec3(0, 0, 0), Vec3(0, 0, 1)));
  setup.body_friction = {0.5, 0.5, 0};
  setup.gravity = Vec3(0, 0, -9.81);
  setup.stiffness = 6e3;
  setup.damping_ratio = 0.2;
  std::vector<std::pair<Vec3, Vec3>> motion(26, {Vec3(0, 0, 0), Vec3(0, 0, 0)});
  motion[25].first = Vec3(0, 0, -1);
  Simulation s = make(setup, motion);
  EXPECT_NEAR(s.infill().particles().mass[25] / s.infill().particles().mass[0], 1000, 1e-6);
  double deepest = 1;
  for (int k = 0; k < 300; ++k) {
    s.advance_interval(1e-4);
    deepest = std::min(deepest, s.infill().particles().z[25]);
  }
  EXPECT_LT(s.ledger().largest_error(), 0.01);
  EXPECT_LT(s.momentum_error(), 1e-10);
  EXPECT_GT(deepest, 0.0105) << "grains were passed through";
  EXPECT_GT(s.infill().particles().vz[25], 0) << "carried, and thrown back";
}

TEST(AGrainFasterThanItsRadiusAStep, StopsTheRunWithItsNumberAndSpeed) {
  GrainCase setup;
  add_grain(setup.grains, Vec3(0, 0, 0), 0.001, 1150);
  add_grain(setup.grains, Vec3(0, 0.005, 0), 0.0005, 1150);
  Simulation s = make(setup, {{Vec3(50, 0, 0), Vec3(0, 0, 0)}, {Vec3(400, 0, 0), Vec3(0, 0, 0)}});
  try {
    s.advance_interval(5e-6);
    FAIL() << "went unseen";
  } catch (const RunError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("grain 1 of 0.5 mm radius is 400 m/s fast and moves"),
              std::string::npos)
        << message;
    EXPECT_NE(message.find("numerics.step_safety"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

TEST(ALayerWithoutGrains, IsAnInputErrorThatSaysWhatItWeighs) {
  std::vector<Material> materials{grain_material(5e6, 0.45, 1150, 0.5, 0.5)};
  materials[0].name = "sbr";
  materials[0].bulk_density = 500;
  materials[0].grain_shares = {{0, 1.0}};
  Turf turf;
  turf.layers = {{0, 0.01}, {0, 1e-6}};
  const DemOptions options;
  dem::PackingRequest request;
  request.size = {0.02, 0.02};
  request.turf = &turf;
  request.materials = &materials;
  request.options = &options;
  try {
    (void)dem::pack_grains(request);
    FAIL() << "a layer without a grain was packed";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("a layer of sbr that is 0.001 mm deep weighs 0.2 mg"), std::string::npos)
        << message;
    EXPECT_NE(message.find("make it deeper"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace tuft::coupler

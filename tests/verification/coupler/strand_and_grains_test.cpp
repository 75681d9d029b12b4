/// A strand round a body (capstan), and a closed box of shells with grains inside, free in space.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "free_box.h"
#include "point_infill.h"

namespace tuft::coupler {
namespace {

/// A strand over a bollard (axis z, radius 10 mm): up on the left, over the top by half a turn, down on the
/// right. Its left end is heavy and hangs, its right end is drawn down.
struct Capstan {
  static constexpr double bollard = 0.01, width = 0.0013, thickness = 5e-5, leg = 0.02, gravity = 500;
  static constexpr int turn = 32, down = 16;  ///< shells over the top, on each leg
  fe::ShellMesh mesh;
  double hanging = 0;  ///< kg

  explicit Capstan(double weight_density) {
    const double line = bollard + 0.5 * thickness;
    const auto add = [&](double x, double y) {
      const bool drawn = mesh.nodes.size() >= 2 * (turn + 2 * down);
      for (const double side : {-0.5, 0.5}) {
        mesh.nodes.push_back(Vec3(x, y, side * width));
        mesh.clamped.push_back(0);
        // Nothing leaves the plane of drawing; the drawn end is held along it.
        mesh.constraints.push_back(drawn ? 63 : 4 | 8 | 16);
      }
    };
    for (int i = 0; i < down; ++i) add(-line, -leg * (down - i) / down);
    for (int i = 0; i <= turn; ++i) {
      const double a = std::numbers::pi * (1 - static_cast<double>(i) / turn);
      add(line * std::cos(a), line * std::sin(a));
    }
    for (int i = 1; i <= down; ++i) add(line, -leg * i / down);
    const Index count = static_cast<Index>(mesh.nodes.size()) / 2 - 1;
    for (Index i = 0; i < count; ++i) {
      mesh.quads.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
      mesh.thickness.push_back(thickness);
      mesh.material.push_back(i == 0 ? 1 : 0);
      mesh.surface.push_back(1);
    }
    mesh.surface_count = 2;
    hanging = weight_density * width * thickness * leg / down;
  }
};

/// Mean force that draws the strand over what hangs on it.
double tension_ratio(double mu) {
  const Capstan capstan(4e6);
  SimulationParts parts;
  fe::CarpetOptions options;
  options.gravity = Vec3(0, -Capstan::gravity, 0);
  parts.carpet = std::make_unique<fe::Carpet>(
      capstan.mesh, std::vector{ShellMaterial{0.3e9, 0.3, 920}, ShellMaterial{0.3e9, 0.3, 4e6}}, options);
  const std::size_t nodes = capstan.mesh.nodes.size();
  // Drawn at a constant speed from the start, and so is what hangs: tension comes as the weight stretches the
  // strand.
  constexpr double speed = 0.1;
  for (std::size_t n = nodes - 2; n < nodes; ++n) parts.carpet->drive(n, Vec3(0, -speed, 0));
  parts.node_body.spring.assign(nodes, {2e4});
  parts.node_body.damping_ratio.assign(nodes, 0.2);
  parts.node_body.friction.assign(nodes, FrictionLaw{mu, mu, 0});
  parts.node_radius.assign(nodes, 0.5 * Capstan::thickness);
  auto far_away = std::make_unique<PointInfill>();
  far_away->add(Vec3(1, 1, 1), Vec3(0, 0, 0), 0.001, 1e-6);
  parts.particle_shell.stiffness = {1e3};
  parts.particle_shell.damping_ratio = {0};
  parts.particle_shell.friction.resize(1);
  parts.particle_body = {{{1e3}}, {0}, parts.particle_shell.friction};
  parts.infill = std::move(far_away);
  RigidBody body;
  body.name = "bollard";
  body.shape = Cylinder{Capstan::bollard, 0.1};
  body.position = Vec3(0, 0, -0.05);
  parts.bodies.push_back(body);
  parts.gravity = options.gravity;
  parts.numerics.energy_error_limit = 1e9;
  parts.skin = 5e-4;
  parts.release_overlap = false;
  Simulation s(std::move(parts));
  double sum = 0;
  int count = 0;
  for (int k = 0; k < 800; ++k) {
    s.advance_interval(1e-4);
    const double force = -(s.carpet().holding_force(nodes - 2) + s.carpet().holding_force(nodes - 1)).y();
    if (k < 200) continue;
    sum += force;
    ++count;
  }
  return sum / count / (capstan.hanging * Capstan::gravity);
}

TEST(Capstan, TensionGrowsByTheExponentialOfFrictionTimesAngle) {
  for (const double mu : {0.0, 0.2, 0.5}) {
    const double expected = std::exp(mu * std::numbers::pi);
    EXPECT_NEAR(tension_ratio(mu), expected, 0.02 * expected) << mu;
  }
}

TEST(GrainsInAFreeBoxOfShells, KeepMomentumAndEnergyOverTwentyThousandSteps) {
  GrainCase setup = grains_in_a_box(0, 1);
  setup.window = 5e-6;
  const FreeBox box = run_free_box(setup, 20000);
  EXPECT_LT(box.momentum_change, 1e-13);
  EXPECT_LT(box.largest_imbalance, 1e-12);
  EXPECT_LT(box.energy_error, 0.01);
  EXPECT_GT(box.energy.kinetic_carpet, 0) << "the box was hit";
}

TEST(GrainsInAFreeBoxOfShells, LoseTheirEnergyErrorAsTheStepFalls) {
  for (const double friction : {0.0, 0.5}) {
    GrainCase setup = grains_in_a_box(friction, 1);
    setup.window = 10e-6;
    const double coarse = run_free_box(setup, 2000).energy_error;
    setup.window = 2.5e-6;
    EXPECT_LT(run_free_box(setup, 8000).energy_error, 0.3 * coarse) << friction;
  }
}

TEST(GrainsInAFreeBoxOfShells, BalanceWhatFrictionAndDampingTake) {
  GrainCase setup = grains_in_a_box(0.5, 0.6);
  setup.damping_ratio = 0.1;
  setup.window = 2.5e-6;
  const FreeBox box = run_free_box(setup, 8000);
  EXPECT_LT(box.momentum_change, 1e-13);
  EXPECT_LT(box.energy_error, 0.005);
  EXPECT_GT(box.energy.contact_friction, 0);
  EXPECT_GT(box.energy.contact_damping, 0);
  EXPECT_GT(box.energy.dissipated_infill, 0);
}

}  // namespace
}  // namespace tuft::coupler

/// Large rotations, long runs: strips that whip, rings that turn.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <string>

#include "fe_carpet/stable_step.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

ShellMaterial slit_film() {
  return {2 * 0.3273e9 * 1.42, 0.42, 920, {{0.0663e9, 10}, {0.2e9, 1000}}};
}

struct Kind {
  const char* name;
  ShellSection section;
  ShellMaterial material;
};

std::vector<Kind> kinds() {
  ShellSection full, three_points;
  full.element = ElementKind::fully_integrated;
  three_points.element = ElementKind::fully_integrated;
  three_points.thickness_points = 3;
  return {{"one_point", {}, polyethylene()},
          {"fully_integrated", full, polyethylene()},
          {"one_point_viscoelastic", {}, slit_film()},
          {"fully_integrated_viscoelastic_three_points", three_points, slit_film()}};
}

class LargeMotion : public testing::TestWithParam<Kind> {};

TEST_P(LargeMotion, AStripWhippingForAHundredThousandStepsKeepsItsEnergyWithinAFifthOfAPercent) {
  const Kind& kind = GetParam();
  const Strip strip = make_strip({}, true);
  CarpetOptions options = no_gravity();
  options.section = kind.section;
  Carpet carpet(strip.mesh, {kind.material}, options);
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    if (!strip.mesh.clamped[n]) {
      const double share = strip.mesh.nodes.x[n] / strip.shape.length;
      carpet.set_velocity(n, 10 * share * Vec3(0, 0.2, 1), Vec3(0, 0, 0));
    }
  const double start = total(carpet.energy()), dt = 0.8 * carpet.stable_step();
  const Vec3Array load = no_load(strip.node_count());
  double largest_error = 0, largest_lift = 0;
  for (int i = 0; i < 100000; ++i) {
    carpet.step(dt, load);
    if (i % 100 != 0) continue;
    largest_error = std::max(largest_error, std::abs(total(carpet.energy()) / start - 1));
    const Vec3 tip = position(carpet, strip.node(strip.shape.along, 0));
    largest_lift = std::max(largest_lift, std::atan2(std::abs(tip.z()), tip.x()));
  }
  EXPECT_LT(largest_error, 2e-3);
  EXPECT_GT(largest_lift, std::numbers::pi / 3) << "it has not whipped";
}

TEST_P(LargeMotion, AWarpedElementTurnedOnceAroundHasNoStress) {
  const Kind& kind = GetParam();
  ShellMesh mesh = make_strip({0.003, 0.0013, 0.0001, 1, 1}, false).mesh;
  mesh.nodes.z[3] += 0.0003;
  CarpetOptions options = no_gravity();
  options.section = kind.section;
  Carpet carpet(mesh, {kind.material}, options);
  const Vec3 axis = Vec3(0.3, -0.8, 0.52).normalized(), centre(0.01, 0.02, -0.03);
  const double dt = 0.5 * carpet.stable_step();
  constexpr int steps = 3600;
  const double angle = 2 * std::numbers::pi / steps;
  const auto place = [&](std::size_t n, int i) -> Vec3 {
    return centre + Eigen::AngleAxisd(i * angle, axis) * (mesh.nodes[n] - centre);
  };
  // The loads are those that bend a free node's way into the circle: what is not on it has felt the element.
  for (std::size_t n = 0; n < 4; ++n)
    carpet.set_velocity(n, (place(n, 0) - place(n, -1)) / dt, angle / dt * axis);
  Vec3Array load = no_load(4);
  double farthest = 0;
  for (int i = 0; i < steps; ++i) {
    for (std::size_t n = 0; n < 4; ++n)
      load.set(n, carpet.nodes().mass[n] / (dt * dt) * (place(n, i + 1) - 2 * place(n, i) + place(n, i - 1)));
    carpet.step(dt, load);
    for (std::size_t n = 0; n < 4; ++n)
      farthest = std::max(farthest, (position(carpet, static_cast<Index>(n)) - place(n, i + 1)).norm());
  }
  EXPECT_LT(farthest, 1e-10 * 0.0013);
  // U = sigma^2/2E per volume.
  const double energy = std::abs(carpet.energy().strain) + std::abs(carpet.energy().hourglass);
  const double e = kind.material.young_modulus,
               stress = std::sqrt(2 * e * energy / (0.003 * 0.0013 * 0.0001));
  EXPECT_LT(stress, 1e-10 * e);
}

INSTANTIATE_TEST_SUITE_P(Of, LargeMotion, testing::ValuesIn(kinds()),
                         [](const auto& parameter) { return parameter.param.name; });

/// A strip pulled by a steady end load that relaxes with one term: its extension creeps from load over E at
/// once to load over E in the long run.
class Creep : public testing::TestWithParam<ShellSection> {};

TEST_P(Creep, GoesFromTheInstantaneousToTheLongTermModulus) {
  const double nu = 0.42, shear = 0.3273e9, bulk = 2 * shear * (1 + nu) / (3 * (1 - 2 * nu)), left = 0.1273e9;
  const ShellMaterial material{2 * shear * (1 + nu), nu, 920, {{shear - left, 1000}}};
  const Strip strip = make_strip({0.012, 0.0013, 0.0001, 4, 1}, true);
  CarpetOptions options = no_gravity();
  options.section = GetParam();
  options.damping = 2e4;
  Carpet carpet(strip.mesh, {material}, options);
  Vec3Array load = no_load(strip.node_count());
  const double stress = 1e5, force = stress * 0.0013 * 0.0001;
  for (Index j = 0; j <= 1; ++j) load.set(static_cast<std::size_t>(strip.node(4, j)), Vec3(force / 2, 0, 0));
  const double dt = 0.8 * carpet.stable_step();
  const auto extension = [&] { return position(carpet, strip.node(4, 0)).x() / 0.012 - 1; };
  for (double t = 0; t < 0.02; t += dt) carpet.step(dt, load);
  const double long_term = 9 * bulk * left / (3 * bulk + left);
  // The clamp holds the width of the first element, which stiffens the strip by some 3 %.
  EXPECT_NEAR(extension() * long_term / stress, 1, 0.05);
  EXPECT_GT(extension() * material.young_modulus / stress, 2.2);
}

INSTANTIATE_TEST_SUITE_P(Of, Creep,
                         testing::Values(ShellSection{ElementKind::one_point, 1},
                                         ShellSection{ElementKind::one_point, 3},
                                         ShellSection{ElementKind::fully_integrated, 1},
                                         ShellSection{ElementKind::fully_integrated, 3}),
                         [](const auto& p) { return name_of(p.param); });

}  // namespace
}  // namespace tuft::fe::test

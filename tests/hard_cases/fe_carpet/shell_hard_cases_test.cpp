// Shells where they are hardest to keep stable: each case ends well, or with one clear line.
#include <gtest/gtest.h>

#include <numbers>

#include "core/error.h"
#include "fe_carpet/relaxation.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

class ShellHardCase : public testing::TestWithParam<ElementKind> {
 protected:
  static CarpetOptions options() {
    CarpetOptions o = no_gravity();
    o.section.element = GetParam();
    return o;
  }
};

std::string failure_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const RunError& error) {
    return error.what();
  }
  return "";
}

double largest_energy_error(Carpet& carpet, double dt, int steps) {
  const Vec3Array load = no_load(carpet.nodes().x.size());
  const double start = total(carpet.energy());
  double largest = 0;
  for (int i = 0; i < steps; ++i) {
    carpet.step(dt, load);
    if (i % 50 == 0) largest = std::max(largest, std::abs(total(carpet.energy()) / start - 1));
  }
  return largest;
}

TEST_P(ShellHardCase, AnElementTurnedInsideOutIsNamed) {
  const Strip strip = make_strip({0.012, 0.003, 0.0001, 4, 1}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, options());
  // The two nodes of the tip have changed sides.
  carpet.set_position(static_cast<std::size_t>(strip.node(4, 0)), Vec3(0.012, 0.002, 0));
  carpet.set_position(static_cast<std::size_t>(strip.node(4, 1)), Vec3(0.012, 0.001, 0));
  const Vec3Array load = no_load(strip.node_count());
  const std::string text = failure_of([&] { carpet.step(0.5 * carpet.stable_step(), load); });
  EXPECT_NE(text.find("element 3"), std::string::npos) << text;
  EXPECT_NE(text.find("inside out"), std::string::npos) << text;
}

TEST_P(ShellHardCase, ASideOfZeroLengthIsRefusedWithItsElement) {
  Strip strip = make_strip({0.012, 0.003, 0.0001, 4, 1}, true);
  strip.mesh.nodes.set(static_cast<std::size_t>(strip.node(2, 1)),
                       strip.mesh.nodes[static_cast<std::size_t>(strip.node(2, 0))]);
  try {
    const Carpet carpet(strip.mesh, {polyethylene()}, options());
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("element 1"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("coincide"), std::string::npos) << error.what();
  }
}

TEST_P(ShellHardCase, NeedleElementsOfAspectTwoHundredKeepTheirEnergy) {
  const Strip strip = make_strip({0.04, 0.0001, 0.00005, 2, 1}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, options());
  for (std::size_t n = 2; n < strip.node_count(); ++n)
    carpet.set_velocity(n, Vec3(0.01, 0.3, 0.5) * strip.mesh.nodes.x[n] / 0.04, Vec3(0, 0, 0));
  EXPECT_LT(largest_energy_error(carpet, 0.8 * carpet.stable_step(), 200000), 2e-3);
}

TEST_P(ShellHardCase, AStripFoldedBackOnItselfKeepsItsEnergy) {
  const Strip strip = make_strip({0.06, 0.0013, 0.0001, 20, 1}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, options());
  // The outer half comes back over the inner one.
  for (std::size_t n = 2; n < strip.node_count(); ++n) {
    const double beyond = std::max(0.0, strip.mesh.nodes.x[n] - 0.02);
    carpet.set_velocity(n, Vec3(-250 * beyond, 0, 350 * beyond), Vec3(0, 0, 0));
  }
  const Vec3Array load = no_load(strip.node_count());
  const double dt = 0.8 * carpet.stable_step(), start = total(carpet.energy());
  double largest = 0, farthest_back = 0;
  for (int i = 0; i < 20000; ++i) {
    carpet.step(dt, load);
    largest = std::max(largest, std::abs(total(carpet.energy()) / start - 1));
    const double tip = position(carpet, strip.node(20, 0)).x(),
                 middle = position(carpet, strip.node(10, 0)).x();
    farthest_back = std::max(farthest_back, middle - tip);
  }
  EXPECT_LT(largest, 2e-3);
  EXPECT_GT(farthest_back, 0.01) << "it has not folded";
}

TEST_P(ShellHardCase, AFollowerLoadAtFiveTimesFlutterBalancesItsEnergy) {
  // A compressive end load that stays along the strip (Beck's column) flutters beyond 20.05 E I / L^2: no
  // rest exists, the energy must still balance.
  const Strip strip = make_strip({0.06, 0.0013, 0.0001, 20, 1}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, options());
  const double bending = 0.5e9 * 0.0013 * 1e-12 / 12, force = 5 * 20.05 * bending / (0.06 * 0.06);
  const double dt = 0.8 * carpet.stable_step();
  Vec3Array load = no_load(strip.node_count());
  carpet.set_velocity(static_cast<std::size_t>(strip.node(20, 0)), Vec3(0, 0, 0.01), Vec3(0, 0, 0));
  const double start = total(carpet.energy());
  double largest = 0;
  for (int i = 0; i < 60000; ++i) {
    const Vec3 along =
        (position(carpet, strip.node(20, 0)) - position(carpet, strip.node(19, 0))).normalized();
    for (Index j = 0; j <= 1; ++j)
      load.set(static_cast<std::size_t>(strip.node(20, j)), -0.5 * force * along);
    carpet.step(dt, load);
    const CarpetEnergy e = carpet.energy();
    // The load comes at once: at first its sound, a few percent of next to nothing, is most of the energy.
    if (i > 25000) largest = std::max(largest, std::abs(total(e) - start) / (e.kinetic + e.strain));
  }
  EXPECT_GT(carpet.energy().kinetic, 1e5 * start) << "it does not flutter";
  EXPECT_LT(largest, 5e-3);
}

TEST_P(ShellHardCase, ATipAtFiftyMetresPerSecondKeepsItsEnergy) {
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, options());
  for (std::size_t n = 2; n < strip.node_count(); ++n)
    carpet.set_velocity(n, 50 * strip.mesh.nodes.x[n] / 0.06 * Vec3(0, 0, 1), Vec3(0, 0, 0));
  EXPECT_LT(largest_energy_error(carpet, 0.8 * carpet.stable_step(), 30000), 5e-3);
}

TEST_P(ShellHardCase, NeighboursWhoseThicknessesAreAThousandToOneKeepTheirEnergy) {
  Strip strip = make_strip({0.02, 0.01, 0.00001, 8, 4}, true);
  for (std::size_t e = 0; e < strip.mesh.quads.size(); e += 2) strip.mesh.thickness[e] = 0.01;
  Carpet carpet(strip.mesh, {polyethylene()}, options());
  for (std::size_t n = 5; n < strip.node_count(); ++n)
    carpet.set_velocity(n, Vec3(0.05, 0.02, 0.2) * strip.mesh.nodes.x[n] / 0.02, Vec3(0, 0, 0));
  EXPECT_LT(largest_energy_error(carpet, 0.8 * carpet.stable_step(), 20000), 0.02);
}

INSTANTIATE_TEST_SUITE_P(Of, ShellHardCase,
                         testing::Values(ElementKind::one_point, ElementKind::fully_integrated),
                         [](const auto& p) { return name_of(p.param); });

}  // namespace
}  // namespace tuft::fe::test

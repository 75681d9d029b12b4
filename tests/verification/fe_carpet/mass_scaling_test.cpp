/// Selective mass scaling: what is added, what it buys, and what it must leave alone.
#include <gtest/gtest.h>

#include "core/error.h"
#include "fe_carpet/relaxation.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

/// A strip whose columns get narrower towards its end: a few small elements bound the step.
Strip graded_strip(bool clamp_root) {
  Strip strip = make_strip({0.03, 0.004, 0.0002, 12, 3}, clamp_root);
  for (std::size_t n = 0; n < strip.node_count(); ++n) {
    double& x = strip.mesh.nodes.x[n];
    x = 0.03 * std::sin(1.4 * x / 0.03);
  }
  return strip;
}

CarpetOptions scaled(CarpetOptions options, double limit) {
  options.mass_scaling_limit = limit;
  return options;
}

class MassScalingOf : public testing::TestWithParam<ElementKind> {
 protected:
  static CarpetOptions of_kind(CarpetOptions options) {
    options.section.element = GetParam();
    return options;
  }
  static CarpetOptions weightless() { return of_kind(no_gravity()); }
  static CarpetOptions under_weight() { return of_kind({}); }
};

INSTANTIATE_TEST_SUITE_P(, MassScalingOf,
                         testing::Values(ElementKind::one_point, ElementKind::fully_integrated),
                         [](const auto& p) { return name_of(p.param); });

void shake(Carpet& carpet) {
  const NodeView nodes = carpet.nodes();
  for (std::size_t n = 0; n < nodes.x.size(); ++n) {
    if (nodes.clamped[n]) continue;
    const auto wave = [n](double k) { return 0.01 * std::sin(k * static_cast<double>(n) + k); };
    carpet.set_velocity(n, Vec3(wave(1.1), wave(2.3), wave(3.7)), Vec3(wave(0.7), wave(1.9), wave(2.9)));
  }
}

double mass_of(const Carpet& carpet) {
  double sum = 0;
  for (const double m : carpet.nodes().mass) sum += m;
  return sum;
}

TEST_P(MassScalingOf, AddsNoMoreThanTheLimitAndNearlyAllOfItAndTheStepIsWhatItSays) {
  const Strip strip = graded_strip(true);
  const Carpet plain(strip.mesh, {polyethylene()}, weightless());
  double step_before = plain.stable_step();
  for (const double limit : {0.001, 0.01, 0.05, 0.3, 0.99}) {
    const Carpet carpet(strip.mesh, {polyethylene()}, scaled(weightless(), limit));
    const MassScaling& s = carpet.mass_scaling();
    EXPECT_LE(s.share(), limit);
    EXPECT_GT(s.share(), limit * (1 - 1e-9));
    EXPECT_NEAR(s.true_mass, mass_of(plain), 1e-12 * s.true_mass);
    EXPECT_NEAR(s.true_mass + s.added_mass, mass_of(carpet), 1e-12 * s.true_mass);
    EXPECT_DOUBLE_EQ(s.step_before, plain.stable_step());
    EXPECT_NEAR(carpet.stable_step() / s.step_after, 1, 1e-12);
    EXPECT_GT(carpet.stable_step(), step_before) << limit;
    step_before = carpet.stable_step();
  }
}

TEST_P(MassScalingOf, OfFewElementsGainsMoreThanOfEqualOnesWhichNeedItEverywhere) {
  constexpr double limit = 0.1;
  const Strip equal = make_strip({0.03, 0.004, 0.0002, 12, 3}, true), graded = graded_strip(true);
  const Carpet all(equal.mesh, {polyethylene()}, scaled(weightless(), limit));
  EXPECT_EQ(all.mass_scaling().elements, 36);
  EXPECT_NEAR(all.mass_scaling().step_after / all.mass_scaling().step_before, std::sqrt(1 + limit), 1e-9);
  const Carpet few(graded.mesh, {polyethylene()}, scaled(weightless(), limit));
  EXPECT_LT(few.mass_scaling().elements, 36);
  EXPECT_GT(few.mass_scaling().step_after / few.mass_scaling().step_before, 1.2);
}

TEST_P(MassScalingOf, IsStableAtNineTenthsOfItsStepOverTwentyThousandSteps) {
  for (const HourglassControl hourglass : {HourglassControl::stiffness, HourglassControl::viscous}) {
    const Strip strip = graded_strip(true);
    CarpetOptions options = scaled(weightless(), 0.3);
    options.section.hourglass = hourglass;
    Carpet carpet(strip.mesh, {polyethylene()}, options);
    shake(carpet);
    const double start = carpet.energy().kinetic, dt = 0.9 * carpet.stable_step();
    EXPECT_GT(dt, 1.2 * carpet.mass_scaling().step_before) << "or nothing is tested";
    const Vec3Array load = no_load(strip.node_count());
    double largest = 0;
    for (int i = 0; i < 20000; ++i) {
      carpet.step(dt, load);
      const CarpetEnergy e = carpet.energy();
      largest = std::max(largest, (e.kinetic + e.strain + e.hourglass) / start);
    }
    EXPECT_LT(largest, 10);
  }
}

TEST_P(MassScalingOf, KeepsTheMomentumOfTheScaledMasses) {
  const Strip strip = graded_strip(false);
  Carpet carpet(strip.mesh, {polyethylene()}, scaled(weightless(), 0.3));
  shake(carpet);
  const auto momentum = [&] {
    const NodeView v = carpet.nodes();
    Vec3 sum(0, 0, 0);
    for (std::size_t n = 0; n < v.x.size(); ++n) sum += v.mass[n] * Vec3(v.vx[n], v.vy[n], v.vz[n]);
    return sum;
  };
  const Vec3 before = momentum();
  const double scale = 0.01 * mass_of(carpet), dt = 0.8 * carpet.stable_step();
  const Vec3Array load = no_load(strip.node_count());
  for (int i = 0; i < 5000; ++i) carpet.step(dt, load);
  EXPECT_LT((momentum() - before).norm(), 1e-11 * scale);
}

TEST_P(MassScalingOf, LetsAFreePieceFallAtGTimesTrueOverScaledMass) {
  // Weight is the true one and moves the added mass too.
  const Strip strip = make_strip({0.03, 0.004, 0.0002, 12, 3}, false);
  CarpetOptions options = under_weight();
  options.mass_scaling_limit = 0.25;
  Carpet carpet(strip.mesh, {polyethylene()}, options);
  const double dt = 0.8 * carpet.stable_step();
  const Vec3Array load = no_load(strip.node_count());
  constexpr int steps = 500;
  for (int i = 0; i < steps; ++i) carpet.step(dt, load);
  const NodeView v = carpet.nodes();
  for (std::size_t n = 0; n < v.x.size(); ++n) EXPECT_NEAR(v.vz[n] / (-9.81 / 1.25 * steps * dt), 1, 1e-9);
  const CarpetEnergy e = carpet.energy();
  EXPECT_NEAR((e.kinetic + e.gravity_potential) / e.kinetic, 0, 1e-2);  // first kick is a whole one: 1/n
}

TEST_P(MassScalingOf, LeavesStaticWeightAndDeflectionAsTheyAre) {
  const Strip strip = graded_strip(true);
  std::array<double, 2> sag{};
  for (const int with : {0, 1}) {
    CarpetOptions options = under_weight();
    options.mass_scaling_limit = 0.5 * with;
    Carpet carpet(strip.mesh, {polyethylene()}, options);
    const LoadAtShare no_forces = [](const NodeView&, double, Vec3Array&, Vec3Array&) {};
    ASSERT_TRUE(relax(carpet, no_forces, {}).at_rest);
    sag[static_cast<std::size_t>(with)] = position(carpet, strip.node(12, 1)).z();
  }
  EXPECT_LT(sag[0], -1e-5);
  EXPECT_NEAR(sag[1] / sag[0], 1, 1e-3);
}

TEST_P(MassScalingOf, LeavesContactStiffnessAsItIs) {
  const Strip strip = graded_strip(true);
  const Carpet plain(strip.mesh, {polyethylene()}, weightless());
  const Carpet carpet(strip.mesh, {polyethylene()}, scaled(weightless(), 0.3));
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    EXPECT_NEAR(carpet.node_contact_stiffness()[n] / plain.node_contact_stiffness()[n], 1, 1e-12);
}

TEST_P(MassScalingOf, OfZeroIsTheSameToTheBitAsNoneAskedFor) {
  const Strip strip = graded_strip(true);
  Carpet off(strip.mesh, {polyethylene()}, under_weight()),
      zero(strip.mesh, {polyethylene()}, scaled(under_weight(), 0));
  EXPECT_EQ(zero.mass_scaling().added_mass, 0);
  shake(off);
  shake(zero);
  const Vec3Array load = no_load(strip.node_count());
  const double dt = 0.8 * off.stable_step();
  ASSERT_EQ(dt, 0.8 * zero.stable_step());
  for (int i = 0; i < 500; ++i) {
    off.step(dt, load);
    zero.step(dt, load);
  }
  for (std::size_t n = 0; n < strip.node_count(); ++n) {
    EXPECT_EQ(off.nodes().x[n], zero.nodes().x[n]);
    EXPECT_EQ(off.nodes().vz[n], zero.nodes().vz[n]);
  }
}

TEST_P(MassScalingOf, RefusesAShareOfOneOrMore) {
  const Strip strip = graded_strip(true);
  for (const double limit : {1.0, -0.1, std::nan("")}) try {
      const Carpet carpet(strip.mesh, {polyethylene()}, scaled(weightless(), limit));
      ADD_FAILURE() << limit;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("mass_scaling_limit is"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace tuft::fe::test

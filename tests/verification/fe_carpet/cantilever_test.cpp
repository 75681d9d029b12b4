/// A strip clamped at one end against Euler-Bernoulli beam theory: static deflection, first frequency,
/// energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

constexpr double first_root = 1.8751040687119611;         // cosh(x) cos(x) = -1
constexpr double first_shape_ratio = 0.7340955137589128;  // (cosh + cos)/(sinh + sin) at the root

/// Of Poisson's ratio 0, so that a narrow strip is a beam whatever its width.
ShellMaterial beam_material() {
  return {0.5e9, 0, 920};
}

struct Beam {
  explicit Beam(const StripShape& s) {
    const ShellMaterial m = beam_material();
    stiffness = m.young_modulus * s.width * s.thickness * s.thickness * s.thickness / 12;
    length = s.length;
    frequency = first_root * first_root * std::sqrt(stiffness / (m.density * s.width * s.thickness)) /
                (s.length * s.length);
  }
  double stiffness, length, frequency;  // N m^2, m, rad/s
};

StripShape short_strip(Index along) {
  return {0.030, 0.0013, 0.0003, along, 1};
}

void pull_tip(const Strip& strip, double force, Vec3Array& load) {
  for (Index j = 0; j <= strip.shape.across; ++j)
    load.z[static_cast<std::size_t>(strip.node(strip.shape.along, j))] = force / (strip.shape.across + 1);
}

/// Tip deflection over that of the beam, P L^3 / 3EI, by dynamic relaxation near critical damping.
double relative_static_deflection(const StripShape& shape) {
  const Strip strip = make_strip(shape, true);
  const Beam beam(shape);
  CarpetOptions options = no_gravity();
  options.damping = 2 * beam.frequency;
  Carpet carpet(strip.mesh, {beam_material()}, options);
  const double expected = 0.005 * shape.length;
  Vec3Array load = no_load(strip.node_count());
  pull_tip(strip, expected * 3 * beam.stiffness / std::pow(shape.length, 3), load);
  const double dt = 0.9 * carpet.stable_step();
  for (double t = 0; t < 12 / beam.frequency; t += dt) carpet.step(dt, load);
  EXPECT_LT(carpet.energy().kinetic, 1e-6 * carpet.energy().strain) << "not yet at rest";
  return position(carpet, strip.node(shape.along, 0)).z() / expected;
}

/// Gives the nodes the velocity of the first mode; returns the velocity at the tip.
void start_first_mode(const Strip& strip, double tip_velocity, Carpet& carpet) {
  const double beta = first_root / strip.shape.length, r = first_shape_ratio;
  for (std::size_t n = 0; n < strip.node_count(); ++n) {
    if (strip.mesh.clamped[n]) continue;
    const double x = beta * strip.mesh.nodes.x[n];
    const double shape = std::cosh(x) - std::cos(x) - r * (std::sinh(x) - std::sin(x));
    const double slope = beta * (std::sinh(x) + std::sin(x) - r * (std::cosh(x) - std::cos(x)));
    carpet.set_velocity(n, {0, 0, tip_velocity / 2 * shape}, {0, -tip_velocity / 2 * slope, 0});
  }
}

struct Swing {
  double frequency = 0;             // rad/s
  double largest_energy_error = 0;  // relative to the total
  CarpetEnergy last;
};

Swing swing(const StripShape& shape, int periods, int thickness_points = 3,
            ElementKind element = ElementKind::one_point) {
  const Strip strip = make_strip(shape, true);
  const Beam beam(shape);
  CarpetOptions options = no_gravity();
  options.section.thickness_points = thickness_points;
  options.section.element = element;
  Carpet carpet(strip.mesh, {beam_material()}, options);
  start_first_mode(strip, 0.01 * shape.length * beam.frequency, carpet);
  const double dt = 0.9 * carpet.stable_step(), start = total(carpet.energy());
  const Vec3Array load = no_load(strip.node_count());
  Swing result;
  std::vector<double> crossings;
  double before = 0, t = 0;
  while (crossings.size() < static_cast<std::size_t>(2 * periods) + 1) {
    carpet.step(dt, load);
    t += dt;
    const double now = position(carpet, strip.node(shape.along, 0)).z();
    if (before * now < 0) crossings.push_back(t - dt * now / (now - before));
    before = now;
    result.largest_energy_error =
        std::max(result.largest_energy_error, std::abs(total(carpet.energy()) / start - 1));
  }
  result.frequency = 2 * std::numbers::pi * periods / (crossings.back() - crossings.front());
  result.last = carpet.energy();
  return result;
}

TEST(CantileverStrip, TipDeflectionMatchesBeamTheoryWithinTwoPercent) {
  EXPECT_NEAR(relative_static_deflection(short_strip(10)), 1, 0.02);
}

TEST(CantileverStrip, TipDeflectionConvergesWithTheSquareOfTheElementLength) {
  // One-point elements of constant curvature: the error is 1/(4 n^2), less a little shear compliance.
  const double coarse = 1 - relative_static_deflection(short_strip(4));
  const double fine = 1 - relative_static_deflection(short_strip(8));
  EXPECT_NEAR(coarse / fine, 4, 0.4);
  EXPECT_NEAR(coarse, 1 / (4.0 * 4 * 4), 1e-3);
}

TEST(CantileverStrip, FirstFrequencyMatchesBeamTheoryWithinTwoPercent) {
  EXPECT_NEAR(swing(short_strip(10), 3).frequency / Beam(short_strip(10)).frequency, 1, 0.02);
}

TEST(CantileverStrip, FibreOfThePublishedMeshHasTheBeamsFirstFrequencyWithinTwoPercent) {
  const StripShape fibre{0.063, 0.0013, 0.0001, 21, 1};
  EXPECT_NEAR(swing(fibre, 1).frequency / Beam(fibre).frequency, 1, 0.02);
}

TEST(CantileverStrip, FrequencyErrorFallsToAThirdWhenElementsAreHalved) {
  // Between second order, as the deflection, and first order, as the scaled rotary inertia A/5 of a strip of
  // given width.
  const double exact = Beam(short_strip(1)).frequency;
  const double coarse = 1 - swing(short_strip(5), 2).frequency / exact;
  const double fine = 1 - swing(short_strip(10), 2).frequency / exact;
  EXPECT_GT(coarse / fine, 2.8);
  EXPECT_LT(coarse / fine, 4.2);
}

TEST(CantileverStrip, FreeVibrationKeepsItsEnergyWithinATenthOfAPercentOverThirtyPeriods) {
  const Swing result = swing(short_strip(10), 30);
  EXPECT_LT(result.largest_energy_error, 1e-3);
  EXPECT_LT(result.last.hourglass, 1e-6 * (result.last.kinetic + result.last.strain));
}

TEST(CantileverStrip, BendsAlikeToRoundingWithTwoToFivePointsAndExactResultantsWithBothElements) {
  for (const ElementKind element : {ElementKind::one_point, ElementKind::fully_integrated}) {
    const Swing resultants = swing(short_strip(5), 1, 1, element);
    for (const int points : {2, 3, 4, 5})
      EXPECT_NEAR(swing(short_strip(5), 1, points, element).frequency / resultants.frequency, 1, 1e-9)
          << points << " points" << (element == ElementKind::one_point ? ", one point" : ", 2 x 2");
  }
}

TEST(CantileverStrip, LoadsWorkTurnsIntoKineticAndStrainEnergy) {
  const StripShape shape = short_strip(10);
  const Strip strip = make_strip(shape, true);
  Carpet carpet(strip.mesh, {beam_material()}, no_gravity());
  const double dt = 0.9 * carpet.stable_step(), period = 2 * std::numbers::pi / Beam(shape).frequency;
  const double force = 0.01 * shape.length * 3 * Beam(shape).stiffness / std::pow(shape.length, 3);
  Vec3Array load = no_load(strip.node_count());
  double largest_work = 0, largest_error = 0;
  for (double t = 0; t < 2 * period; t += dt) {
    // Switched on and off: a load that the strip follows (1 period) and then swings without.
    pull_tip(strip, t < period ? force * std::pow(std::sin(std::numbers::pi * t / period), 2) : 0.0, load);
    carpet.step(dt, load);
    const CarpetEnergy e = carpet.energy();
    largest_work = std::max(largest_work, e.external_work);
    largest_error = std::max(largest_error, std::abs(e.kinetic + e.strain + e.hourglass - e.external_work));
  }
  EXPECT_GT(largest_work, 0);
  EXPECT_LT(largest_error, 1e-3 * largest_work);
}

TEST(CantileverStrip, DampingAccountsForWhatIsLost) {
  const StripShape shape = short_strip(10);
  const Strip strip = make_strip(shape, true);
  CarpetOptions options = no_gravity();
  options.damping = 0.5 * Beam(shape).frequency;
  Carpet carpet(strip.mesh, {beam_material()}, options);
  start_first_mode(strip, 0.01 * shape.length * Beam(shape).frequency, carpet);
  const double start = total(carpet.energy()), dt = 0.9 * carpet.stable_step();
  const Vec3Array load = no_load(strip.node_count());
  for (double t = 0; t < 20 / Beam(shape).frequency; t += dt) carpet.step(dt, load);
  const CarpetEnergy e = carpet.energy();
  EXPECT_LT(e.kinetic + e.strain, 1e-3 * start);
  EXPECT_NEAR(e.damping / start, 1, 2e-3);
  EXPECT_NEAR(total(e) / start, 1, 1e-4);
}

TEST(CantileverStrip, WeightSagsTheStripAsBeamTheorySays) {
  const StripShape shape = short_strip(10);
  const Strip strip = make_strip(shape, true);
  const Beam beam(shape);
  CarpetOptions options;
  options.damping = 2 * beam.frequency;
  Carpet carpet(strip.mesh, {beam_material()}, options);
  const double dt = 0.9 * carpet.stable_step(), start = total(carpet.energy());
  const Vec3Array load = no_load(strip.node_count());
  for (double t = 0; t < 12 / beam.frequency; t += dt) carpet.step(dt, load);
  const double weight = 9.81 * beam_material().density * shape.width * shape.thickness;  // N/m
  const double sag = weight * std::pow(shape.length, 4) / (8 * beam.stiffness);
  EXPECT_NEAR(position(carpet, strip.node(shape.along, 0)).z() / -sag, 1, 0.02);
  EXPECT_NEAR(total(carpet.energy()), start, 1e-4 * carpet.energy().strain);
}

/// Tip displacement at rest under tip loads on the two corners, by dynamic relaxation at `frequency`.
std::array<Vec3, 2> tip_at_rest(const Strip& strip, const std::array<Vec3, 2>& tip_load, double frequency) {
  CarpetOptions options = no_gravity();
  options.damping = 2 * frequency;
  Carpet carpet(strip.mesh, {beam_material()}, options);
  Vec3Array load = no_load(strip.node_count());
  const std::array<Index, 2> tip{strip.node(strip.shape.along, 0), strip.node(strip.shape.along, 1)};
  for (std::size_t i = 0; i < 2; ++i) load.set(static_cast<std::size_t>(tip[i]), tip_load[i]);
  const double dt = 0.9 * carpet.stable_step();
  for (double t = 0; t < 12 / frequency; t += dt) carpet.step(dt, load);
  EXPECT_LT(carpet.energy().kinetic, 1e-6 * (carpet.energy().strain + carpet.energy().hourglass))
      << "not yet at rest";
  return {position(carpet, tip[0]) - strip.mesh.nodes[static_cast<std::size_t>(tip[0])],
          position(carpet, tip[1]) - strip.mesh.nodes[static_cast<std::size_t>(tip[1])]};
}

// In strips one element wide, bending in the strip's plane and torsion are modes that one point in the plane
// does not see: what resists them is the hourglass control, which is that of the fully integrated element.

TEST(OneElementWideStrip, BendsEdgewiseAsBeamTheorySays) {
  const StripShape shape = short_strip(10);
  const Strip strip = make_strip(shape, true);
  const double b = shape.width, beam_stiffness = 0.5e9 * shape.thickness * b * b * b / 12;
  const double deflection = 0.005 * shape.length;
  const double force = deflection * 3 * beam_stiffness / std::pow(shape.length, 3);
  const double frequency = Beam(shape).frequency * b / shape.thickness;
  const auto tip = tip_at_rest(strip, {Vec3(0, force / 2, 0), Vec3(0, force / 2, 0)}, frequency);
  EXPECT_NEAR(tip[0].y() / deflection, 1, 0.02);
}

TEST(OneElementWideStrip, TwistsAsSaintVenantSays) {
  const StripShape shape = short_strip(10);
  const Strip strip = make_strip(shape, true);
  const double a = shape.length / shape.along, b = shape.width;
  const double torsion = 0.25e9 * b * std::pow(shape.thickness, 3) / 3, angle = 0.02;
  const double couple = angle * torsion / shape.length;
  // Masses lumped at half a width from the axis, and the scaled rotary inertia.
  const double polar_inertia = 920 * shape.thickness * b * (b * b / 4 + a * b / 5);
  const double frequency = std::numbers::pi / 2 / shape.length * std::sqrt(torsion / polar_inertia);
  const auto tip = tip_at_rest(strip, {Vec3(0, 0, -couple / b), Vec3(0, 0, couple / b)}, frequency);
  EXPECT_NEAR((tip[1].z() - tip[0].z()) / b / angle, 1, 0.05);
}

}  // namespace
}  // namespace tuft::fe::test

/// The stable step against the true limit of the linear mesh, 2 / (largest frequency), found by power
/// iteration.
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/verification/fe_carpet/linear_model.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

struct Case {
  const char* name;
  ShellMesh mesh;
  std::vector<ShellMaterial> materials;
  int iterations;
  double tightest;  // the estimate is at least this share of the true limit
};

ShellMesh turf(double backing_thickness) {
  CarpetDesign d;
  d.gauge = 0.008;
  d.stitch_spacing = 0.006;
  d.strands_per_tuft = 3;
  d.pile_length = 0.015;
  d.strand_width = 0.0013;
  d.strand_thickness = 0.0001;
  d.lean = 0.3;
  d.fan_out = 0.2;
  d.element_length = 0.003;
  d.backing_thickness = backing_thickness;
  d.backing_element = 0.004;
  return generate_carpet(d, {0.03, 0.03}, 3, true);
}

ShellMesh distorted(ShellMesh mesh) {
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    mesh.nodes.add(n,
                   2e-4 * Vec3(std::sin(7.0 * static_cast<double>(n)), std::sin(5.0 * static_cast<double>(n)),
                               std::sin(3.0 * static_cast<double>(n))));
  return mesh;
}

std::vector<Case> cases() {
  const ShellMaterial fibre = polyethylene(), backing{0.2e9, 0.3, 900}, stiff_backing{2e9, 0.3, 900},
                      no_poisson{0.5e9, 0, 920}, almost_rubber{0.5e9, 0.49, 920};
  const StripShape square{0.02, 0.02, 0.0002, 8, 8}, thick{0.02, 0.02, 0.004, 8, 8};
  return {{"fibre", make_strip({0.03, 0.0013, 0.0001, 10, 1}, true).mesh, {fibre}, 2000, 0.95},
          {"backing patch, squares", make_strip(square, true).mesh, {backing}, 2000, 0.85},
          {"squares, Poisson's ratio 0", make_strip(square, false).mesh, {no_poisson}, 2000, 0.9},
          {"squares, Poisson's ratio 0.49", make_strip(square, false).mesh, {almost_rubber}, 2000, 0.75},
          {"thick squares", make_strip(thick, true).mesh, {backing}, 2000, 0.8},
          {"distorted and warped", distorted(make_strip(square, false).mesh), {fibre}, 2000, 0.7},
          {"one element", make_strip({0.003, 0.0013, 0.0001, 1, 1}, false).mesh, {fibre}, 2000, 0.99},
          {"turf, thick soft backing", turf(0.001), {backing, fibre}, 1000, 0.8},
          {"turf, thin stiff backing", turf(0.0001), {stiff_backing, fibre}, 1000, 0.6}};
}

TEST(StableStep, IsBelowTheTrueLimitAndNotFarBelow) {
  for (const Case& c : cases()) {
    const Carpet carpet(c.mesh, c.materials, no_gravity());
    const double limit =
        2 / std::sqrt(LinearModel(c.mesh, c.materials, {}).largest_frequency_squared(c.iterations));
    const double share = carpet.stable_step() / limit;
    RecordProperty(c.name, std::to_string(share));
    EXPECT_LE(share, 1 + 1e-9) << c.name;
    EXPECT_GE(share, c.tightest) << c.name;
  }
}

TEST(StableStep, MembraneGovernsWhateverTheShapeAndPoissonsRatio) {
  // That is what the scaled rotary inertia is for.
  for (const double nu : {0.0, 0.2, 0.4, 0.49})
    for (const double aspect : {0.05, 0.3, 1.0, 2.3, 20.0})
      for (const double thickness : {1e-5, 1e-3, 1e-2}) {
        const double a = 0.003 * std::sqrt(aspect), b = 0.003 / std::sqrt(aspect);
        using T = Triple<double>;
        const ShellFrame<double> g =
            shell_frame(corner_modes(T{0, 0, 0}, T{a, 0, 0}, T{1.2 * a, b, 0}, T{0.2 * a, b, 0}));
        const IsotropicLaw law = isotropic_law(1e9, nu);
        const double mass = 1000 * thickness * g.area, ratio = rotary_inertia_ratio(g.area, thickness);
        ModeStiffness<double> k = mode_stiffness(law, g, thickness);
        k.spin = 0;  // drilling is added to whatever governs
        const double all = frequency_squared_bound(g, law, thickness, mass, ratio, k);
        const double membrane_only = frequency_squared_bound(g, law, thickness, mass, 1e6 * ratio, k);
        EXPECT_NEAR(all / membrane_only, 1, 1e-3)
            << "nu " << nu << ", aspect " << aspect << ", t " << thickness;
      }
}

/// Runs a shaken mesh; returns the largest total energy over the initial one.
double largest_energy_growth(Carpet& carpet, double dt, int steps) {
  const NodeView nodes = carpet.nodes();
  for (std::size_t n = 0; n < nodes.x.size(); ++n)
    if (!nodes.clamped[n]) {
      const auto wave = [n](double k) { return 0.01 * std::sin(k * static_cast<double>(n) + k); };
      carpet.set_velocity(n, Vec3(wave(1.1), wave(2.3), wave(3.7)), Vec3(0, 0, 0));
    }
  const Vec3Array load = no_load(nodes.x.size());
  const double start = carpet.energy().kinetic;
  double largest = 0;
  for (int i = 0; i < steps; ++i) {
    carpet.step(dt, load);
    const CarpetEnergy e = carpet.energy();
    largest = std::max(largest, (e.kinetic + e.strain + e.hourglass) / start);
  }
  return largest;
}

TEST(StableStep, NineTenthsOfItIsStableOverTwentyThousandSteps) {
  const std::vector<Case> all = cases();
  for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{5}}) {
    Carpet carpet(all[i].mesh, all[i].materials, no_gravity());
    // Discrete time makes the energy of a mode at omega dt = 1.8 swing by a factor; growth would be by
    // orders.
    EXPECT_LT(largest_energy_growth(carpet, 0.9 * carpet.stable_step(), 20000), 10) << all[i].name;
  }
  for (const std::size_t i : {std::size_t{7}, std::size_t{8}}) {
    Carpet carpet(all[i].mesh, all[i].materials, no_gravity());
    EXPECT_LT(largest_energy_growth(carpet, 0.9 * carpet.stable_step(), 4000), 10) << all[i].name;
  }
}

TEST(StableStep, NineTenthsOfItIsStableUnderViscousHourglassControl) {
  for (const double coefficient : {0.05, 0.3, 1.0})
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}, std::size_t{5}}) {
      const Case c = cases()[i];
      CarpetOptions options = no_gravity();
      options.section.hourglass = HourglassControl::viscous;
      options.section.hourglass_coefficient = coefficient;
      Carpet carpet(c.mesh, c.materials, options);
      EXPECT_LT(largest_energy_growth(carpet, 0.9 * carpet.stable_step(), 20000), 10)
          << c.name << ", coefficient " << coefficient;
    }
}

TEST(HourglassControl, OfTheViscousTypeBooksTheWorkItDoes) {
  for (const double coefficient : {0.1, 1.0})
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
      const Case c = cases()[i];
      CarpetOptions options = no_gravity();
      options.section.hourglass = HourglassControl::viscous;
      options.section.hourglass_coefficient = coefficient;
      Carpet carpet(c.mesh, c.materials, options);
      for (std::size_t n = 0; n < c.mesh.nodes.size(); ++n)
        if (!c.mesh.clamped[n]) {
          const auto wave = [n](double k) { return 0.01 * std::sin(k * static_cast<double>(n) + k); };
          carpet.set_velocity(n, Vec3(wave(1.1), wave(2.3), wave(3.7)), Vec3(0, 0, 0));
        }
      const double start = total(carpet.energy()), dt = 0.1 * carpet.stable_step();
      const Vec3Array load = no_load(c.mesh.nodes.size());
      for (int k = 0; k < 20000; ++k) carpet.step(dt, load);
      const CarpetEnergy e = carpet.energy();
      EXPECT_GT(e.hourglass, 0.05 * start) << c.name << ", coefficient " << coefficient;
      EXPECT_NEAR(total(e) / start, 1, 0.01) << c.name << ", coefficient " << coefficient;
    }
}

TEST(StableStep, ThirtyPercentOverTheTrueLimitIsCaughtAndNamed) {
  for (const Case& c : cases()) {
    Carpet carpet(c.mesh, c.materials, no_gravity());
    const double limit = 2 / std::sqrt(LinearModel(c.mesh, c.materials, {}).largest_frequency_squared(500));
    try {
      largest_energy_growth(carpet, 1.3 * limit, 2000);
      ADD_FAILURE() << c.name << ": instability was not noticed";
    } catch (const RunError& error) {
      const std::string text = error.what();
      EXPECT_TRUE(text.find("element ") != std::string::npos || text.find("node ") != std::string::npos)
          << text;
      EXPECT_NE(text.find("smaller step"), std::string::npos) << text;
    }
  }
}

TEST(StableStep, ShrinksWithTheElements) {
  Strip strip = make_strip({0.03, 0.0013, 0.0001, 10, 1}, false);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  const double before = carpet.stable_step();
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    carpet.set_position(n, strip.mesh.nodes[n].cwiseProduct(Vec3(1, 0.5, 1)));
  // Same mass on half the width: c b is halved, and the area that carries the stress too, so step / sqrt(2).
  EXPECT_NEAR(carpet.stable_step() / before, std::sqrt(0.5), 0.02);
}

TEST(NodeContactStiffness, IsAtLeastTheNodesMassOverTheStableStepSquaredOfItsElements) {
  const ShellMesh mesh = turf(0.001);
  const Carpet carpet(mesh, {{0.2e9, 0.3, 900}, polyethylene()}, no_gravity());
  const std::span<const double> stiffness = carpet.node_contact_stiffness();
  ASSERT_EQ(stiffness.size(), mesh.nodes.size());
  const double dt = carpet.stable_step();
  for (std::size_t n = 0; n < stiffness.size(); ++n) {
    EXPECT_GT(stiffness[n], 0);
    EXPECT_LE(stiffness[n], carpet.nodes().mass[n] / (dt * dt) * (1 + 1e-12));
  }
}

}  // namespace
}  // namespace tuft::fe::test

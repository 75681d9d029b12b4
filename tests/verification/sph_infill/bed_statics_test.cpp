/// Beds at rest under their own weight.
#include <gtest/gtest.h>

#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

class GeostaticColumn : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, GeostaticColumn,
                         testing::Values(test::Preset::accurate, test::Preset::paper));

/// A bed between slip walls. sigma_zz = rho g z is asked of horizontal planes midway between two rows, where
/// the stress is the mean of the rows', over the particles two columns away from the walls and two rows from
/// floor and surface.
///
/// Single particles scatter about it by an odd-even pattern that makes no force: a zero-energy mode of the
/// one-point gradient, set off at the boundary and bounded here too. Within two rows of the boundary the
/// one-sided gradient doubles the weight of the outermost row in the force, so that it carries about half the
/// stress; the force on the floor is right nevertheless.
TEST_P(GeostaticColumn, SettlesToTheWeightAboveWithinTwoPercent) {
  const int width = 10, rows = 20, border = 2;
  SphSettings settings;
  settings.options = test::options_of(GetParam(), pitch);
  const auto materials = test::single_material(test::mixture_material());
  const Lattice lattice = test::block(width, width, rows, pitch);
  SphInfill infill(lattice, materials, settings);
  const std::size_t n = lattice.position.size();
  const double modulus = constrained_modulus(*materials[0].continuum, 1e4);
  const test::Tray tray(width * pitch, width * pitch, 10 * modulus * pitch, 0.1);
  ContactImpulses contact;
  infill.set_damping(3000);
  double floor_force = 0;
  for (double t = 0; t < 0.012;) {
    const double dt = 0.35 * infill.stable_step();
    tray.push(infill.particles(), dt, contact);
    infill.advance(dt, 1, contact);
    floor_force = 0;
    for (const double impulse : contact.linear.z) floor_force += impulse / dt;
    t += dt;
  }
  const double height = rows * pitch, full = 977 * 9.81 * height;
  const auto stress = test::field(infill, "vertical_stress"), density = test::field(infill, "density");
  double worst_plane = 0, worst_particle = 0, density_spread = 0, row_below = 0;
  for (int row = border; row < rows - border; ++row) {
    const double z = (row + 0.5) * pitch, expected = -977 * 9.81 * (height - z);
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double to_wall =
          0.5 * width * pitch - std::max(std::abs(lattice.position.x[i]), std::abs(lattice.position.y[i]));
      if (std::abs(lattice.position.z[i] - z) > 0.1 * pitch || to_wall < border * pitch) continue;
      worst_particle = std::max(worst_particle, std::abs(stress[i] - expected) / full);
      sum += stress[i];
      ++count;
    }
    ASSERT_EQ(count, (width - 2 * border) * (width - 2 * border));
    const double plane = -977 * 9.81 * (height - row * pitch);
    if (row > border)
      worst_plane = std::max(worst_plane, std::abs(0.5 * (row_below + sum / count) - plane) / full);
    row_below = sum / count;
  }
  for (const double rho : density) density_spread = std::max(density_spread, std::abs(rho / 977 - 1));
  const double weight = 977 * std::pow(width * pitch, 2) * height * 9.81;
  RecordProperty("worst_plane", testing::PrintToString(worst_plane));
  RecordProperty("worst_particle", testing::PrintToString(worst_particle));
  RecordProperty("floor_force_over_weight", testing::PrintToString(floor_force / weight));
  EXPECT_LT(worst_plane, 0.02);
  EXPECT_LT(worst_particle, 0.04);
  EXPECT_NEAR(floor_force / weight, 1, 1e-3);
  EXPECT_LT(density_spread, 0.02);
  EXPECT_LT(infill.energy().kinetic, 1e-9 * weight * height);
}

}  // namespace
}  // namespace tuft::sph

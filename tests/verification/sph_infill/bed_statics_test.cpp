/// Beds at rest under their own weight.
#include <gtest/gtest.h>

#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

class GeostaticColumn : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, GeostaticColumn,
                         testing::Values(test::Preset::accurate, test::Preset::paper));

/// A bed between slip walls: vertical stress at a particle's centre carries the material above it, and
/// sigma_zz = rho g z.
TEST_P(GeostaticColumn, SettlesToTheWeightAboveWithinTwoPercent) {
  const int width = 6, rows = 20;
  SphSettings settings;
  settings.options = test::options_of(GetParam(), pitch);
  const auto materials = test::single_material(test::mixture_material());
  const Lattice lattice = test::block(width, width, rows, pitch);
  SphInfill infill(lattice, materials, settings);
  const double modulus = constrained_modulus(*materials[0].continuum, 1e4);
  const test::Tray tray(width * pitch, width * pitch, 10 * modulus * pitch, 0.1);
  ContactImpulses contact;
  infill.set_damping(3000);
  for (double t = 0; t < 0.012;) {
    const double dt = 0.35 * infill.stable_step();
    tray.push(infill.particles(), dt, contact);
    infill.advance(dt, 1, contact);
    t += dt;
  }
  const double height = rows * pitch, full = 977 * 9.81 * height;
  const auto stress = test::field(infill, "vertical_stress"), density = test::field(infill, "density");
  double worst = 0, square = 0, density_spread = 0;
  for (std::size_t i = 0; i < stress.size(); ++i) {
    const double expected = -977 * 9.81 * (height - lattice.position.z[i]);
    worst = std::max(worst, std::abs(stress[i] - expected) / full);
    square += std::pow((stress[i] - expected) / full, 2);
    density_spread = std::max(density_spread, std::abs(density[i] / 977 - 1));
  }
  RecordProperty("worst", testing::PrintToString(worst));
  RecordProperty("rms", testing::PrintToString(std::sqrt(square / static_cast<double>(stress.size()))));
  RecordProperty("kinetic", testing::PrintToString(infill.energy().kinetic));
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(density_spread, 0.02);
  // At rest: slower than a thousandth of a fall through the bed.
  EXPECT_LT(infill.energy().kinetic, 1e-6 * 977 * height * std::pow(width * pitch, 2) * 9.81 * height);
}

}  // namespace
}  // namespace tuft::sph

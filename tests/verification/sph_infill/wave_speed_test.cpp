/// Oedometric (P) wave in a bar on lateral rollers.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

class PressureWave : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, PressureWave, testing::Values(test::Preset::accurate, test::Preset::paper));

/// The first mode of a free-free bar, v_z = V cos(pi z/L), has the period 2 L/c. Rollers (springs to the
/// initial x and y of every particle) keep it in uniaxial strain, in tension as in compression.
TEST_P(PressureWave, RunsAtTheOedometricSpeedWithinThreePercent) {
  const double bulk = 1e6, density = 1000, shear_ratio = 0.5;
  const double speed = std::sqrt(bulk * (1 + 4.0 / 3 * shear_ratio) / density);
  const int rows = 60;
  const double length = rows * pitch;
  const Lattice lattice = test::block(5, 5, rows, pitch);
  SphSettings settings;
  settings.options = test::options_of(GetParam(), pitch);
  settings.gravity = {0, 0, 0};
  settings.artificial_viscosity = false;
  SphInfill infill(lattice, test::single_material(test::elastic_material(bulk, density, shear_ratio)),
                   settings);
  const std::size_t n = lattice.position.size();
  std::vector<double> shape(n);
  for (std::size_t i = 0; i < n; ++i) {
    shape[i] = std::cos(std::numbers::pi * lattice.position.z[i] / length);
    infill.set_velocity(i, {0, 0, 0.05 * shape[i]});
  }
  const double roller = 10 * bulk * (1 + 4.0 / 3 * shear_ratio) * pitch;
  const double dt = 0.3 * infill.stable_step();
  ContactImpulses contact;
  // Zero crossings of the modal velocity at 1/4 and 3/4 of the period; velocities stand half a step behind.
  std::vector<double> crossings;
  double before = 1;
  for (double t = 0; crossings.size() < 3; t += dt) {
    const ParticleView p = infill.particles();
    contact.linear.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i)
      contact.linear.set(
          i, -dt * roller * Vec3(p.x[i] - lattice.position.x[i], p.y[i] - lattice.position.y[i], 0));
    infill.advance(dt, 1, contact);
    double mode = 0;
    for (std::size_t i = 0; i < n; ++i) mode += infill.particles().vz[i] * shape[i];
    if (mode * before < 0) crossings.push_back(t + 0.5 * dt - dt * mode / (mode - before));
    before = mode;
    ASSERT_LT(t, 4 * length / speed) << "the wave does not come back";
  }
  const double measured = 2 * length / (crossings[2] - crossings[0]);
  RecordProperty("speed_over_theory", testing::PrintToString(measured / speed));
  EXPECT_NEAR(measured / speed, 1, 0.03);
  EXPECT_NEAR(2 * length / (4 * crossings[0]) / speed, 1, 0.03);
}

}  // namespace
}  // namespace tuft::sph

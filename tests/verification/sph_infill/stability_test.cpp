/// The stable step is safe, and not by much.
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

struct Case {
  test::Preset preset;
  double jitter, squeeze;
  double zeta = 0;  ///< of the control of zero-energy modes

  friend void PrintTo(const Case& c, std::ostream* os) {
    PrintTo(c.preset, os);
    *os << " jitter " << c.jitter << " squeeze " << c.squeeze << " zeta " << c.zeta;
  }
};

/// Random velocities in a free elastic cube without viscosity: the kinetic energy falls by half and stays, or
/// grows without bound.
bool stays_bounded(const Case& c, double share_of_stable_step) {
  Lattice lattice = test::block(7, 7, 7, pitch);
  test::jitter(lattice, c.jitter);
  for (double& z : lattice.position.z) z *= c.squeeze;
  for (double& volume : lattice.volume) volume *= c.squeeze;
  SphSettings settings;
  settings.options = test::options_of(c.preset, pitch);
  settings.gravity = {0, 0, 0};
  settings.artificial_viscosity = false;
  settings.zero_energy_control = c.zeta > 0;
  settings.options.zero_energy_viscosity = c.zeta;
  SphInfill infill(lattice, test::single_material(test::elastic_material(1e6, 1000)), settings);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-1e-4, 1e-4);
  for (std::size_t i = 0; i < lattice.position.size(); ++i)
    infill.set_velocity(i, {any(random), any(random), any(random)});
  const double dt = share_of_stable_step * infill.stable_step();
  double first = 0;
  try {
    for (int k = 0; k < 1000; ++k) {
      infill.advance(dt, 1, {});
      if (k == 0) first = infill.energy().kinetic;
      if (infill.energy().kinetic > 3 * first) return false;
    }
  } catch (const RunError&) {
    return false;
  }
  return true;
}

class StableStepOf : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Lattices, StableStepOf,
    testing::Values(Case{test::Preset::accurate, 0, 1}, Case{test::Preset::accurate, 0.25, 1},
                    Case{test::Preset::accurate, 0, 0.8}, Case{test::Preset::paper, 0, 1},
                    Case{test::Preset::paper, 0.25, 1}, Case{test::Preset::paper, 0, 0.8},
                    Case{test::Preset::accurate, 0, 1, 0.3}, Case{test::Preset::paper, 0.25, 1, 0.3}));

TEST_P(StableStepOf, AFreeCubeIsStableAndWithinFortyPercentOfTheLimit) {
  EXPECT_TRUE(stays_bounded(GetParam(), 1.0));
  EXPECT_FALSE(stays_bounded(GetParam(), 1.4));
}

}  // namespace
}  // namespace tuft::sph

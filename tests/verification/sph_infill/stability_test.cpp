/// The stable step is safe wherever the stiffest particles are, and not by much.
#include <gtest/gtest.h>

#include <tuple>

#include "core/error.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

struct Case {
  test::Preset preset;
  double jitter, squeeze;
  double zeta = 0;            ///< of the control of zero-energy modes
  double alpha = 0;           ///< of artificial viscosity
  bool other_kernel = false;  ///< than the preset's

  friend void PrintTo(const Case& c, std::ostream* os) {
    PrintTo(c.preset, os);
    *os << " jitter " << c.jitter << " squeeze " << c.squeeze << " zeta " << c.zeta << " alpha " << c.alpha
        << (c.other_kernel ? " other kernel" : "");
  }
};

SphSettings settings_of(const Case& c) {
  SphSettings settings;
  settings.options = test::options_of(c.preset, pitch);
  if (c.other_kernel)
    settings.options.kernel =
        settings.options.kernel == Kernel::wendland_c2 ? Kernel::cubic_spline : Kernel::wendland_c2;
  settings.gravity = {0, 0, 0};
  settings.artificial_viscosity = c.alpha > 0;
  settings.options.viscosity_linear = c.alpha;
  settings.options.viscosity_quadratic = 0;
  settings.zero_energy_control = c.zeta > 0;
  settings.options.zero_energy_viscosity = c.zeta;
  return settings;
}

/// Random velocities in a free elastic body without viscosity: the kinetic energy falls by half and stays, or
/// grows without bound.
bool stays_bounded(const Case& c, Lattice lattice, const std::vector<Material>& materials, int steps,
                   double share_of_stable_step) {
  test::jitter(lattice, c.jitter);
  for (double& z : lattice.position.z) z *= c.squeeze;
  for (double& volume : lattice.volume) volume *= c.squeeze;
  SphInfill infill(lattice, materials, settings_of(c));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-1e-4, 1e-4);
  for (std::size_t i = 0; i < lattice.position.size(); ++i)
    infill.set_velocity(i, {any(random), any(random), any(random)});
  const double dt = share_of_stable_step * infill.stable_step();
  double first = 0;
  try {
    for (int k = 0; k < steps; ++k) {
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
                    Case{test::Preset::accurate, 0, 0.8}, Case{test::Preset::fast, 0, 1},
                    Case{test::Preset::fast, 0.25, 1}, Case{test::Preset::paper, 0, 1},
                    Case{test::Preset::paper, 0.25, 1}, Case{test::Preset::paper, 0, 0.8},
                    Case{test::Preset::accurate, 0, 1, 0.3}, Case{test::Preset::paper, 0.25, 1, 0.3},
                    Case{test::Preset::accurate, 0.25, 1, 0, 0, true},
                    Case{test::Preset::fast, 0, 1, 0, 0, true},
                    Case{test::Preset::paper, 0.25, 1, 0, 0, true}));

TEST_P(StableStepOf, AFreeCubeIsStableAndWithinFortyPercentOfTheLimit) {
  const Lattice cube = test::block(7, 7, 7, pitch);
  const std::vector<Material> elastic = test::single_material(test::elastic_material(1e6, 1000));
  EXPECT_TRUE(stays_bounded(GetParam(), cube, elastic, 1000, 1.0));
  EXPECT_FALSE(stays_bounded(GetParam(), cube, elastic, 1000, 1.4));
}

enum class Stiff { core, layer_in_the_middle, layer_on_top };
void PrintTo(Stiff stiff, std::ostream* os) {
  *os << (stiff == Stiff::core ? "core" : stiff == Stiff::layer_on_top ? "on top" : "in the middle");
}

/// 50 MPa in 1 MPa.
class StableStepOfStiffPart : public testing::TestWithParam<std::tuple<Case, Stiff>> {
 protected:
  static Lattice block_with(Stiff stiff) {
    Lattice lattice = test::block(11, 11, 12, pitch);
    for (std::size_t i = 0; i < lattice.position.size(); ++i) {
      const Vec3 x = lattice.position[i] / pitch - Vec3(0, 0, 6);
      const bool is_stiff = stiff == Stiff::core           ? x.cwiseAbs().maxCoeff() < 3
                            : stiff == Stiff::layer_on_top ? x.z() > 2
                                                           : std::abs(x.z()) < 2;
      lattice.material[i] = is_stiff ? 1 : 0;
    }
    return lattice;
  }
  static std::vector<Material> materials() {
    std::vector<Material> both = test::single_material(test::elastic_material(1e6, 1000));
    both.push_back(test::single_material(test::elastic_material(50e6, 1000)).front());
    return both;
  }
};
INSTANTIATE_TEST_SUITE_P(
    Stiff, StableStepOfStiffPart,
    testing::Combine(
        testing::Values(Case{test::Preset::accurate, 0, 1}, Case{test::Preset::accurate, 0.1, 0.8},
                        Case{test::Preset::fast, 0.1, 1}, Case{test::Preset::fast, 0, 0.8},
                        Case{test::Preset::paper, 0.1, 1}, Case{test::Preset::paper, 0, 0.8},
                        Case{test::Preset::accurate, 0, 1, 0.3}, Case{test::Preset::fast, 0.1, 1, 0.3},
                        Case{test::Preset::accurate, 0, 1, 0, 1}, Case{test::Preset::paper, 0, 1, 0, 1},
                        Case{test::Preset::accurate, 0.1, 1, 0, 0, true},
                        Case{test::Preset::fast, 0.1, 1, 0, 0, true},
                        Case{test::Preset::paper, 0.1, 1, 0, 0, true}),
        testing::Values(Stiff::core, Stiff::layer_in_the_middle, Stiff::layer_on_top)));

// Rows that are wholly surrounded act together, as those at a surface hardly do: a step that surfaces bear is
// not one for the inside.
TEST_P(StableStepOfStiffPart, IsStableAndWithinTwiceTheLimit) {
  const auto [which, stiff] = GetParam();
  EXPECT_TRUE(stays_bounded(which, block_with(stiff), materials(), 2000, 1.0));
  EXPECT_FALSE(stays_bounded(which, block_with(stiff), materials(), 2000, 2.0));
}

}  // namespace
}  // namespace tuft::sph

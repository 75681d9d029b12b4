#include "sph_infill/stable_step.h"

#include <gtest/gtest.h>

namespace tuft::sph {
namespace {

SphOptions viscous_options(double linear, double quadratic) {
  SphOptions options;
  options.smoothing_length = 0.0026;
  options.viscosity_linear = linear;
  options.viscosity_quadratic = quadratic;
  return options;
}

TEST(StableStep, IsTheLeapfrogsPhaseOverTheFrequencyAtRestWithoutViscosity) {
  const StepLimit limit = make_step_limit(viscous_options(1, 2), 0.002, false);
  EXPECT_DOUBLE_EQ(particle_stable_step(limit, 3e4, 50, 0, 0), 2 / 3e4);
}

TEST(StableStep, FallsWithViscosityAndWithTheRateOfStrain) {
  const StepLimit off = make_step_limit(viscous_options(0, 0), 0.002, true);
  const StepLimit linear = make_step_limit(viscous_options(1, 0), 0.002, true);
  const StepLimit both = make_step_limit(viscous_options(1, 2), 0.002, true);
  const double rest = particle_stable_step(off, 3e4, 50, 0, 0);
  EXPECT_LT(particle_stable_step(linear, 3e4, 50, 0, 0), 0.95 * rest);
  EXPECT_LT(particle_stable_step(off, 3e4, 50, 3e3, 0), 0.95 * rest);
  EXPECT_LT(particle_stable_step(both, 3e4, 50, 3e3, 0), particle_stable_step(linear, 3e4, 50, 3e3, 0));
}

TEST(StableStep, FallsWithTheControlOfZeroEnergyModesByItsMeasuredShare) {
  SphOptions options = viscous_options(0, 0);
  options.zero_energy_viscosity = 0.1;
  const double off = particle_stable_step(make_step_limit(options, 0.002, false, false), 3e4, 50, 0, 0),
               on = particle_stable_step(make_step_limit(options, 0.002, false, true), 3e4, 50, 0, 0);
  EXPECT_NEAR(on / off, std::sqrt(1 + 0.04 * 0.04) - 0.04, 1e-12);
}

TEST(StableStep, OfPlaneWavesInsideALatticeIsExact) {
  // Chosen numbers: from 4000 random wave vectors and a climb from the best of them, by another program.
  const auto of = [](Kernel kernel, double h_over_pitch) {
    SphOptions options;
    options.kernel = kernel;
    options.smoothing_length = h_over_pitch * 0.003;
    return lattice_waves(options, 0.003, 0, 0).coherence;
  };
  EXPECT_NEAR(of(Kernel::wendland_c2, 1.3), 2.050, 0.005);
  EXPECT_NEAR(of(Kernel::cubic_spline, 1.0), 1.680, 0.005);
  EXPECT_NEAR(of(Kernel::cubic_spline, 0.71), std::sqrt(2.0), 1e-3);
}

TEST(StableStep, InsideFallsWithViscosityAsItsWavesDo) {
  SphOptions options;
  options.smoothing_length = 1.3 * 0.003;
  // Chosen numbers: by another program, from a list of wave vectors and all pairs viscous.
  EXPECT_EQ(lattice_waves(options, 0.003, 0, 0).damping, 0);
  EXPECT_NEAR(lattice_waves(options, 0.003, 0.3, 0).damping, 0.12, 0.01);
  EXPECT_NEAR(lattice_waves(options, 0.003, 1, 0).damping, 0.49, 0.02);
  EXPECT_NEAR(lattice_waves(options, 0.003, 0, 0.05).damping, 0.034, 0.003);
  EXPECT_NEAR(lattice_waves(options, 0.003, 0, 0.3).damping, 0.57, 0.02);
}

TEST(StableStep, OfWhatIsSqueezedIsThatOfItsFinerLattice) {
  const StepLimit limit = make_step_limit(viscous_options(0, 0), 0.002, false);
  const double whole = 8e-9;
  EXPECT_DOUBLE_EQ(largest_mobility(limit, 3.0, 0, whole, whole), 3 * limit.coherence_squared);
  EXPECT_DOUBLE_EQ(largest_mobility(limit, 3.0, 0, whole / 2, whole / 3), 6 * limit.coherence_squared);
  EXPECT_DOUBLE_EQ(largest_mobility(limit, 3.0, 0, whole * 2, whole), 3 * limit.coherence_squared);
  EXPECT_EQ(largest_mobility(limit, 0.0, 0, whole, whole), 0);
}

}  // namespace
}  // namespace tuft::sph

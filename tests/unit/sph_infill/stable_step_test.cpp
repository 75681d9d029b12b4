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
  const StepLimit limit = make_step_limit(viscous_options(1, 2), false);
  EXPECT_DOUBLE_EQ(particle_stable_step(limit, 3e4, 50, 0), stable_phase / 3e4);
}

TEST(StableStep, FallsWithViscosityAndWithTheRateOfStrain) {
  const StepLimit off = make_step_limit(viscous_options(0, 0), true);
  const StepLimit linear = make_step_limit(viscous_options(1, 0), true);
  const StepLimit both = make_step_limit(viscous_options(1, 2), true);
  const double rest = particle_stable_step(off, 3e4, 50, 0);
  EXPECT_LT(particle_stable_step(linear, 3e4, 50, 0), 0.95 * rest);
  EXPECT_LT(particle_stable_step(off, 3e4, 50, 3e3), 0.95 * rest);
  EXPECT_LT(particle_stable_step(both, 3e4, 50, 3e3), particle_stable_step(linear, 3e4, 50, 3e3));
}

TEST(StableStep, FallsWithTheControlOfZeroEnergyModesByItsMeasuredShare) {
  SphOptions options = viscous_options(0, 0);
  options.zero_energy_viscosity = 0.1;
  const double off = particle_stable_step(make_step_limit(options, false, false), 3e4, 50, 0),
               on = particle_stable_step(make_step_limit(options, false, true), 3e4, 50, 0);
  EXPECT_NEAR(on / off, std::sqrt(1 + 0.04 * 0.04) - 0.04, 1e-12);
}

}  // namespace
}  // namespace tuft::sph

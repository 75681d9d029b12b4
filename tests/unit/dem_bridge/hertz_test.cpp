#include "dem_bridge/hertz.h"

#include <gtest/gtest.h>

namespace tuft::dem {
namespace {

TEST(Hertz, ForceIsTheDerivativeOfTheEnergy) {
  const double young = 5e6, radius = 0.0007;
  for (const double overlap : {1e-6, 2e-5, 1e-4}) {
    const double h = 1e-4 * overlap;
    const double slope =
        (normal_energy(young, radius, overlap + h) - normal_energy(young, radius, overlap - h)) / (2 * h);
    const double force = 4.0 / 3.0 * young * std::sqrt(radius) * std::pow(overlap, 1.5);
    EXPECT_NEAR(slope, force, 1e-7 * force);
  }
}

TEST(Hertz, EqualMaterialsGiveHalfThePlaneStrainModulus) {
  EXPECT_NEAR(effective_young_modulus(8e6, 0.3, 8e6, 0.3), 8e6 / (2 * (1 - 0.09)), 1e-3);
  EXPECT_NEAR(effective_shear_modulus(8e6, 0.3, 8e6, 0.3), 8e6 / (4 * 1.7 * 1.3), 1e-3);
}

TEST(Hertz, RigidPartnerLeavesTheOtherModulus) {
  EXPECT_NEAR(effective_young_modulus(8e6, 0.3, 1e20, 0.3), 8e6 / 0.91, 1);
}

TEST(StableStep, IsAFifthOfTheRayleighTime) {
  // Glass of 10 mm: G = 20 GPa; pi 0.01 sqrt(2800 / 2e10) / (0.1631 0.2 + 0.8766) = 12.928 us
  EXPECT_NEAR(stable_grain_step(0.01, 2800, 48e9, 0.2), 0.2 * 12.928e-6, 1e-9);
}

}  // namespace
}  // namespace tuft::dem

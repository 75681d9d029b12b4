#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dem_bridge/effective_medium.h"

namespace tuft::dem {
namespace {

/// Contact by contact: radius a of the contact circle under the pressure, its normal and tangential
/// stiffness, their mean over all directions.
double by_contacts(double young, double poisson, double solid, double coordination, double pressure) {
  const double radius = 1e-3, shear = young / (2 * (1 + poisson)), pi = std::numbers::pi;
  const double force = 4 * pi * radius * radius * pressure / (coordination * solid);
  const double a = std::cbrt(3 * force * radius * (1 - poisson) / (8 * shear));
  const double normal = 4 * a * shear / (1 - poisson), tangential = 8 * a * shear / (2 - poisson);
  const double bulk = coordination * solid / (12 * pi * radius) * normal,
               of_shear = coordination * solid / (20 * pi * radius) * (normal + 1.5 * tangential);
  return bulk + 4.0 / 3 * of_shear;
}

TEST(EffectiveMedium, ConstrainedModulusIsTheMeanOfItsContacts) {
  for (const double poisson : {0.1, 0.3, 0.45})
    for (const double pressure : {1e4, 1e6})
      EXPECT_NEAR(packing_constrained_modulus(1e8, poisson, 0.6, 6, pressure) /
                      by_contacts(1e8, poisson, 0.6, 6, pressure),
                  1, 1e-12);
}

}  // namespace
}  // namespace tuft::dem

#include <gtest/gtest.h>

#include "fe_carpet/plane_stress.h"
#include "fe_carpet/random.h"
#include "fe_carpet/thickness_rule.h"

namespace tuft::fe::test {
namespace {

TEST(PlaneStress, UniaxialStressNeedsYoungsModulus) {
  const IsotropicLaw law = isotropic_law(2e9, 0.3);
  const PlaneStress<double> s = law.stress(1e-3, -0.3e-3, 0.0);
  EXPECT_NEAR(s.xx, 2e6, 1e-6);
  EXPECT_NEAR(s.yy, 0, 1e-6);
}

TEST(PlaneStress, IsIsotropic) {
  // Pure shear seen from axes turned by 45 degrees is tension and compression.
  const IsotropicLaw law = isotropic_law(2e9, 0.3);
  EXPECT_NEAR(law.stress(0.0, 0.0, 1e-3).xy, law.stress(0.5e-3, -0.5e-3, 0.0).xx, 1e-6);
}

template <int Points>
void expect_exact_moments() {
  const ThicknessRule<Points> rule = thickness_rule<Points>();
  double sum = 0, first = 0;
  std::array<double, 2 * Points> moment{};
  for (std::size_t p = 0; p < Points; ++p) {
    sum += rule.weight[p];
    first += rule.weight[p] * rule.height[p];
    for (int k = 0; k < 2 * Points; ++k)
      moment[static_cast<std::size_t>(k)] += rule.weight[p] * std::pow(rule.height[p], k);
  }
  EXPECT_NEAR(sum, 1, 1e-15);
  EXPECT_NEAR(first, 0, 1e-16);
  for (int k = 0; k < 2 * Points; k += 2)
    EXPECT_NEAR(moment[static_cast<std::size_t>(k)], 1.0 / (k + 1), 1e-15) << Points;
}

TEST(ThicknessRule, IntegratesPolynomialsUpToTwiceItsPointsExactly) {
  expect_exact_moments<2>();
  expect_exact_moments<3>();
  expect_exact_moments<4>();
  expect_exact_moments<5>();
}

TEST(Random, IsTheSameEverywhere) {
  // The tenthousandth number of the standard's engine is fixed by the standard ([rand.predef]):
  // 9981545732273789042.
  Random random(5489);
  for (int i = 0; i < 9999; ++i) (void)random.uniform();
  EXPECT_EQ(random.uniform(), static_cast<double>(9981545732273789042ULL >> 11U) * 0x1.0p-53);
}

TEST(Random, NormalQuantileIsTheInverseOfTheNormalDistribution) {
  for (const double p : {0.001, 0.05, 0.3, 0.5, 0.7, 0.95, 0.999})
    EXPECT_NEAR(0.5 * std::erfc(-normal_quantile(p) / std::sqrt(2.0)), p, 2e-4);
}

}  // namespace
}  // namespace tuft::fe::test

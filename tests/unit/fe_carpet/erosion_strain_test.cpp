#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "fe_carpet/erosion.h"

namespace tuft::fe {
namespace {

using Strain = SectionStrain<double>;

/// Largest principal strain at the heights +-z after equal increments that add up to `total`.
double strain_after(const Strain& total, double z, int increments = 1) {
  std::array<double, 6> state{};
  const PointRows<double> rows{state.data()};
  const double share = 1.0 / increments;
  const PlaneStrain<double>&m = total.membrane, &k = total.curvature;
  double largest = 0;
  for (int i = 0; i < increments; ++i)
    largest = advance_strain<double>(
        rows, {{share * m.xx, share * m.yy, share * m.xy}, {share * k.xx, share * k.yy, share * k.xy}}, z);
  return largest;
}

TEST(ErosionStrain, IsTheLargestPrincipalOneOfTheMembrane) {
  EXPECT_DOUBLE_EQ(strain_after({{0.3, -0.1, 0}, {0, 0, 0}}, 1), 0.3);
  EXPECT_DOUBLE_EQ(strain_after({{-0.1, 0.25, 0}, {0, 0, 0}}, 1), 0.25);
  EXPECT_DOUBLE_EQ(strain_after({{-0.2, -0.1, 0}, {0, 0, 0}}, 1), -0.1) << "pressed on all sides";
  EXPECT_DOUBLE_EQ(strain_after({{0, 0, 0.4}, {0, 0, 0}}, 1), 0.2) << "engineering shear: half of it";
  // Uniaxial 0.2 seen in axes turned by 30 degrees.
  const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6);
  EXPECT_NEAR(strain_after({{0.2 * c * c, 0.2 * s * s, 2 * 0.2 * c * s}, {0, 0, 0}}, 1), 0.2, 1e-15);
}

TEST(ErosionStrain, AddsBendingOnWhicheverFaceIsStretched) {
  constexpr double z = 5e-4, curvature = 80;
  EXPECT_DOUBLE_EQ(strain_after({{0.01, 0, 0}, {curvature, 0, 0}}, z), 0.01 + z * curvature);
  EXPECT_DOUBLE_EQ(strain_after({{0.01, 0, 0}, {-curvature, 0, 0}}, z), 0.01 + z * curvature);
  EXPECT_DOUBLE_EQ(strain_after({{0, 0, 0}, {0, curvature, 0}}, z), z * curvature);
  EXPECT_DOUBLE_EQ(strain_after({{0, 0, 0}, {0, 0, curvature}}, z), 0.5 * z * curvature) << "twist";
}

TEST(ErosionStrain, IsTheSumOfItsIncrements) {
  const Strain total{{0.1, -0.03, 0.07}, {20, -5, 8}};
  EXPECT_NEAR(strain_after(total, 1e-3, 1000), strain_after(total, 1e-3), 1e-14);
}

TEST(ErosionStrain, IsTakenAtTheOutermostPointThroughTheThickness) {
  EXPECT_EQ(outermost_height<1>(), 1);
  EXPECT_NEAR(outermost_height<2>(), std::sqrt(1.0 / 3), 1e-15);
  EXPECT_NEAR(outermost_height<3>(), std::sqrt(0.6), 1e-15);
  EXPECT_LT(outermost_height<3>(), outermost_height<4>());
  EXPECT_LT(outermost_height<4>(), outermost_height<5>());
}

}  // namespace
}  // namespace tuft::fe

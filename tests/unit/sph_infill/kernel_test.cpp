#include "sph_infill/kernel.h"

#include <gtest/gtest.h>

namespace tuft::sph {
namespace {

template <class KernelType>
class KernelProperty : public testing::Test {};
using Kernels = testing::Types<WendlandC2, CubicSpline>;
TYPED_TEST_SUITE(KernelProperty, Kernels);

TYPED_TEST(KernelProperty, IntegratesToOne) {
  const double h = 0.7;
  const TypeParam kernel(h);
  const int n = 4000;
  const double dr = 2 * h / n;
  double integral = 0;
  for (int k = 0; k < n; ++k) {
    const double r = (k + 0.5) * dr;
    integral += 4 * std::numbers::pi * r * r * kernel.value(r) * dr;
  }
  EXPECT_NEAR(integral, 1, 1e-6);
}

TYPED_TEST(KernelProperty, SlopeIsTheDerivativeOfItsValue) {
  const double h = 0.7, step = 1e-6;
  const TypeParam kernel(h);
  for (double r = 0.05; r < 2.2 * h; r += 0.0137) {
    const double difference = (kernel.value(r + step) - kernel.value(r - step)) / (2 * step);
    EXPECT_NEAR(kernel.slope_over_distance(r * r) * r, difference, 1e-6 * kernel.value(0) / h)
        << "at r = " << r;
  }
}

TYPED_TEST(KernelProperty, VanishesBeyondItsSupportAndIsFiniteAtZero) {
  const TypeParam kernel(0.7);
  for (const double r : {1.4, 1.5, 10.0}) {
    EXPECT_EQ(kernel.value(r), 0);
    EXPECT_EQ(kernel.slope_over_distance(r * r), 0);
  }
  EXPECT_TRUE(std::isfinite(kernel.slope_over_distance(0.0)));
  EXPECT_LT(kernel.slope_over_distance(0.0), 0);
}

}  // namespace
}  // namespace tuft::sph

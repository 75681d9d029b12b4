// What targets determine, against cases known by hand.
#include "studies/identifiability.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tuft::studies {
namespace {

TEST(Identifiability, OfTargetsThatSeeOneParameterEach) {
  const Eigen::MatrixXd s = Eigen::Vector2d(4, 10).asDiagonal();
  const Identifiability found = identify(s, 0.03);
  EXPECT_TRUE(found.determined);
  EXPECT_NEAR(found.alone[0], 0.25, 1e-12);
  EXPECT_NEAR(found.together[0], 0.25, 1e-12);
  EXPECT_NEAR(found.together[1], 0.1, 1e-12);
  EXPECT_NEAR(found.correlation(0, 1), 0, 1e-12);
  EXPECT_NEAR(found.weakest[0], 1, 1e-12);
  EXPECT_NEAR(found.weakest_change, 0.25, 1e-12);
}

TEST(Identifiability, OfCoupledParametersIsTheLeastSquaresCovariance) {
  Eigen::MatrixXd s(3, 2);
  s << 1, 2, 3, 1, 0, 4;
  const Eigen::Matrix2d covariance = Eigen::Matrix2d(s.transpose() * s).inverse();
  const Identifiability found = identify(s, 0);
  EXPECT_NEAR(found.together[0], std::sqrt(covariance(0, 0)), 1e-12);
  EXPECT_NEAR(found.together[1], std::sqrt(covariance(1, 1)), 1e-12);
  EXPECT_NEAR(found.correlation(0, 1), covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1)),
              1e-12);
}

TEST(Identifiability, OfASumThatAloneIsSeenFindsTheDifferenceUndetermined) {
  Eigen::MatrixXd s(1, 2);
  s << 5, 5;
  const Identifiability found = identify(s, 0.01);
  EXPECT_FALSE(found.determined);
  EXPECT_NEAR(found.alone[0], 0.2, 1e-12);
  EXPECT_TRUE(std::isinf(found.together[0]));
  EXPECT_TRUE(std::isinf(found.weakest_change));
  EXPECT_NEAR(found.weakest[0] * found.weakest[1], -0.5, 1e-9) << "one up, the other down";
  // Under the regularisation: variances 1/(50 + 0.01) of the sum, 1/0.01 of the difference.
  EXPECT_NEAR(found.correlation(0, 1), (1 / 50.01 - 100) / (1 / 50.01 + 100), 1e-9);
}

TEST(Identifiability, OfAParameterThatNoTargetSees) {
  Eigen::MatrixXd s(2, 2);
  s << 3, 0, 1, 0;
  const Identifiability found = identify(s, 0.01);
  EXPECT_FALSE(found.determined);
  EXPECT_TRUE(std::isinf(found.alone[1]));
  EXPECT_NEAR(found.together[0], 1 / std::sqrt(10.0), 1e-12) << "the other is not touched";
  EXPECT_TRUE(found.correlation.allFinite());
}

TEST(Identifiability, OfNothingSeenIsFinite) {
  const Identifiability found = identify(Eigen::MatrixXd::Zero(2, 3), 0);
  EXPECT_FALSE(found.determined);
  EXPECT_TRUE(found.correlation.allFinite());
}

}  // namespace
}  // namespace tuft::studies

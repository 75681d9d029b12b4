#include "sph_infill/gradient_correction.h"

#include <gtest/gtest.h>

namespace tuft::sph {
namespace {

TEST(CorrectionMatrix, InvertsTheMomentOfAWellSupportedParticle) {
  const SymmetricTensor moment{0.7, 0.6, 0.4, 0.05, -0.1, 0.08};
  const Mat3 product = to_matrix(moment) * to_matrix(correction_matrix(moment));
  EXPECT_LT((product - Mat3::Identity()).norm(), 1e-14);
}

TEST(CorrectionMatrix, StaysExactAlongALineOfParticlesAndBoundedAcrossIt) {
  const Vec3 line = Vec3(1, 2, -1).normalized();
  const Mat3 moment = 0.8 * line * line.transpose();
  const Mat3 b = to_matrix(correction_matrix(symmetric_part(moment)));
  EXPECT_LT((b * moment * line - line).norm(), 1e-13);
  EXPECT_LE(b.norm(), std::sqrt(3) / least_support * (1 + 1e-12));
}

TEST(CorrectionMatrix, IsFiniteWithoutNeighbours) {
  EXPECT_LT((to_matrix(correction_matrix({})) - Mat3::Identity() / least_support).norm(), 1e-12);
}

TEST(CorrectionMatrix, IsContinuousWhereTheSafeguardSetsIn) {
  const auto at = [](double smallest) {
    return to_matrix(correction_matrix({0.6, 0.5, smallest, 0.02, 0, 0}));
  };
  EXPECT_LT((at(least_support * (1 + 1e-9)) - at(least_support * (1 - 1e-9))).norm(), 1e-6);
  // Where the cheap test fails but no eigenvalue is too small, the spectral form is the inverse.
  const SymmetricTensor thin{1, 0.11, 0.11, 0, 0, 0};
  EXPECT_LT((to_matrix(correction_matrix(thin)) * to_matrix(thin) - Mat3::Identity()).norm(), 1e-12);
}

}  // namespace
}  // namespace tuft::sph

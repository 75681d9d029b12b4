#pragma once
/// The matrix that makes a kernel gradient exact for linear fields (Randles & Libersky 1996; Bonet & Lok
/// 1999).
#include <Eigen/Eigenvalues>

#include "core/lane_math.h"
#include "sph_infill/tensor.h"

namespace tuft::sph {

/// A direction in which the moment matrix falls below this share of a full neighbourhood's (which is 1)
/// counts as poorly supported. Free corners
/// of a cubic lattice, the thinnest support of a bed at rest, have 0.22 (h = 1.3 pitch) and 0.33 (h = 0.71
/// pitch).
inline constexpr double least_support = 0.1;

/// B = M^-1 of the moment matrix M = sum_j V_j (x_j - x_i) (x) grad_i W_ij (symmetric, >= 0; near the unit
/// matrix inside).
///
/// Poorly supported particles (spray, a line or a sheet of particles): each eigenvalue of M below
/// `least_support` is replaced by it. Supported directions stay exact, the gradient in the others fades to
/// zero with the support, B is continuous in M and bounded by 1/least_support, so that such a particle cannot
/// ruin the stable step. A particle without neighbours has M = 0 and a zero gradient whatever B is.
struct Correction {
  SymmetricTensor b;
  bool exact;  ///< M^-1, with no eigenvalue replaced
};
inline Correction correction_of(const SymmetricTensor& moment) {
  const double det = determinant(moment), sum = trace(moment);
  // The two larger eigenvalues multiply to at most (sum/2)^2, so this bounds the smallest from below.
  if (det >= least_support * 0.25 * sum * sum && sum > 0) return {inverse(moment, det), true};
  const Eigen::SelfAdjointEigenSolver<Mat3> spectrum(to_matrix(moment));
  const Vec3 inverted = spectrum.eigenvalues().cwiseMax(least_support).cwiseInverse();
  return {
      symmetric_part(spectrum.eigenvectors() * inverted.asDiagonal() * spectrum.eigenvectors().transpose()),
      spectrum.eigenvalues()[0] >= least_support};
}
inline SymmetricTensor correction_matrix(const SymmetricTensor& moment) {
  return correction_of(moment).b;
}

struct Corrections {
  SymmetricTensorOf<Pack> b;
  PackMask exact;
};

/// The same for as many particles as there are lanes: those with little support one by one.
inline Corrections correction_matrices(const SymmetricTensorOf<Pack>& moment) {
  const Pack det = determinant(moment), sum = trace(moment);
  const PackMask supported = det >= (least_support * 0.25) * sum * sum && sum > 0.0;
  Corrections all{inverse(moment, select(supported, det, Pack(1.0))), supported};
  if (stdx::all_of(supported)) return all;
  SymmetricTensorOf<Pack>& b = all.b;
  for (std::size_t l = 0; l < lanes; ++l) {
    if (supported[l]) continue;
    const auto [one, exact] = correction_of(
        SymmetricTensor{moment.xx[l], moment.yy[l], moment.zz[l], moment.xy[l], moment.yz[l], moment.zx[l]});
    b.xx[l] = one.xx, b.yy[l] = one.yy, b.zz[l] = one.zz;
    b.xy[l] = one.xy, b.yz[l] = one.yz, b.zx[l] = one.zx;
    all.exact[l] = exact;
  }
  return all;
}

}  // namespace tuft::sph

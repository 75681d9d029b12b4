#pragma once
/// What targets say of parameters near a fit: pure functions of the sensitivities.
#include <Eigen/Dense>
#include <vector>

namespace tuft::studies {

/// Rows: values of the targets in tolerances (of a range: in halves of its width), each times the root of its
/// weight. Columns: parameters scaled to [0, 1].
struct Identifiability {
  Eigen::MatrixXd sensitivity;
  /// Change of a parameter that changes the targets by one tolerance (root of the sum of squares), the others
  /// held; infinite where no target sees it. 1 is its whole range.
  std::vector<double> alone;
  /// The same with the others free to make up for it: the standard deviation that would follow from targets
  /// known to one tolerance. Infinite where others can make up for all of it.
  std::vector<double> together;
  /// Of the parameters under such targets, [-1, 1]. Where targets do not determine them, under targets and
  /// the regularisation.
  Eigen::MatrixXd correlation;
  bool determined = false;  ///< the targets alone determine all parameters
  /// The combination of parameters (unit vector) that the targets see least, and the change along it that is
  /// one tolerance.
  Eigen::VectorXd weakest;
  double weakest_change = 0;
};

/// Directions whose singular value is under this share of the largest, or under 1e-9, count as not seen.
inline constexpr double unseen_share = 1e-6;

/// `regularisation` > 0 or 0: the weight of the squared distance from the start.
[[nodiscard]] Identifiability identify(const Eigen::MatrixXd& sensitivity, double regularisation);

/// From which `together` on a parameter is called ill-determined: a quarter of its range.
inline constexpr double ill_determined = 0.25;

}  // namespace tuft::studies

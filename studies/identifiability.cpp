#include "studies/identifiability.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tuft::studies {

Identifiability identify(const Eigen::MatrixXd& sensitivity, double regularisation) {
  const Eigen::Index n = sensitivity.cols();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Identifiability result;
  result.sensitivity = sensitivity;
  const Eigen::MatrixXd information = sensitivity.transpose() * sensitivity;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(information);
  const Eigen::VectorXd singular = modes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const double least = std::max(1e-9, unseen_share * singular.maxCoeff());
  result.weakest = modes.eigenvectors().col(0);
  // A direction has no sign; its largest part is shown positive.
  Eigen::Index largest = 0;
  result.weakest.cwiseAbs().maxCoeff(&largest);
  if (result.weakest[largest] < 0) result.weakest = -result.weakest;
  result.weakest_change = singular[0] > least ? 1 / singular[0] : infinite;
  result.determined = singular[0] > least;

  for (Eigen::Index i = 0; i < n; ++i) {
    const double seen = sensitivity.col(i).norm();
    result.alone.push_back(seen > least ? 1 / seen : infinite);
    double variance = 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const double part = modes.eigenvectors()(i, k);
      if (singular[k] > least)
        variance += part * part / (singular[k] * singular[k]);
      else if (std::abs(part) > 1e-3)
        variance = infinite;
    }
    result.together.push_back(std::sqrt(variance));
  }

  const double floor = result.determined ? 0.0 : std::max(regularisation, least * least);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k)
    covariance += modes.eigenvectors().col(k) * modes.eigenvectors().col(k).transpose() /
                  (singular[k] * singular[k] + floor);
  const Eigen::VectorXd deviation = covariance.diagonal().cwiseSqrt();
  result.correlation = covariance.cwiseQuotient(deviation * deviation.transpose());
  return result;
}

}  // namespace tuft::studies

#include "sph_infill/row_shares.h"

#include <Eigen/QR>
#include <algorithm>

#include "sph_infill/row_slopes.h"

namespace tuft::sph {
namespace {

/// Row i of L: the corrected gradient at row i of what moves along the rows' normal, per row (1/m).
Eigen::MatrixXd row_gradients(std::span<const double> place, std::span<const double> thickness,
                              std::array<double, 2> across, const SphOptions& options) {
  const std::size_t rows = place.size();
  const auto n = static_cast<Eigen::Index>(rows);
  Eigen::MatrixXd gradient = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < rows; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    double moment = 0;
    for (std::size_t j = 0; j < rows; ++j) {
      const double distance = place[j] - place[i];
      if (j == i || std::abs(distance) >= 2 * options.smoothing_length) continue;
      const double slope =
          thickness[j] * (distance > 0 ? 1 : -1) * row_slope(options, std::abs(distance), across);
      moment += slope * distance;
      gradient(row, static_cast<Eigen::Index>(j)) = slope;
      gradient(row, row) -= slope;
    }
    if (moment != 0) gradient.row(row) /= moment;
  }
  return gradient;
}

}  // namespace

std::vector<double> row_shares(std::span<const double> place, std::span<const double> thickness,
                               std::array<double, 2> across, const SphOptions& options) {
  const auto n = static_cast<Eigen::Index>(place.size());
  if (n < 3) return std::vector<double>(place.size(), 1.0);
  // Force on row k under a unit stress: sum_i share_i thickness_i L_ik. All rows' sum is zero, so that the
  // first row's need not be asked for.
  const Eigen::MatrixXd gradient = row_gradients(place, thickness, across, options);
  const Eigen::Map<const Eigen::VectorXd> thick(thickness.data(), n);
  const Eigen::MatrixXd force = (thick.asDiagonal() * gradient).transpose().bottomRows(n - 1);
  Eigen::VectorXd missing = -force.rowwise().sum();
  missing[n - 2] += 1;
  const Eigen::VectorXd change = force.completeOrthogonalDecomposition().solve(missing);
  // A cell cannot bear less than nothing. Few rows under a wide kernel may ask for that; they get as much of
  // the change as leaves every share within bounds.
  const double largest = change.cwiseAbs().maxCoeff();
  const Eigen::VectorXd share =
      Eigen::VectorXd::Ones(n) + std::min(1.0, most_share_change / std::max(largest, 1e-300)) * change;
  return {share.begin(), share.end()};
}

}  // namespace tuft::sph

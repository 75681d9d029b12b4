#pragma once
/// The Mohr-Coulomb line through yields at several normal stresses.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

namespace tuft {

/// tau = cohesion + sigma tan(friction_angle), by least squares. The angle is that of the line, not of the
/// secant tau/sigma: where cohesion is large the two are far apart.
struct MohrCoulombLine {
  double cohesion = 0;        ///< Pa
  double friction_angle = 0;  ///< rad
  double largest_misfit = 0;  ///< Pa, of any point
};

/// Of at least two points with different normal stresses (Pa); empty otherwise.
[[nodiscard]] inline std::optional<MohrCoulombLine> fit_mohr_coulomb(std::span<const double> normal,
                                                                     std::span<const double> shear) {
  const auto n = static_cast<double>(normal.size());
  double mean_normal = 0, mean_shear = 0, nn = 0, ns = 0;
  for (std::size_t i = 0; i < normal.size(); ++i) {
    mean_normal += normal[i] / n;
    mean_shear += shear[i] / n;
  }
  for (std::size_t i = 0; i < normal.size(); ++i) {
    nn += (normal[i] - mean_normal) * (normal[i] - mean_normal);
    ns += (normal[i] - mean_normal) * (shear[i] - mean_shear);
  }
  if (normal.size() < 2 || !(nn > 0)) return std::nullopt;
  MohrCoulombLine line;
  const double slope = ns / nn;
  line.friction_angle = std::atan(slope);
  line.cohesion = mean_shear - slope * mean_normal;
  for (std::size_t i = 0; i < normal.size(); ++i)
    line.largest_misfit =
        std::max(line.largest_misfit, std::abs(shear[i] - line.cohesion - slope * normal[i]));
  return line;
}

}  // namespace tuft

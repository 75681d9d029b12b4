#pragma once
/// One-dimensional compression, branch by branch: secant moduli between two stresses. For rows of any kind
/// that have a `strain` and a `stress` (Pa), both positive in compression.
#include <cstddef>
#include <optional>

namespace tuft {

struct BranchPoint {
  double strain = 0;  ///< compression over the height as placed
  double stress = 0;  ///< Pa
};

/// Strain at which the stress first passes `level` (Pa) in a branch; `sign` 1: upwards, -1: downwards.
/// Between rows straight.
template <class Rows>
[[nodiscard]] std::optional<double> strain_at(const Rows& rows, double level, double sign) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto &a = rows[i - 1], &b = rows[i];
    if (sign * (a.stress - level) > 0 || sign * (b.stress - level) < 0 || a.stress == b.stress) continue;
    return a.strain + (b.strain - a.strain) * (level - a.stress) / (b.stress - a.stress);
  }
  return std::nullopt;
}

/// Secant modulus between two stresses, Pa; empty where the branch does not pass both.
template <class Rows>
[[nodiscard]] std::optional<double> secant_modulus(const Rows& rows, double low, double high, double sign) {
  const auto from = strain_at(rows, low, sign), to = strain_at(rows, high, sign);
  if (!from || !to || *from == *to) return std::nullopt;
  return (high - low) / (*to - *from);
}

/// Secants of a cycle are taken between these shares of its largest stress.
inline constexpr double cycle_low_share = 0.1, cycle_high_share = 0.9;

}  // namespace tuft

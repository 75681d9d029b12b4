#pragma once
/// What a tension test gives: rows as measured, and the figures read from them.
#include <cstdint>
#include <optional>
#include <span>

namespace tuft::rigs {

/// One row, at the moment of the force. Engineering measures: force over the section as cut, elongation over
/// the gauge length.
struct TensionRow {
  double time = 0;              ///< s since the test began
  double strain = 0;            ///< engineering
  double stress = 0;            ///< Pa, engineering, of the driven grip's force
  double true_stress = 0;       ///< Pa, stress (1 + strain): as if the volume stayed
  double force = 0;             ///< N, on the driven grip
  double force_held = 0;        ///< N, on the held grip, the same while nothing is accelerated
  double principal_strain = 0;  ///< largest principal logarithmic strain of the middle of any shell
  bool failed = false;
};

struct TensionResults {
  double initial_modulus = 0;  ///< Pa, of engineering stress between 0.05 % and 0.25 % (as ISO 527-1)
  /// Pa, engineering, at 5, 10 and 20 % engineering strain; empty where the test ended or failed before.
  std::optional<double> stress_at_5, stress_at_10, stress_at_20;
  double peak_stress = 0;     ///< Pa, engineering
  double strain_at_peak = 0;  ///< engineering
  /// Last row before the first failed one.
  std::optional<double> strain_at_failure, stress_at_failure;
};

/// The rows before the first failed one.
[[nodiscard]] std::span<const TensionRow> whole_rows(std::span<const TensionRow> rows);

/// Whole rows without which nothing can be said of a test.
inline constexpr std::size_t fewest_whole_rows = 2;

/// Pure evaluation of a test's rows, in order of time; at least `fewest_whole_rows` of them are whole.
[[nodiscard]] TensionResults evaluate_tension(std::span<const TensionRow> rows);

/// Engineering stress at a strain, linear between rows; empty outside of them.
[[nodiscard]] std::optional<double> stress_at(std::span<const TensionRow> rows, double strain);

}  // namespace tuft::rigs

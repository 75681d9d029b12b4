#include "rigs/tension_results.h"

#include <algorithm>

namespace tuft::rigs {
namespace {

constexpr double modulus_from = 0.0005, modulus_to = 0.0025;  // ISO 527-1, secant modulus

}  // namespace

std::span<const TensionRow> whole_rows(std::span<const TensionRow> rows) {
  const auto first_failed =
      std::find_if(rows.begin(), rows.end(), [](const TensionRow& row) { return row.failed; });
  return rows.first(static_cast<std::size_t>(first_failed - rows.begin()));
}

std::optional<double> stress_at(std::span<const TensionRow> rows, double strain) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const TensionRow &a = rows[i - 1], &b = rows[i];
    if (strain < a.strain || strain > b.strain || !(b.strain > a.strain)) continue;
    return a.stress + (b.stress - a.stress) * (strain - a.strain) / (b.strain - a.strain);
  }
  return std::nullopt;
}

TensionResults evaluate_tension(std::span<const TensionRow> rows) {
  TensionResults results;
  const auto whole = whole_rows(rows);
  if (whole.size() < rows.size() && !whole.empty()) {
    results.strain_at_failure = whole.back().strain;
    results.stress_at_failure = whole.back().stress;
  }
  results.stress_at_5 = stress_at(whole, 0.05);
  results.stress_at_10 = stress_at(whole, 0.10);
  results.stress_at_20 = stress_at(whole, 0.20);
  const auto low = stress_at(whole, modulus_from), high = stress_at(whole, modulus_to);
  if (low && high)
    results.initial_modulus = (*high - *low) / (modulus_to - modulus_from);
  else if (whole.size() > 1 && whole[1].strain > whole[0].strain)
    results.initial_modulus = (whole[1].stress - whole[0].stress) / (whole[1].strain - whole[0].strain);
  const auto peak = std::max_element(
      rows.begin(), rows.end(), [](const TensionRow& a, const TensionRow& b) { return a.stress < b.stress; });
  if (peak != rows.end()) {
    results.peak_stress = peak->stress;
    results.strain_at_peak = peak->strain;
  }
  return results;
}

}  // namespace tuft::rigs

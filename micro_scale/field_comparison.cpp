#include "micro_scale/field_comparison.h"

#include <algorithm>
#include <cmath>

namespace tuft::micro {

FieldComparison compare_fields(std::span<const double> a, std::span<const double> b,
                               std::span<const char> taken) {
  FieldComparison result;
  double sum_a = 0, sum_b = 0, square = 0, middle = 0;
  for (std::size_t c = 0; c < a.size(); ++c) {
    if (taken[c] == 0) continue;
    ++result.cells;
    sum_a += a[c], sum_b += b[c];
    square += (a[c] - b[c]) * (a[c] - b[c]);
    middle += 0.25 * (a[c] + b[c]) * (a[c] + b[c]);
  }
  if (result.cells == 0) return result;
  const auto count = static_cast<double>(result.cells);
  result.mean_a = sum_a / count, result.mean_b = sum_b / count;
  result.difference = std::sqrt(square / count);
  if (middle > 0) result.relative = std::sqrt(square / middle);
  double aa = 0, bb = 0, ab = 0;
  for (std::size_t c = 0; c < a.size(); ++c) {
    if (taken[c] == 0) continue;
    const double x = a[c] - result.mean_a, y = b[c] - result.mean_b;
    aa += x * x, bb += y * y, ab += x * y;
  }
  if (aa > 0 && bb > 0) result.correlation = ab / std::sqrt(aa * bb);
  return result;
}

std::vector<char> filled_in_both(std::span<const double> density_a, std::span<const double> density_b,
                                 double share) {
  double largest = 0;
  for (const auto& field : {density_a, density_b})
    for (const double value : field) largest = std::max(largest, value);
  std::vector<char> filled(density_a.size());
  for (std::size_t c = 0; c < filled.size(); ++c)
    filled[c] = std::min(density_a[c], density_b[c]) >= share * largest && largest > 0;
  return filled;
}

std::vector<double> profile(const CoarseGrid& grid, std::span<const double> field, std::size_t components,
                            std::size_t component) {
  const std::size_t layer = static_cast<std::size_t>(grid.cells[0]) * static_cast<std::size_t>(grid.cells[1]);
  std::vector<double> means(static_cast<std::size_t>(grid.cells[2]), 0);
  for (std::size_t k = 0; k < means.size(); ++k) {
    for (std::size_t c = k * layer; c < (k + 1) * layer; ++c) means[k] += field[components * c + component];
    means[k] /= static_cast<double>(layer);
  }
  return means;
}

}  // namespace tuft::micro

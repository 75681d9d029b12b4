#pragma once
/// Two fields on one grid, cell by cell, and fields by height.
#include <cstddef>
#include <span>
#include <vector>

#include "micro_scale/coarse_grid.h"

namespace tuft::micro {

struct FieldComparison {
  std::size_t cells = 0;  ///< that were compared
  double mean_a = 0, mean_b = 0;
  double difference = 0;   ///< root mean square of a - b, in the field's unit
  double relative = 0;     ///< over the root mean square of (a + b)/2; 0 where that is 0
  double correlation = 0;  ///< Pearson's; 0 where one of them is constant
};
/// Over the cells with taken[c] != 0; all three of one size.
[[nodiscard]] FieldComparison compare_fields(std::span<const double> a, std::span<const double> b,
                                             std::span<const char> taken);

/// Cells in which both fields of density reach this share of the larger of their largest values: where both
/// have infill.
[[nodiscard]] std::vector<char> filled_in_both(std::span<const double> density_a,
                                               std::span<const double> density_b, double share);

/// Mean over each layer of cells, lowest first. `components` numbers a cell, of which `component` is taken.
[[nodiscard]] std::vector<double> profile(const CoarseGrid& grid, std::span<const double> field,
                                          std::size_t components = 1, std::size_t component = 0);

}  // namespace tuft::micro

#include "micro_scale/coarse_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tuft::micro {

CoarseGrid make_grid(const Vec3& low, const Vec3& high, double cell) {
  CoarseGrid grid;
  grid.low = low;
  for (int c = 0; c < 3; ++c) {
    const double length = high[c] - low[c];
    grid.cells[static_cast<std::size_t>(c)] = std::max(1, static_cast<int>(std::lround(length / cell)));
    grid.spacing[c] = length / grid.cells[static_cast<std::size_t>(c)];
  }
  return grid;
}

double Kernel::operator()(double distance) const {
  const double a = distance / cutoff;
  if (a >= 1) return 0;
  const double rest = 1 - a;
  return 105 / (16 * std::numbers::pi * cutoff * cutoff * cutoff) * (1 + 3 * a) * rest * rest * rest;
}

void spread_point(const CoarseGrid& grid, const Kernel& kernel, const Vec3& point, Spread& spread) {
  spread.cell.clear();
  spread.share.clear();
  const Vec3 at = point.cwiseMax(grid.low).cwiseMin(grid.high());
  std::array<int, 3> first{}, last{};
  for (int c = 0; c < 3; ++c) {
    const auto n = static_cast<std::size_t>(c);
    const double middle = (at[c] - grid.low[c]) / grid.spacing[c] - 0.5,
                 reach = kernel.cutoff / grid.spacing[c];
    first[n] = std::max(0, static_cast<int>(std::ceil(middle - reach)));
    last[n] = std::min(grid.cells[n] - 1, static_cast<int>(std::floor(middle + reach)));
  }
  double sum = 0;
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) {
        const double weight = kernel((grid.centre(i, j, k) - at).norm());
        if (weight == 0) continue;
        spread.cell.push_back(grid.index(i, j, k));
        spread.share.push_back(weight);
        sum += weight;
      }
  for (double& share : spread.share) share /= sum;
}

}  // namespace tuft::micro

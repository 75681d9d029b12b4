#pragma once
#include <algorithm>
#include <cmath>
#include <span>

namespace tuft::coupler {

/// Largest speed of a set of points, m/s; components in arrays of one length.
[[nodiscard]] inline double fastest(std::span<const double> x, std::span<const double> y,
                                    std::span<const double> z) {
  double squared = 0;
#pragma omp parallel for simd schedule(static) reduction(max : squared) if (x.size() > 4096)
  for (std::size_t i = 0; i < x.size(); ++i)
    squared = std::max(squared, x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
  return std::sqrt(squared);
}

}  // namespace tuft::coupler

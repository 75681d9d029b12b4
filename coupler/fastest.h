#pragma once
#include <cmath>
#include <span>

#include "core/parallel.h"

namespace tuft::coupler {

/// Largest speed of a set of points, m/s; components in arrays of one length.
[[nodiscard]] inline double fastest(std::span<const double> x, std::span<const double> y,
                                    std::span<const double> z) {
  return std::sqrt(
      largest_of(x.size(), [&](std::size_t i) { return x[i] * x[i] + y[i] * y[i] + z[i] * z[i]; }));
}

}  // namespace tuft::coupler

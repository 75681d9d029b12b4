#pragma once
/// Sums of the kernel's slope over whole rows of an orthogonal lattice.
#include <array>

#include "core/scene.h"

namespace tuft::sph {

/// Slope along the rows' normal, summed over a row at a distance (m, >= 0) whose particles are `across` apart
/// in its plane (m), 1/m^4.
[[nodiscard]] double row_slope(const SphOptions& options, double distance, std::array<double, 2> across);

}  // namespace tuft::sph

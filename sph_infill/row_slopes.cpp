#include "sph_infill/row_slopes.h"

#include "sph_infill/kernel.h"

namespace tuft::sph {
namespace {

template <class KernelType>
double sum_over_row(const KernelType& kernel, double distance, std::array<double, 2> across) {
  const double reach = 2 * kernel.h;
  double sum = 0;
  const auto span = [&](int axis) {
    return static_cast<int>(reach / across[static_cast<std::size_t>(axis)]);
  };
  for (int a = -span(0); a <= span(0); ++a)
    for (int b = -span(1); b <= span(1); ++b) {
      const double x = a * across[0], y = b * across[1];
      sum += kernel.slope_over_distance(x * x + y * y + distance * distance);
    }
  return -distance * sum;
}

}  // namespace

double row_slope(const SphOptions& options, double distance, std::array<double, 2> across) {
  return options.kernel == Kernel::wendland_c2
             ? sum_over_row(WendlandC2(options.smoothing_length), distance, across)
             : sum_over_row(CubicSpline(options.smoothing_length), distance, across);
}

}  // namespace tuft::sph

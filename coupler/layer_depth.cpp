#include "coupler/layer_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tuft::coupler {

std::vector<double> layer_tops(const ParticleView& particles, std::array<double, 2> size, double floor,
                               std::size_t layers) {
  std::vector<double> tops(layers, 0.0);
  if (particles.size() == 0) return tops;
  constexpr double nothing = -std::numeric_limits<double>::infinity();
  for (std::size_t layer = 0; layer < layers; ++layer) {
    double radius = 0, count = 0;
    for (std::size_t i = 0; i < particles.size(); ++i)
      if (particles.layer[i] == static_cast<Index>(layer)) {
        radius += particles.radius[i];
        ++count;
      }
    if (count == 0) {
      tops[layer] = layer > 0 ? tops[layer - 1] : 0;
      continue;
    }
    const double side = 4 * radius / count;
    const auto nx = std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(size[0] / side));
    const auto ny = std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(size[1] / side));
    std::vector<double> highest(static_cast<std::size_t>(nx * ny), nothing);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (particles.layer[i] > static_cast<Index>(layer) || particles.is_expelled(i)) continue;
      const auto cx =
          static_cast<std::ptrdiff_t>(std::floor((particles.x[i] / size[0] + 0.5) * static_cast<double>(nx)));
      const auto cy =
          static_cast<std::ptrdiff_t>(std::floor((particles.y[i] / size[1] + 0.5) * static_cast<double>(ny)));
      if (cx < 0 || cx >= nx || cy < 0 || cy >= ny) continue;
      double& top = highest[static_cast<std::size_t>(cx * ny + cy)];
      top = std::max(top, particles.z[i] + particles.radius_upwards(i));
    }
    std::erase(highest, nothing);
    if (highest.empty()) continue;
    const auto middle = highest.begin() + static_cast<std::ptrdiff_t>(highest.size() / 2);
    std::nth_element(highest.begin(), middle, highest.end());
    tops[layer] = *middle - floor;
  }
  return tops;
}

}  // namespace tuft::coupler

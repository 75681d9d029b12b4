#include "coupler/layer_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tuft::coupler {

std::vector<double> layer_tops(const ParticleView& particles, std::array<double, 2> size, double floor,
                               std::size_t layers) {
  std::vector<double> tops(layers, 0.0);
  if (particles.size() == 0) return tops;
  double radius = 0;
  for (const double r : particles.radius) radius += r / static_cast<double>(particles.size());
  const auto cells = [&](double length) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(length / (4 * radius)));
  };
  const std::size_t nx = cells(size[0]), ny = cells(size[1]);
  const auto cell = [](double x, double length, std::size_t count) {
    const double place = (x / length + 0.5) * static_cast<double>(count);
    return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(count) - 1));
  };
  constexpr double nothing = -std::numeric_limits<double>::infinity();
  std::vector<double> highest(nx * ny, nothing);
  for (std::size_t layer = 0; layer < layers; ++layer) {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (particles.layer[i] != static_cast<Index>(layer)) continue;
      double& top = highest[cell(particles.x[i], size[0], nx) * ny + cell(particles.y[i], size[1], ny)];
      top = std::max(top, particles.z[i] + particles.radius[i]);
    }
    std::vector<double> filled;
    for (const double top : highest)
      if (top > nothing) filled.push_back(top);
    if (filled.empty()) continue;
    const auto middle = filled.begin() + static_cast<std::ptrdiff_t>(filled.size() / 2);
    std::nth_element(filled.begin(), middle, filled.end());
    tops[layer] = *middle - floor;
  }
  return tops;
}

}  // namespace tuft::coupler

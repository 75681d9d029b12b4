#include "coupler/particle_grid.h"

#include <algorithm>
#include <cmath>

namespace tuft::coupler {

ParticleGrid::ParticleGrid(const ParticleView& particles, double cell) : side_(cell) {
  const std::size_t n = particles.size();
  if (n == 0) return;
  Vec3 low = particles.position(0), high = low;
  for (std::size_t i = 1; i < n; ++i) {
    low = low.cwiseMin(particles.position(i));
    high = high.cwiseMax(particles.position(i));
  }
  origin_ = low;
  constexpr double most_cells = 4194304;
  for (;;) {
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis) cells *= std::floor((high[axis] - low[axis]) / side_) + 1;
    if (cells <= most_cells) break;
    side_ *= 1.5;
  }
  for (int axis = 0; axis < 3; ++axis)
    count_[axis] = static_cast<Index>(std::floor((high[axis] - low[axis]) / side_)) + 1;

  std::vector<std::size_t> cell_index(n);
  start_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2] + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    cell_index[i] =
        (static_cast<std::size_t>(cell_of(particles.z[i], 2)) * count_[1] + cell_of(particles.y[i], 1)) *
            count_[0] +
        cell_of(particles.x[i], 0);
    ++start_[cell_index[i] + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
  order_.resize(n);
  for (std::size_t i = 0; i < n; ++i) order_[next[cell_index[i]]++] = static_cast<Index>(i);
}

}  // namespace tuft::coupler

#include "sph_infill/neighbour_list.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

namespace tuft::sph {
namespace {

/// Cells smaller than the reach waste fewer candidates: 5^3 half cells hold 0.58 of what 3^3 whole ones do.
constexpr std::size_t cells_per_reach = 2;

/// Share [begin, end) of `count` that thread `k` of `parts` works on.
std::array<std::size_t, 2> share_of(std::size_t count, std::size_t k, std::size_t parts) {
  return {count * k / parts, count * (k + 1) / parts};
}

}  // namespace

NeighbourList::NeighbourList(const Vec3Array& positions, double support, double skin)
    : reach_(support + skin), skin_(skin), cell_size_(reach_ / cells_per_reach) {
  const std::array<const std::vector<double>*, 3> component{&positions.x, &positions.y, &positions.z};
  for (std::size_t d = 0; d < 3; ++d) {
    const auto [low, high] = std::minmax_element(component[d]->begin(), component[d]->end());
    // Room on each side before particles begin to share the outermost cells.
    low_[d] = *low - reach_;
    cells_[d] = static_cast<std::size_t>((*high - low_[d] + reach_) / cell_size_) + 1;
  }
}

std::array<std::size_t, 3> NeighbourList::cell_of(double x, double y, double z) const {
  const auto along = [this](double value, std::size_t d) {
    // Clamping keeps neighbouring cells neighbours, so no pair is lost outside the grid.
    return static_cast<std::size_t>(
        std::clamp(std::floor((value - low_[d]) / cell_size_), 0.0, static_cast<double>(cells_[d] - 1)));
  };
  return {along(x, 0), along(y, 1), along(z, 2)};
}

void NeighbourList::sort_into_cells(const Vec3Array& positions) {
  const std::size_t n = positions.size();
  std::vector<std::size_t>& begin = cell_begin_;
  begin.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
  const auto index_of = [&](std::size_t i) {
    const auto c = cell_of(positions.x[i], positions.y[i], positions.z[i]);
    return (c[0] * cells_[1] + c[1]) * cells_[2] + c[2];
  };
  for (std::size_t i = 0; i < n; ++i) ++begin[index_of(i) + 1];
  for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
  cell_particle_.resize(n);
  if (cell_position_.size() != n) cell_position_.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t slot = begin[index_of(i)]++;
    cell_particle_[slot] = static_cast<Index>(i);
    cell_position_.set(slot, positions[i]);
  }
  // Filling has moved each start to the next cell's.
  for (std::size_t c = begin.size() - 1; c > 0; --c) begin[c] = begin[c - 1];
  begin[0] = 0;
}

void NeighbourList::find_row(std::size_t i, std::vector<Index>& found) const {
  const double x = reference_.x[i], y = reference_.y[i], z = reference_.z[i], reach_squared = reach_ * reach_;
  const auto cell = cell_of(x, y, z);
  const auto low = [&](std::size_t d) { return cell[d] - std::min(cells_per_reach, cell[d]); };
  const auto high = [&](std::size_t d) { return std::min(cell[d] + cells_per_reach, cells_[d] - 1); };
  const std::size_t first = found.size();
  for (std::size_t cx = low(0); cx <= high(0); ++cx)
    for (std::size_t cy = low(1); cy <= high(1); ++cy) {
      const std::size_t column = (cx * cells_[1] + cy) * cells_[2];
      const std::size_t begin = cell_begin_[column + low(2)], end = cell_begin_[column + high(2) + 1];
      std::size_t size = found.size();
      found.resize(size + (end - begin));
      for (std::size_t k = begin; k < end; ++k) {
        const double dx = cell_position_.x[k] - x, dy = cell_position_.y[k] - y, dz = cell_position_.z[k] - z;
        const Index j = cell_particle_[k];
        found[size] = j;  // kept only if the count moves on: no branch to mispredict
        size += static_cast<std::size_t>((dx * dx + dy * dy + dz * dz < reach_squared) &
                                         (j != static_cast<Index>(i)));
      }
      found.resize(size);
    }
  std::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end());
  while ((found.size() - first) % row_multiple != 0) found.push_back(static_cast<Index>(i));
}

void NeighbourList::build(const Vec3Array& positions) {
  const std::size_t n = positions.size();
  reference_ = positions;
  sort_into_cells(positions);
  begin_.resize(n + 1);
  begin_[0] = 0;
  part_.resize(static_cast<std::size_t>(omp_get_max_threads()));
#pragma omp parallel num_threads(static_cast <int>(part_.size()))
  {
    const auto parts = static_cast<std::size_t>(omp_get_num_threads());
    const auto k = static_cast<std::size_t>(omp_get_thread_num());
    const auto [begin, end] = share_of(n, k, parts);
    std::vector<Index>& found = part_[k];
    found.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t before = found.size();
      find_row(i, found);
      begin_[i + 1] = found.size() - before;
    }
#pragma omp barrier
#pragma omp single
    {
      for (std::size_t i = 0; i < n; ++i) begin_[i + 1] += begin_[i];
      pairs_.resize(begin_[n]);
    }
    std::copy(found.begin(), found.end(), pairs_.begin() + static_cast<std::ptrdiff_t>(begin_[begin]));
  }
}

}  // namespace tuft::sph

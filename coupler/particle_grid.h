#pragma once
/// Uniform grid over particles for contact searches: which particles lie in a box.
#include <array>
#include <vector>

#include "core/infill.h"

namespace tuft::coupler {

class ParticleGrid {
 public:
  /// Sorts the particles into cells of side `cell` (m, > 0). At most 2^22 cells: the side grows when the
  /// cloud is wide.
  ParticleGrid(const ParticleView& particles, double cell);

  /// Calls visit(index) for every particle in cells that meet the box, in a fixed order.
  template <class Visit>
  void for_each_in_box(const Vec3& low, const Vec3& high, Visit&& visit) const {
    if (order_.empty()) return;
    std::array<Index, 3> from{}, to{};
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = cell_of(low[axis], axis);
      to[axis] = cell_of(high[axis], axis);
    }
    for (Index k = from[2]; k <= to[2]; ++k)
      for (Index j = from[1]; j <= to[1]; ++j) {
        const std::size_t row = (static_cast<std::size_t>(k) * count_[1] + j) * count_[0];
        for (std::size_t s = start_[row + from[0]]; s < start_[row + to[0] + 1]; ++s) visit(order_[s]);
      }
  }

 private:
  [[nodiscard]] Index cell_of(double coordinate, int axis) const {
    const double cell = (coordinate - origin_[axis]) / side_;
    if (!(cell > 0)) return 0;
    return cell >= count_[axis] ? count_[axis] - 1 : static_cast<Index>(cell);
  }
  Vec3 origin_{0, 0, 0};
  double side_ = 1;
  std::array<Index, 3> count_{1, 1, 1};
  std::vector<std::size_t> start_;
  std::vector<Index> order_;
};

}  // namespace tuft::coupler

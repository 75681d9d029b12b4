#pragma once
/// A regular grid over a patch of turf, and the kernel that spreads points over its cells.
#include <array>
#include <cstddef>
#include <vector>

#include "core/vector.h"

namespace tuft::micro {

/// Cells of one size, x fastest: cell (i, j, k) has the index i + nx (j + ny k).
struct CoarseGrid {
  Vec3 low{0, 0, 0};           ///< m, corner of the first cell
  Vec3 spacing{0, 0, 0};       ///< m, edges of a cell, > 0
  std::array<int, 3> cells{};  ///< > 0
  /// m, >= 0: what lies beyond the rim by no more belongs to the grid, and counts as on the rim. For rows of
  /// a lattice whose centres lie on walls that give way.
  double margin = 0;

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
           static_cast<std::size_t>(cells[2]);
  }
  [[nodiscard]] std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(cells[0]) *
               (static_cast<std::size_t>(j) +
                static_cast<std::size_t>(cells[1]) * static_cast<std::size_t>(k));
  }
  [[nodiscard]] Vec3 centre(int i, int j, int k) const {
    return low + spacing.cwiseProduct(Vec3(i + 0.5, j + 0.5, k + 0.5));
  }
  [[nodiscard]] double cell_volume() const { return spacing.prod(); }  ///< m^3
  [[nodiscard]] Vec3 high() const { return low + spacing.cwiseProduct(Vec3(cells[0], cells[1], cells[2])); }
  [[nodiscard]] bool holds(const Vec3& point) const {
    return (point.array() >= low.array() - margin).all() && (point.array() <= high().array() + margin).all();
  }
};

/// Cells of about `cell` (m) over a box; in each direction a whole number of them fits.
[[nodiscard]] CoarseGrid make_grid(const Vec3& low, const Vec3& high, double cell);

/// Lucy's kernel (Lucy 1977, Astron. J. 82, 1013), of compact support and two continuous derivatives:
///     phi(r) = 105/(16 pi c^3) (1 + 3 a)(1 - a)^3,   a = r/c < 1,
/// with the cutoff c twice the coarse-graining width (Weinhart et al. 2016, Powder Technol. 293, 138).
struct Kernel {
  double cutoff = 0;                                       ///< m
  [[nodiscard]] double operator()(double distance) const;  ///< 1/m^3
};
[[nodiscard]] inline Kernel lucy_kernel(double width) {
  return {2 * width};
}

/// The share of a point in each cell.
struct Spread {
  std::vector<std::size_t> cell;
  std::vector<double> share;  ///< they add up to 1
};

/// Weighs the cells whose centres lie within the cutoff by the kernel there, and divides by the sum of the
/// weights: what a point carries is then found again on the grid to rounding. Inside the grid the sum is
/// 1/cell_volume up to the error of the midpoint rule, so that values at the centres are those of the
/// continuous kernel; near the rim what would lie beyond it is given to the cells that are there, as walls
/// keep it. A point outside the grid counts as the nearest point of its rim. The cutoff must be at least the
/// diagonal of a cell. `spread` is emptied first; its memory is kept.
void spread_point(const CoarseGrid& grid, const Kernel& kernel, const Vec3& point, Spread& spread);

}  // namespace tuft::micro

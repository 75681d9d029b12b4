#pragma once
/// Neighbour (Verlet) list from a cell list, with a skin so that it serves many steps.
#include <array>
#include <span>
#include <vector>

#include "core/vector.h"

namespace tuft::sph {

/// Rows are sorted by index and depend only on the positions of the last build, never on cells or threads, so
/// that sums over a row have the same bits after a checkpoint as without one: rebuild from `reference()`.
class NeighbourList {
 public:
  /// Row lengths are multiples of this: loops over a row are whole vectors. The rest of a row names the
  /// particle itself, whose pair terms are exact zeros.
  static constexpr std::size_t row_multiple = 8;

  NeighbourList() = default;
  /// support: m, pairs closer than this are in the list. skin: m, how much farther it looks. The box of
  /// `positions` sizes the cells' grid; particles that leave it later share its outermost cells, which is
  /// correct, only slower.
  NeighbourList(const Vec3Array& positions, double support, double skin);

  /// Lists all pairs closer than support + skin.
  void build(const Vec3Array& positions);

  /// While no particle has moved farther than half the skin from `reference()`, no pair within the support is
  /// missed.
  [[nodiscard]] double allowed_displacement() const { return 0.5 * skin_; }
  [[nodiscard]] const Vec3Array& reference() const { return reference_; }
  [[nodiscard]] std::span<const Index> row(std::size_t i) const {
    return {pairs_.data() + begin_[i], pairs_.data() + begin_[i + 1]};
  }

 private:
  void sort_into_cells(const Vec3Array& positions);
  [[nodiscard]] std::array<std::size_t, 3> cell_of(double x, double y, double z) const;
  void find_row(std::size_t i, std::vector<Index>& found) const;

  double reach_ = 0, skin_ = 0, cell_size_ = 1;
  std::array<double, 3> low_{};
  std::array<std::size_t, 3> cells_{1, 1, 1};
  Vec3Array reference_;
  std::vector<std::size_t> cell_begin_;  ///< particles of a cell in cell order; z runs fastest
  Vec3Array cell_position_;              ///< positions in cell order
  std::vector<Index> cell_particle_;
  std::vector<std::size_t> begin_;  ///< rows
  std::vector<Index> pairs_;
  std::vector<std::vector<Index>> part_;  ///< rows of each thread's share before they are joined
};

}  // namespace tuft::sph

#include "sph_infill/neighbour_list.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"

namespace tuft::sph {
namespace {

/// Smaller cells waste fewer candidates, larger ones are fewer to look into. Along z, where those of a column follow each
/// other, there is no more to look into.
constexpr std::array<double, 3> cells_per_reach{3, 3, 6};

}  // namespace

NeighbourList::NeighbourList(const Vec3Array& positions, double support, double skin)
    : support_(support), skin_(skin), next_skin_(skin), reach_(support + skin) {
  if (positions.size() > RowEntry::most)
    throw_input_error("{} particles; there may be {} at most: choose a coarser pitch or a smaller bed",
                      positions.size(), RowEntry::most);
  const std::array<const std::vector<double>*, 3> component{&positions.x, &positions.y, &positions.z};
  for (std::size_t d = 0; d < 3; ++d) {
    const auto [low, high] = std::minmax_element(component[d]->begin(), component[d]->end());
    box_low_[d] = *low, box_high_[d] = *high;
  }
}

/// By what is searched beside a group.
void NeighbourList::size_cells() {
  for (std::size_t d = 0; d < 3; ++d) {
    cell_size_[d] = (reach_ + half_extent_[d]) / cells_per_reach[d];
    // Room on each side before particles begin to share the outermost cells.
    low_[d] = box_low_[d] - reach_;
    cells_[d] = static_cast<std::size_t>((box_high_[d] - low_[d] + reach_) / cell_size_[d]) + 1;
  }
}

std::array<std::size_t, 3> NeighbourList::cell_of(double x, double y, double z) const {
  const auto along = [this](double value, std::size_t d) {
    // Clamping keeps the order of what it clamps, so no pair is lost outside the grid.
    return static_cast<std::size_t>(
        std::clamp(std::floor((value - low_[d]) / cell_size_[d]), 0.0, static_cast<double>(cells_[d] - 1)));
  };
  return {along(x, 0), along(y, 1), along(z, 2)};
}

bool NeighbourList::is_compact(const Box& box) const {
  for (std::size_t d = 0; d < 3; ++d)
    if (!(box.extent(d) <= compact_extent_[d])) return false;
  return box.low[0] <= box.high[0];
}

/// Groups little larger than most are found by their middles. Where most have been scattered, so that a search which
/// allows for their size would take in much, none is.
void NeighbourList::choose_compact_extent(std::span<const Box> boxes) {
  std::array<double, 3> sum{};
  std::size_t count = 0;
  for (const Box& box : boxes) {
    if (!(box.low[0] <= box.high[0])) continue;  // all left out
    ++count;
    for (std::size_t d = 0; d < 3; ++d) sum[d] += box.extent(d);
  }
  double searched = 1;  // over what is searched for the particles of a group one by one
  for (std::size_t d = 0; d < 3; ++d) {
    compact_extent_[d] = 1.25 * sum[d] / static_cast<double>(std::max<std::size_t>(count, 1)) + 0.5 * reach_;
    searched *= (compact_extent_[d] + reach_) / reach_;
  }
  constexpr double most_searched = 3;
  if (searched > most_searched * group_size) compact_extent_.fill(-1);
  half_extent_.fill(0);
  for (const Box& box : boxes)
    if (is_compact(box))
      for (std::size_t d = 0; d < 3; ++d) half_extent_[d] = std::max(half_extent_[d], 0.5 * box.extent(d));
}

void NeighbourList::sort_into_cells(const Vec3Array& positions) {
  const std::size_t n = positions.size();
  std::vector<Box>& boxes = boxes_;
  boxes.resize((n + group_size - 1) / group_size);
  parallel_for(boxes.size(), [&](std::size_t g) {
    boxes[g] = box_of(positions, g * group_size, std::min(n, (g + 1) * group_size));
  });
  choose_compact_extent(boxes);
  size_cells();

  cell_entries_.clear();  // of cell and group
  const auto enter = [&](double x, double y, double z, std::size_t g) {
    const auto c = cell_of(x, y, z);
    cell_entries_.push_back({static_cast<std::uint32_t>((c[0] * cells_[1] + c[1]) * cells_[2] + c[2]),
                             static_cast<Index>(g)});
  };
  for (std::size_t g = 0; g < boxes.size(); ++g) {
    const Box& box = boxes[g];
    if (is_compact(box)) {
      enter(box.middle(0), box.middle(1), box.middle(2), g);
      continue;
    }
    for (std::size_t i = g * group_size; i < std::min(n, (g + 1) * group_size); ++i)
      if (!is_left_out(i)) enter(positions.x[i], positions.y[i], positions.z[i], g);
  }
  std::vector<std::uint32_t>& begin = cell_begin_;
  begin.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
  for (const CellEntry& entry : cell_entries_) ++begin[entry.cell + 1];
  for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
  cell_group_.resize(cell_entries_.size());
  for (const CellEntry& entry : cell_entries_) cell_group_[begin[entry.cell]++] = entry.group;
  // Filling has moved each start to the next cell's.
  for (std::size_t c = begin.size() - 1; c > 0; --c) begin[c] = begin[c - 1];
  begin[0] = 0;
}

void NeighbourList::begin(const Vec3Array& positions) {
  skin_ = next_skin_;
  reach_ = support_ + skin_;
  sort_into_cells(positions);
  blocks_.resize((positions.size() + block_size - 1) / block_size);
  ++begun_;
}

// A particle has moved by up to skin/2 since its group was sorted into a cell, which the search allows for: rows are those of the present positions, whenever they are made. Their particles may move on by less than
// skin/2.
std::span<const Index> NeighbourList::complete(const Vec3Array& positions, std::span<const Index> blocks) {
  to_make_.clear();
  for (const Index b : blocks)
    if (blocks_[static_cast<std::size_t>(b)].made != begun_) to_make_.push_back(b);
  parallel_for(to_make_.size(),
               [&](std::size_t k) { make_rows(positions, static_cast<std::size_t>(to_make_[k])); });
  return to_make_;
}

void NeighbourList::build(const Vec3Array& positions) {
  if (keeps_places_) places_ = positions;
  begin(positions);
  parallel_for(blocks_.size(), [&](std::size_t b) { make_rows(positions, b); });
}

std::vector<Index> NeighbourList::row(std::size_t i) const {
  const GroupRows rows = group(i / group_size);
  std::vector<Index> others;
  for (std::size_t k = 0; k < rows.length; ++k) {
    const std::size_t j = rows.first[k * group_size + i % group_size].index();
    if (j != i) others.push_back(static_cast<Index>(j));
  }
  return others;
}

}  // namespace tuft::sph

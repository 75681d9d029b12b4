#include "sph_infill/neighbour_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"

namespace tuft::sph {
namespace {

/// Smaller cells waste fewer candidates, larger ones are fewer to look into. Along z, where those of a column
/// follow each other, there is no more to look into.
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

/// By what is searched beside a run; no more cells than particles, as far as these lie in the box.
void NeighbourList::size_cells(std::size_t particles) {
  double cell = 1, box = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    cell_size_[d] = (reach_ + half_extent_[d]) / cells_per_reach[d];
    cell *= cell_size_[d], box *= box_high_[d] - box_low_[d] + 2 * reach_;
  }
  const double larger = std::cbrt(std::max(1.0, box / (cell * static_cast<double>(particles))));
  for (std::size_t d = 0; d < 3; ++d) {
    cell_size_[d] *= larger;
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

void NeighbourList::Box::include(const std::array<double, 3>& point) {
  for (std::size_t d = 0; d < 3; ++d)
    low[d] = std::min(low[d], point[d]), high[d] = std::max(high[d], point[d]);
}

NeighbourList::Run NeighbourList::run_from(const Vec3Array& positions, std::size_t begin,
                                           const std::array<double, 3>& extent) const {
  const std::size_t group_end = std::min(positions.size(), (begin / group_size + 1) * group_size);
  Run run{{}, begin, begin};
  for (; run.end < group_end; ++run.end) {
    if (is_left_out(run.end)) continue;
    Box longer = run.box;
    longer.include({positions.x[run.end], positions.y[run.end], positions.z[run.end]});
    for (std::size_t d = 0; d < 3; ++d)
      // A single one is a run, be its position not a number.
      if (!run.box.is_empty() && !(longer.extent(d) <= extent[d])) return run;
    run.box = longer;
  }
  return run;
}

/// Runs may be about as large as most groups. Where most groups have been scattered, so that a search that
/// allows for such sizes would take in much, they are small.
void NeighbourList::choose_run_extent(const Vec3Array& positions) {
  const std::size_t n = positions.size(), groups = (n + group_size - 1) / group_size;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<std::vector<double>, 3> extents;
  for (auto& extent : extents) extent.resize(groups);
  parallel_for(groups, [&](std::size_t g) {
    const Run whole = run_from(positions, g * group_size, {infinity, infinity, infinity});
    for (std::size_t d = 0; d < 3; ++d) extents[d][g] = whole.box.is_empty() ? 0 : whole.box.extent(d);
  });
  double searched = 1;  // over what is searched for the particles of a group one by one
  for (std::size_t d = 0; d < 3; ++d) {
    const auto median = extents[d].begin() + static_cast<std::ptrdiff_t>(groups / 2);
    std::nth_element(extents[d].begin(), median, extents[d].end());
    run_extent_[d] = 1.25 * *median + 0.5 * reach_;
    searched *= (run_extent_[d] + reach_) / reach_ / 2;
  }
  if (!(searched < 4)) run_extent_.fill(0.5 * reach_);
}

void NeighbourList::sort_into_cells(const Vec3Array& positions) {
  const std::size_t n = positions.size(), groups = (n + group_size - 1) / group_size;
  choose_run_extent(positions);
  struct Entry {
    std::array<double, 3> middle;
    Index group;
  };
  std::vector<Entry> entries;
  entries.reserve(groups + groups / 2);
  half_extent_.fill(0);
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t i = g * group_size; i < std::min(n, (g + 1) * group_size);) {
      const Run run = run_from(positions, i, run_extent_);
      i = run.end;
      if (run.box.is_empty()) continue;  // left out
      for (std::size_t d = 0; d < 3; ++d)
        half_extent_[d] = std::max(half_extent_[d], 0.5 * run.box.extent(d));
      entries.push_back({{run.box.middle(0), run.box.middle(1), run.box.middle(2)}, static_cast<Index>(g)});
    }
  size_cells(n);
  const auto cell = [this](const Entry& entry) {
    const auto c = cell_of(entry.middle[0], entry.middle[1], entry.middle[2]);
    return (c[0] * cells_[1] + c[1]) * cells_[2] + c[2];
  };
  std::vector<std::uint32_t>& begin = cell_begin_;
  begin.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
  for (const Entry& entry : entries) ++begin[cell(entry) + 1];
  for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
  cell_group_.resize(entries.size());
  for (const Entry& entry : entries) cell_group_[begin[cell(entry)]++] = entry.group;
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

// A particle has moved by up to skin/2 since its group was sorted into a cell, which the search allows for:
// rows are those of the present positions, whenever they are made. Their particles may move on by less than
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

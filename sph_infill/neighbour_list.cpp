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

/// Cells of half the width that is searched waste fewer candidates: 5^3 half cells hold 0.58 of what 3^3
/// whole ones do.
constexpr std::size_t cells_per_reach = 2;

/// Some of 64 particles with consecutive indices.
struct IndexWord {
  std::uint64_t word = 0;  ///< index / 64
  std::uint64_t bits = 0;
};

/// A set of particles. Neighbours have near indices, so that few words hold many: sorting words is far
/// quicker than sorting particles.
class IndexSet {
 public:
  void add(Index j) {
    const auto index = static_cast<std::uint64_t>(j), word = index / 64;
    // A word whose slot another has taken is begun again; sorting joins the two.
    std::uint32_t& slot = slot_[word % slots];
    if (slot == none || words_[slot].word != word) {
      slot = static_cast<std::uint32_t>(words_.size());
      words_.push_back({word, 0});
    }
    words_[slot].bits |= std::uint64_t{1} << (index % 64);
  }
  /// Empties the set.
  void take_sorted(std::vector<Index>& sorted) {
    for (const IndexWord& word : words_) slot_[word.word % slots] = none;
    std::sort(words_.begin(), words_.end(),
              [](const IndexWord& a, const IndexWord& b) { return a.word < b.word; });
    sorted.clear();
    for (std::size_t k = 0; k < words_.size();) {
      const std::uint64_t word = words_[k].word;
      std::uint64_t bits = 0;
      for (; k < words_.size() && words_[k].word == word; ++k) bits |= words_[k].bits;
      for (; bits != 0; bits &= bits - 1)
        sorted.push_back(static_cast<Index>(word * 64 + static_cast<std::uint64_t>(std::countr_zero(bits))));
    }
    words_.clear();
  }

 private:
  static constexpr std::size_t slots = 1024;
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<IndexWord> words_;
  std::vector<std::uint32_t> slot_ = std::vector<std::uint32_t>(slots, none);  ///< place in words_, by word
};

/// Cells from `low` to `high`, both included.
struct CellBox {
  std::array<std::size_t, 3> low, high;

  [[nodiscard]] std::size_t volume() const {
    return (high[0] - low[0] + 1) * (high[1] - low[1] + 1) * (high[2] - low[2] + 1);
  }
  void include(const CellBox& other) {
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], other.low[d]);
      high[d] = std::max(high[d], other.high[d]);
    }
  }
};

}  // namespace

struct NeighbourList::Scratch {
  IndexSet found;
  std::vector<Index> candidates;  ///< of a group, sorted
  std::vector<RowEntry> rows;     ///< of a group, side by side, and room behind them
  std::size_t rows_size = 0;
  std::array<std::size_t, group_size> length{};
  std::vector<RowEntry> entries;  ///< of a block
};

NeighbourList::NeighbourList(const Vec3Array& positions, double support, double skin)
    : support_(support), skin_(skin), next_skin_(skin) {
  if (positions.size() > RowEntry::most)
    throw_input_error("{} particles; there may be {} at most: choose a coarser pitch or a smaller bed",
                      positions.size(), RowEntry::most);
  const std::array<const std::vector<double>*, 3> component{&positions.x, &positions.y, &positions.z};
  for (std::size_t d = 0; d < 3; ++d) {
    const auto [low, high] = std::minmax_element(component[d]->begin(), component[d]->end());
    box_low_[d] = *low, box_high_[d] = *high;
  }
  size_cells();
}

void NeighbourList::size_cells() {
  reach_ = support_ + skin_;
  cell_size_ = (reach_ + 0.5 * skin_) / cells_per_reach;
  for (std::size_t d = 0; d < 3; ++d) {
    // Room on each side before particles begin to share the outermost cells.
    low_[d] = box_low_[d] - reach_;
    cells_[d] = static_cast<std::size_t>((box_high_[d] - low_[d] + reach_) / cell_size_) + 1;
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
  std::vector<std::uint32_t>& begin = cell_begin_;
  begin.assign(cells_[0] * cells_[1] * cells_[2] + 1, 0);
  const auto index_of = [&](std::size_t i) {
    const auto c = cell_of(positions.x[i], positions.y[i], positions.z[i]);
    return (c[0] * cells_[1] + c[1]) * cells_[2] + c[2];
  };
  for (std::size_t i = 0; i < n; ++i)
    if (!is_left_out(i)) ++begin[index_of(i) + 1];
  for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
  cell_particle_.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    if (!is_left_out(i)) cell_particle_[begin[index_of(i)]++] = static_cast<Index>(i);
  // Filling has moved each start to the next cell's.
  for (std::size_t c = begin.size() - 1; c > 0; --c) begin[c] = begin[c - 1];
  begin[0] = 0;
}

/// Particles, sorted by index, among which all neighbours of [begin, end) are.
void NeighbourList::find_candidates(const Vec3Array& positions, std::size_t begin, std::size_t end,
                                    Scratch& scratch) const {
  const auto around = [&](std::size_t i) {
    const auto cell = cell_of(positions.x[i], positions.y[i], positions.z[i]);
    CellBox box;
    for (std::size_t d = 0; d < 3; ++d) {
      box.low[d] = cell[d] - std::min(cells_per_reach, cell[d]);
      box.high[d] = std::min(cell[d] + cells_per_reach, cells_[d] - 1);
    }
    return box;
  };
  const auto add = [&](const CellBox& box) {
    for (std::size_t cx = box.low[0]; cx <= box.high[0]; ++cx)
      for (std::size_t cy = box.low[1]; cy <= box.high[1]; ++cy) {
        const std::size_t column = (cx * cells_[1] + cy) * cells_[2];
        for (std::size_t k = cell_begin_[column + box.low[2]]; k < cell_begin_[column + box.high[2] + 1]; ++k)
          scratch.found.add(cell_particle_[k]);
      }
  };
  CellBox all = around(begin);
  std::size_t apart = all.volume();
  for (std::size_t i = begin + 1; i < end; ++i) {
    const CellBox box = around(i);
    apart += box.volume();
    all.include(box);
  }
  if (all.volume() <= apart) {
    add(all);
  } else {  // particles of the group have been scattered
    for (std::size_t i = begin; i < end; ++i) add(around(i));
  }
  scratch.found.take_sorted(scratch.candidates);
}

/// From rows that are not padded yet.
void NeighbourList::drop_separated(std::size_t begin, std::size_t end, Scratch& scratch) const {
  for (std::size_t i = begin; i < end; ++i) {
    const std::span<const Index> gone = separated_.of(i);
    if (gone.empty()) continue;
    const std::size_t l = i - begin;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < scratch.length[l]; ++k) {
      const RowEntry j = scratch.rows[k * group_size + l];
      if (!std::binary_search(gone.begin(), gone.end(), static_cast<Index>(j.index())))
        scratch.rows[kept++ * group_size + l] = j;
    }
    scratch.length[l] = kept;
  }
}

/// Rows of the group [begin, end), side by side.
void NeighbourList::find_rows(const Vec3Array& positions, std::size_t begin, std::size_t end,
                              Scratch& scratch) const {
  const std::size_t count = end - begin;
  using Packs = std::array<Pack, group_size / lanes>;
  const auto own = [&](const std::vector<double>& values) {
    Packs packs;
    for (std::size_t k = 0; k < packs.size(); ++k)
      packs[k] = Pack([&](std::size_t l) { return values[std::min(begin + k * lanes + l, end - 1)]; });
    return packs;
  };
  const Packs x = own(positions.x), y = own(positions.y), z = own(positions.z);
  const std::size_t room = (scratch.candidates.size() + 1) * group_size;
  if (scratch.rows.size() < room) scratch.rows.resize(room);
  std::array<std::size_t, group_size> next;  // where the next entry of each row goes
  for (std::size_t l = 0; l < group_size; ++l) next[l] = l;
  const double reach_squared = reach_ * reach_;
  alignas(stdx::memory_alignment_v<Pack>) std::array<double, group_size> distance_squared;
  for (const Index j : scratch.candidates) {
    const auto c = static_cast<std::size_t>(j);
    Pack nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Pack dx = x[k] - positions.x[c], dy = y[k] - positions.y[c], dz = z[k] - positions.z[c];
      const Pack squared = dx * dx + dy * dy + dz * dz;
      nearest = stdx::min(nearest, squared);
      store(&distance_squared[k * lanes], squared);
    }
    if (stdx::none_of(nearest < reach_squared)) continue;
    const RowEntry entry(c);
    for (std::size_t l = 0; l < group_size; ++l) {
      scratch.rows[next[l]] = entry;  // kept only if the row grows: no branch to mispredict
      next[l] +=
          group_size * static_cast<std::size_t>((distance_squared[l] < reach_squared) & (c != begin + l));
    }
  }
  for (std::size_t l = 0; l < group_size; ++l)
    scratch.length[l] = l < count && !is_left_out(begin + l) ? next[l] / group_size : 0;
  if (!separated_.empty()) drop_separated(begin, end, scratch);
  const std::size_t longest = *std::max_element(scratch.length.begin(), scratch.length.end());
  for (std::size_t l = 0; l < group_size; ++l)
    for (std::size_t k = scratch.length[l]; k < longest; ++k)
      scratch.rows[k * group_size + l] = RowEntry(std::min(begin + l, end - 1));
  scratch.rows_size = longest * group_size;
}

void NeighbourList::make_rows(const Vec3Array& positions, std::size_t b, const std::uint8_t* chosen) {
  static thread_local Scratch scratch;
  const std::size_t n = positions.size();
  Block& block = blocks_[b];
  scratch.entries.clear();
  std::uint32_t before = 0;  // where the group's rows began
  for (std::size_t g = 0; g < groups_per_block; ++g) {
    const std::size_t begin = b * block_size + g * group_size, end = std::min(n, begin + group_size);
    const std::uint32_t first = std::exchange(before, block.begin[g + 1]);
    if (begin < n && chosen && chosen[b * groups_per_block + g] == 0) {
      scratch.entries.insert(scratch.entries.end(), block.entries.begin() + first,
                             block.entries.begin() + before);
    } else if (begin < n) {
      find_candidates(positions, begin, end, scratch);
      find_rows(positions, begin, end, scratch);
      scratch.entries.insert(scratch.entries.end(), scratch.rows.begin(),
                             scratch.rows.begin() + static_cast<std::ptrdiff_t>(scratch.rows_size));
    }
    block.begin[g + 1] = static_cast<std::uint32_t>(scratch.entries.size());
  }
  block.entries.assign(scratch.entries.begin(), scratch.entries.end());
  block.made = begun_;
}

void NeighbourList::begin(const Vec3Array& positions) {
  if (next_skin_ != skin_) {
    skin_ = next_skin_;
    size_cells();
  }
  sort_into_cells(positions);
  blocks_.resize((positions.size() + block_size - 1) / block_size);
  ++begun_;
}

// A particle has moved by up to skin/2 since it was sorted into its cell, which the size of cells allows for:
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

/// NeighbourList: how rows are made.
///
/// Groups are what is looked for: particles of eight consecutive indices mostly lie together, are found at
/// once, and their positions are loaded side by side. A row's distances to eight candidates are taken by
/// vectors, and which of them are neighbours is a number of eight bits, by which a table says what is to be
/// written: no branch depends on a distance.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/lane_math.h"
#include "sph_infill/neighbour_list.h"

namespace tuft::sph {
namespace {

/// Some of 64 groups with consecutive numbers.
struct IndexWord {
  std::uint64_t word = 0;  ///< number / 64
  std::uint64_t bits = 0;
};

/// A set of groups. Those near each other have near numbers, so that few words hold many: sorting words is
/// far quicker than sorting groups.
class GroupSet {
 public:
  void add(Index group) {
    const auto number = static_cast<std::uint64_t>(group), word = number / 64;
    // A word whose slot another has taken is begun again; sorting joins the two.
    std::uint32_t& slot = slot_[word % slots];
    if (slot == none || words_[slot].word != word) {
      slot = static_cast<std::uint32_t>(words_.size());
      words_.push_back({word, 0});
    }
    words_[slot].bits |= std::uint64_t{1} << (number % 64);
  }
  /// Adds all to `sorted`, ascending, and empties the set.
  void take_sorted(std::vector<Index>& sorted) {
    for (const IndexWord& word : words_) slot_[word.word % slots] = none;
    std::sort(words_.begin(), words_.end(),
              [](const IndexWord& a, const IndexWord& b) { return a.word < b.word; });
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

using Places = stdx::simd<std::uint32_t, stdx::simd_abi::deduce_t<std::uint32_t, group_size>>;

/// For each set of lanes: which they are, ascending, as places in a row.
constexpr auto lanes_of_bits = [] {
  std::array<std::array<std::uint32_t, group_size>, 1U << group_size> table{};
  for (std::uint32_t bits = 0; bits < table.size(); ++bits)
    for (std::uint32_t l = 0, k = 0; l < group_size; ++l)
      if ((bits >> l & 1U) != 0) table[bits][k++] = RowEntry::places * l;
  return table;
}();

/// By lane.
using RowEnds = std::array<std::uint32_t*, group_size>;

/// Writes those of a group's particles that `bits` tells. There is room for all.
[[gnu::always_inline]] inline void append(std::uint32_t*& end, const Places& group, unsigned bits) {
  (group + Places(lanes_of_bits[bits].data(), stdx::element_aligned)).copy_to(end, stdx::element_aligned);
  end += std::popcount(bits);
}

[[nodiscard]] Places places_of_group(std::size_t group) {
  return static_cast<std::uint32_t>(RowEntry::places * group_size * group);
}

/// Records that one of so many blocks has read, this one and those made before it, are taken to be in a near
/// cache yet: some 100 kB. Of 1, 2, 4 and 8 blocks 2 to 8 served best.
constexpr std::uint32_t blocks_remembered = 4;

using Coordinates = std::array<Pack, 3>;

[[nodiscard]] Coordinates everywhere(const Vec3& point) {
  return {Pack(point.x()), Pack(point.y()), Pack(point.z())};
}

[[nodiscard, gnu::always_inline]] inline Pack squared_distance(const Coordinates& a, const Coordinates& b) {
  const Pack dx = a[0] - b[0], dy = a[1] - b[1], dz = a[2] - b[2];
  return dx * dx + dy * dy + dz * dz;
}

/// From a box, 0 inside.
[[nodiscard, gnu::always_inline]] inline Pack squared_distance(const Coordinates& low,
                                                               const Coordinates& high,
                                                               const Coordinates& points) {
  Pack squared = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const Pack outside = stdx::max(low[d] - points[d], points[d] - high[d]);
    const Pack beyond = select(outside > 0, outside, Pack(0));
    squared += beyond * beyond;
  }
  return squared;
}

}  // namespace

/// Where a group's particles are; beyond the last of all NaN, which is near nothing.
struct NeighbourList::GroupPositions {
  static constexpr std::size_t packs = group_size / lanes;
  std::array<Coordinates, packs> at;

  [[gnu::always_inline]] inline GroupPositions(const Vec3Array& positions, std::size_t group) {
    const std::size_t first = group * group_size, n = positions.size();
    const std::array<const double*, 3> values{positions.x.data(), positions.y.data(), positions.z.data()};
    for (std::size_t k = 0; k < packs; ++k)
      for (std::size_t d = 0; d < 3; ++d) {
        const std::size_t from = first + k * lanes;
        if (from + lanes <= n) {
          at[k][d] = Pack(values[d] + from, stdx::element_aligned);
          continue;
        }
        for (std::size_t l = 0; l < lanes; ++l)
          at[k][d][l] = from + l < n ? values[d][from + l] : std::numeric_limits<double>::quiet_NaN();
      }
  }
  /// Bit l: whether that of particle l is below `reach_squared`.
  template <class SquaredDistance>
  [[nodiscard, gnu::always_inline]] inline unsigned near(double reach_squared,
                                                         SquaredDistance&& distance) const {
    unsigned bits = 0;
    for (std::size_t k = 0; k < packs; ++k)
      bits |= lanes_below(distance(at[k]), reach_squared) << (k * lanes);
    return bits;
  }
};

/// What one thread needs to make rows.
struct NeighbourList::Scratch {
  GroupSet found;
  std::vector<Run> runs;            ///< of a group
  std::vector<Index> candidates;    ///< groups, ascending; of run after run
  std::vector<std::uint32_t> rows;  ///< places, row after row, `stride` apart, with room behind each
  std::size_t stride = 0;
  std::array<std::size_t, group_size> length{};
  std::vector<RowEntry> entries;  ///< of a block
  std::vector<Index> near;        ///< likewise, groups with which a group has pairs
  GroupBegins near_begin{};
  std::vector<Index> first_read;  ///< likewise, see groups_first_read
  /// By group, the last block that read it, counted as this thread makes them.
  std::vector<std::uint32_t> last_read;
  std::uint32_t blocks = blocks_remembered;

  void make_room(std::size_t most_candidates) {
    stride = (most_candidates + 1) * group_size;
    if (rows.size() < stride * group_size) rows.resize(stride * group_size);
    length.fill(0);
  }
};

/// Adds the groups of which a particle may be within `reach_` of the box.
void NeighbourList::add_candidates(const Box& box, Scratch& scratch) const {
  if (box.is_empty()) return;
  std::array<double, 3> low, high;
  for (std::size_t d = 0; d < 3; ++d) {
    // A little more, for rounding: a pair may be just within reach.
    const double margin = (1 + 1e-9) * (reach_ + 0.5 * skin_ + half_extent_[d]);
    low[d] = box.low[d] - margin, high[d] = box.high[d] + margin;
  }
  const auto first = cell_of(low[0], low[1], low[2]), last = cell_of(high[0], high[1], high[2]);
  for (std::size_t cx = first[0]; cx <= last[0]; ++cx)
    for (std::size_t cy = first[1]; cy <= last[1]; ++cy) {
      const std::size_t column = (cx * cells_[1] + cy) * cells_[2];
      for (std::size_t k = cell_begin_[column + first[2]]; k < cell_begin_[column + last[2] + 1]; ++k)
        scratch.found.add(cell_group_[k]);
    }
}

unsigned NeighbourList::present_in(std::size_t group) const {
  unsigned bits = (1U << group_size) - 1;
  if (left_out_.empty()) return bits;
  for (std::size_t l = 0; l < group_size; ++l)
    if (const std::size_t i = group * group_size + l; i < left_out_.size() && is_left_out(i))
      bits &= ~(1U << l);
  return bits;
}

void NeighbourList::find_rows_of(const Run& run, const Vec3Array& positions,
                                 std::span<const Index> candidates, Scratch& scratch) const {
  const std::size_t group = run.begin / group_size, first = run.begin % group_size,
                    count = run.end - run.begin;
  RowEnds ends{};
  std::array<Coordinates, group_size> own;
  for (std::size_t l = 0; l < count; ++l) {
    ends[l] = &scratch.rows[(first + l) * scratch.stride];
    own[l] = everywhere(positions[run.begin + l]);
  }
  const Coordinates low = everywhere({run.box.low[0], run.box.low[1], run.box.low[2]}),
                    high = everywhere({run.box.high[0], run.box.high[1], run.box.high[2]});
  // A box is no nearer than what is in it but for rounding: the cut must leave every pair to its own
  // distance.
  const double reach_squared = reach_ * reach_, box_squared = (1 + 1e-12) * reach_squared;
  const unsigned present = present_in(group) >> first;
  for (const Index candidate : candidates) {
    const auto other = static_cast<std::size_t>(candidate);
    const GroupPositions theirs(positions, other);
    unsigned listed = theirs.near(
        box_squared, [&](const Coordinates& points) { return squared_distance(low, high, points); });
    listed &= present_in(other);
    if (listed == 0) continue;
    const Places places = places_of_group(other);
    const unsigned itself = other == group ? 1U << first : 0;
    unsigned any_near = 0;
    for (std::size_t l = 0; l < count; ++l) {
      unsigned near = theirs.near(
          reach_squared, [&](const Coordinates& points) { return squared_distance(own[l], points); });
      near &= (present >> l & 1U) != 0 ? listed & ~(itself << l) : 0;
      any_near |= near;
      append(ends[l], places, near);
    }
    if (any_near != 0) scratch.near.push_back(candidate);
  }
  for (std::size_t l = 0; l < count; ++l)
    scratch.length[first + l] =
        static_cast<std::size_t>(ends[l] - &scratch.rows[(first + l) * scratch.stride]);
}

/// Rows of the group, one behind the other.
void NeighbourList::find_rows(const Vec3Array& positions, std::size_t group, Scratch& scratch) const {
  const std::size_t begin = group * group_size, end = std::min(positions.size(), begin + group_size);
  scratch.candidates.clear(), scratch.runs.clear();
  std::array<std::size_t, group_size + 1> first{};  // candidate of each run
  std::size_t most = 0;
  for (std::size_t i = begin; i < end; i = scratch.runs.back().end) {
    scratch.runs.push_back(run_from(positions, i, run_extent_));
    add_candidates(scratch.runs.back().box, scratch);
    scratch.found.take_sorted(scratch.candidates);
    const std::size_t r = scratch.runs.size();
    first[r] = scratch.candidates.size();
    most = std::max(most, first[r] - first[r - 1]);
  }
  scratch.make_room(most);
  const auto near_begin = static_cast<std::ptrdiff_t>(scratch.near.size());
  for (std::size_t r = 0; r < scratch.runs.size(); ++r)
    find_rows_of(scratch.runs[r], positions,
                 std::span(scratch.candidates).subspan(first[r], first[r + 1] - first[r]), scratch);
  if (scratch.runs.size() == 1) return;
  std::sort(scratch.near.begin() + near_begin, scratch.near.end());
  scratch.near.erase(std::unique(scratch.near.begin() + near_begin, scratch.near.end()), scratch.near.end());
}

void NeighbourList::drop_separated(std::size_t begin, std::size_t end, Scratch& scratch) const {
  for (std::size_t i = begin; i < end; ++i) {
    const std::span<const Index> gone = separated_.of(i);
    if (gone.empty()) continue;
    std::uint32_t* row = &scratch.rows[(i - begin) * scratch.stride];
    std::size_t& length = scratch.length[i - begin];
    const auto is_gone = [&](std::uint32_t place) {
      return std::binary_search(gone.begin(), gone.end(), static_cast<Index>(place / RowEntry::places));
    };
    length = static_cast<std::size_t>(std::remove_if(row, row + length, is_gone) - row);
  }
}

/// Lays the rows of a group side by side behind those of the block, shorter ones ended with the particle
/// itself.
void NeighbourList::lay_side_by_side(std::size_t begin, std::size_t end, Scratch& scratch) {
  const std::size_t longest = *std::max_element(scratch.length.begin(), scratch.length.end());
  for (std::size_t l = 0; l < group_size; ++l) {
    const auto own = static_cast<std::uint32_t>(RowEntry::places * std::min(begin + l, end - 1));
    std::fill(&scratch.rows[l * scratch.stride + scratch.length[l]],
              &scratch.rows[l * scratch.stride + longest], own);
  }
  const std::size_t before = scratch.entries.size();
  scratch.entries.resize(before + longest * group_size);
  RowEntry* to = scratch.entries.data() + before;
  for (std::size_t k = 0; k < longest; ++k)
    for (std::size_t l = 0; l < group_size; ++l)
      to[k * group_size + l] = RowEntry::at(scratch.rows[l * scratch.stride + k]);
}

void NeighbourList::note_first_reads(Block& block, Scratch& scratch) const {
  scratch.first_read.clear();
  ++scratch.blocks;
  if (scratch.last_read.size() < blocks_.size() * groups_per_block)
    scratch.last_read.resize(blocks_.size() * groups_per_block, 0);
  for (std::size_t k = 0; k < groups_per_block; ++k) {
    for (std::uint32_t at = scratch.near_begin[k]; at < scratch.near_begin[k + 1]; ++at) {
      std::uint32_t& last = scratch.last_read[static_cast<std::size_t>(scratch.near[at])];
      if (scratch.blocks - std::exchange(last, scratch.blocks) >= blocks_remembered)
        scratch.first_read.push_back(scratch.near[at]);
    }
    block.first_read_begin[k + 1] = static_cast<std::uint32_t>(scratch.first_read.size());
  }
  block.first_read.assign(scratch.first_read.begin(), scratch.first_read.end());
}

void NeighbourList::make_rows(const Vec3Array& positions, std::size_t b, const std::uint8_t* chosen) {
  static thread_local Scratch scratch;
  const std::size_t n = positions.size();
  Block& block = blocks_[b];
  scratch.entries.clear(), scratch.near.clear();
  std::uint32_t before = 0, near_before = 0;  // where the group's rows began
  for (std::size_t k = 0; k < groups_per_block; ++k) {
    const std::size_t g = b * groups_per_block + k, begin = g * group_size,
                      end = std::min(n, begin + group_size);
    const std::uint32_t first = std::exchange(before, block.begin[k + 1]),
                        near_first = std::exchange(near_before, block.near_begin[k + 1]);
    if (begin < n && chosen && chosen[g] == 0) {
      scratch.entries.insert(scratch.entries.end(), block.entries.begin() + first,
                             block.entries.begin() + before);
      scratch.near.insert(scratch.near.end(), block.near.begin() + near_first,
                          block.near.begin() + near_before);
    } else if (begin < n) {
      find_rows(positions, g, scratch);
      if (!separated_.empty()) drop_separated(begin, end, scratch);
      lay_side_by_side(begin, end, scratch);
    }
    block.begin[k + 1] = static_cast<std::uint32_t>(scratch.entries.size());
    scratch.near_begin[k + 1] = static_cast<std::uint32_t>(scratch.near.size());
    if (keeps_places_) block.near_begin[k + 1] = scratch.near_begin[k + 1];
  }
  block.entries.assign(scratch.entries.begin(), scratch.entries.end());
  if (keeps_places_) block.near.assign(scratch.near.begin(), scratch.near.end());
  note_first_reads(block, scratch);
  block.made = begun_;
}

}  // namespace tuft::sph

#pragma once
/// Neighbour (Verlet) list from a cell list, with a skin so that it serves many steps.
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/lanes.h"
#include "core/prefetch.h"
#include "sph_infill/separated_pairs.h"

namespace tuft::sph {

/// Particles of one partial sum, and of what a thread works on at a time.
inline constexpr std::size_t block_size = 256;

/// Particles whose rows lie side by side, a lane each of the loops over pairs.
inline constexpr std::size_t group_size = single_lanes;
static_assert(block_size % group_size == 0);

/// A particle in a row: its index as a place in tables whose rows are a whole number of eight bytes long.
/// Processors multiply by up to eight when they load, so that records of 32 and 64 bytes need no arithmetic.
class RowEntry {
 public:
  static constexpr std::size_t places = 8;  ///< of a particle
  /// Particles that there may be.
  static constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max() / places;

  RowEntry() = default;
  explicit RowEntry(std::size_t index) : place_(static_cast<std::uint32_t>(places * index)) {}
  [[nodiscard]] static RowEntry at(std::uint32_t place) {
    RowEntry entry;
    entry.place_ = place;
    return entry;
  }
  [[nodiscard]] std::size_t place() const { return place_; }
  [[nodiscard]] std::size_t index() const { return place_ / places; }

 private:
  std::uint32_t place_ = 0;
};

/// Rows are sorted by index. A sum over a row in that order, to which pairs beyond the support add exact
/// zeros, does not depend on when the list was built: a run has the same bits with any skin, for any number
/// of threads and across a checkpoint. Periods of individual steps do depend on it, for they are chosen by
/// all that is in the list: a checkpoint holds what it was built of and with (individual_steps.h).
///
/// Particles go by groups, [g group_size, (g + 1) group_size), whose rows lie side by side: a loop takes
/// entry k of all of them at once.
class NeighbourList {
 public:
  /// Entry k of lane l is first[k group_size + l]. Shorter rows end with the particle itself (the last
  /// particle in lanes beyond it), whose pair terms are exact zeros.
  struct GroupRows {
    const RowEntry* first;
    std::size_t length;
  };

  NeighbourList() = default;
  /// support: m, pairs closer than this are in the list. skin: m, how much farther it looks. The box of
  /// `positions` sizes the cells' grid; particles that leave it later share its outermost cells, which is
  /// correct, only slower. Throws InputError for more than RowEntry::most particles.
  NeighbourList(const Vec3Array& positions, double support, double skin);
  /// m, from the next build on; until then allowed_displacement() is that of the list as it stands.
  void set_skin(double skin) { next_skin_ = skin; }
  [[nodiscard]] double skin() const { return skin_; }
  [[nodiscard]] double next_skin() const { return next_skin_; }

  /// Lists all pairs closer than support + skin.
  void build(const Vec3Array& positions);

  /// From the next build on the places that rows were made for are kept, so that `renew` may follow, and
  /// which groups are near each other; some 50 bytes a particle.
  void keep_places() { keeps_places_ = true; }
  [[nodiscard]] const Vec3Array& places() const { return places_; }
  struct Renewal {
    double farthest = 0;     ///< m, that a particle has moved whose place stays
    std::size_t groups = 0;  ///< whose rows were made
  };
  /// Groups of which a particle has moved farther than an eighth of the skin take the present positions for
  /// places; rows are made of these groups, their neighbours and those that were. So the list is that of all
  /// pairs closer than support + skin at their places, as if it had been built there, and serves until a
  /// particle is farther than allowed_displacement() from its own. Builds all where most have moved. Neither
  /// skin, separated pairs nor particles left out may have changed since the last build.
  Renewal renew(const Vec3Array& positions);
  /// The same in parts. `begin` makes all rows out of date; `complete` brings those of some blocks of
  /// particles up to date, at any time before a particle has moved farther than `allowed_displacement` since,
  /// and returns the blocks whose rows it had to make.
  void begin(const Vec3Array& positions);
  std::span<const Index> complete(const Vec3Array& positions, std::span<const Index> blocks);
  [[nodiscard]] bool is_complete(std::size_t block) const { return blocks_[block].made == begun_; }
  void make_out_of_date(std::size_t block) { blocks_[block].made = begun_ - 1; }
  /// From the next build on the particle, one of `count`, has no neighbours and is none.
  void leave_out(Index particle, std::size_t count) {
    left_out_.resize(count, 0);
    left_out_[static_cast<std::size_t>(particle)] = 1;
  }

  /// From the next build on these pairs are no neighbours, however close.
  void separate(SeparatedPairs pairs) { separated_ = std::move(pairs); }
  [[nodiscard]] const SeparatedPairs& separated() const { return separated_; }

  /// While no particle has moved farther than half the skin since the last build, by whatever frame common to
  /// all, no pair within the support is missed.
  [[nodiscard]] double allowed_displacement() const { return 0.5 * skin_; }
  [[nodiscard]] GroupRows group(std::size_t g) const {
    const Block& block = blocks_[g / groups_per_block];
    const std::size_t k = g % groups_per_block;
    return {block.entries.data() + block.begin[k], (block.begin[k + 1] - block.begin[k]) / group_size};
  }
  /// Where places are kept: groups with a pair with one of this group, ascending; the group itself may be
  /// one. Pairs that are separated count.
  [[nodiscard]] std::span<const Index> groups_near(std::size_t g) const {
    const Block& block = blocks_[g / groups_per_block];
    return of_group(block.near, block.near_begin, g);
  }
  /// Groups that this group reads and no group before it had, of its block and the three that its thread had
  /// made before: what is worth asking for ahead of its turn. No result depends on it.
  [[nodiscard]] std::span<const Index> groups_first_read(std::size_t g) const {
    const Block& block = blocks_[g / groups_per_block];
    return of_group(block.first_read, block.first_read_begin, g);
  }
  /// Called for group after group, asks for the rows of the block that comes next.
  [[gnu::always_inline]] inline void prefetch_rows_behind(std::size_t g) const {
    const std::size_t k = g % groups_per_block, next = g / groups_per_block + 1;
    if (next >= blocks_.size()) return;
    const Block& block = blocks_[next];
    if (k == 4) prefetch(&block, 1);
    if (k == 16) {  // by then it has come, and says where its rows are; processors foresee the rest of them
      prefetch(block.entries.data(), 2 * group_size * group_size);
      prefetch(block.first_read.data(), block.first_read.size());
    }
  }
  /// Neighbours of particle i, for tests and reports.
  [[nodiscard]] std::vector<Index> row(std::size_t i) const;

 private:
  static constexpr std::size_t groups_per_block = block_size / group_size;
  using GroupBegins = std::array<std::uint32_t, groups_per_block + 1>;
  static std::span<const Index> of_group(const std::vector<Index>& of_block, const GroupBegins& begin,
                                         std::size_t g) {
    const std::size_t k = g % groups_per_block;
    return std::span(of_block).subspan(begin[k], begin[k + 1] - begin[k]);
  }
  /// Rows of some groups, stored apart so that threads build them without waiting for each other.
  struct Block {
    GroupBegins begin{}, near_begin{}, first_read_begin{};
    std::uint32_t made = 0;  ///< the `begin` it belongs to
    std::vector<RowEntry> entries;
    std::vector<Index> near, first_read;
  };
  /// What one thread needs to make rows.
  struct Scratch;
  struct GroupPositions;
  struct Box {
    std::array<double, 3> low, high;  ///< m
    /// Of nothing.
    Box() {
      low.fill(std::numeric_limits<double>::infinity()), high.fill(-std::numeric_limits<double>::infinity());
    }
    /// Or of what is nowhere.
    [[nodiscard]] bool is_empty() const {
      return !(low[0] <= high[0] && low[1] <= high[1] && low[2] <= high[2]);
    }
    [[nodiscard]] double extent(std::size_t d) const { return high[d] - low[d]; }
    [[nodiscard]] double middle(std::size_t d) const { return 0.5 * (low[d] + high[d]); }
    void include(const std::array<double, 3>& point);
  };
  /// Particles of a group, one after the other, which lie together; those left out are not in its box.
  /// Searches go by runs: most groups are one, what has been scattered is several.
  struct Run {
    Box box;
    std::size_t begin, end;
  };

  void size_cells(std::size_t particles);
  void sort_into_cells(const Vec3Array& positions);
  void choose_run_extent(const Vec3Array& positions);
  /// The longest from a particle on whose box is no larger than `extent` (m).
  [[nodiscard]] Run run_from(const Vec3Array& positions, std::size_t begin,
                             const std::array<double, 3>& extent) const;
  [[nodiscard]] std::array<std::size_t, 3> cell_of(double x, double y, double z) const;
  [[nodiscard]] unsigned present_in(std::size_t group) const;  ///< a bit a lane
  void add_candidates(const Box& box, Scratch& scratch) const;
  /// chosen: by group, those whose rows are made; null: all.
  void make_rows(const Vec3Array& positions, std::size_t block, const std::uint8_t* chosen = nullptr);
  void find_rows(const Vec3Array& positions, std::size_t group, Scratch& scratch) const;
  void find_rows_of(const Run& run, const Vec3Array& positions, std::span<const Index> candidates,
                    Scratch& scratch) const;
  void drop_separated(std::size_t begin, std::size_t end, Scratch& scratch) const;
  static void lay_side_by_side(std::size_t begin, std::size_t end, Scratch& scratch);
  void note_first_reads(Block& block, Scratch& scratch) const;

  double support_ = 0, skin_ = 0, next_skin_ = 0, reach_ = 0;
  std::array<double, 3> cell_size_{1, 1, 1};  ///< m
  std::array<double, 3> box_low_{}, box_high_{};
  std::array<double, 3> low_{};  ///< of the cells
  std::array<std::size_t, 3> cells_{1, 1, 1};
  std::array<double, 3> run_extent_{};     ///< m, of runs at most
  std::array<double, 3> half_extent_{};    ///< m, half of the largest run
  std::vector<std::uint32_t> cell_begin_;  ///< runs of a cell in cell order; z runs fastest
  std::vector<Index> cell_group_;          ///< of each run
  [[nodiscard]] bool is_left_out(std::size_t i) const { return !left_out_.empty() && left_out_[i] != 0; }

  SeparatedPairs separated_;
  std::vector<std::uint8_t> left_out_;  ///< by particle; empty: none is
  std::uint32_t begun_ = 0;             ///< calls of `begin`
  std::vector<Block> blocks_;
  std::vector<Index> to_make_;  ///< scratch of `complete` and `renew`

  /// Of a block, in `renew`.
  struct Moved {
    double farthest_squared = 0;  ///< m^2, among those that stay
    std::size_t groups = 0;
  };
  Moved find_moved(const Vec3Array& positions, std::size_t block);
  void mark_neighbours(std::size_t block);
  bool keeps_places_ = false;
  Vec3Array places_;                          ///< m
  std::vector<std::uint8_t> moved_, beside_;  ///< by group, scratch of `renew`
  std::vector<Moved> moved_blocks_;
};

}  // namespace tuft::sph

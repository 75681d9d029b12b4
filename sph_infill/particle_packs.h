#pragma once
/// What the passes over particles share: blocks for the threads, packs of a block's particles, the kernel.
#include <algorithm>
#include <array>

#include "core/lane_math.h"
#include "core/parallel.h"
#include "sph_infill/kernel.h"
#include "sph_infill/sleep.h"
#include "sph_infill/sph_loops.h"

namespace tuft::sph {

/// Calls work(block, begin, end) for each block of particles that is computed, on all threads; sleep: null
/// where none sleeps.
template <class Work>
void for_blocks(std::size_t count, const Sleep* sleep, Work&& work) {
  const auto at = [&](std::size_t b) { work(b, b * block_size, std::min(count, (b + 1) * block_size)); };
  if (!sleep) return parallel_for((count + block_size - 1) / block_size, at);
  const std::span<const Index> computed = sleep->computed();
  parallel_for(computed.size(), [&](std::size_t k) { at(static_cast<std::size_t>(computed[k])); });
}

/// Calls body(kernel) with the chosen kernel as a value of its own type.
template <class Body>
auto with_kernel(const SphOptions& options, Body&& body) {
  if (options.kernel == Kernel::cubic_spline) return body(CubicSpline(options.smoothing_length));
  return body(WendlandC2(options.smoothing_length));
}

/// Those of a group, a lane each; lanes beyond the last particle repeat it.
[[nodiscard]] inline std::array<RowEntry, group_size> entries_of_group(std::size_t group, std::size_t count) {
  std::array<RowEntry, group_size> entries;
  for (std::size_t l = 0; l < group_size; ++l)
    entries[l] = RowEntry(std::min(group * group_size + l, count - 1));
  return entries;
}

/// Loops over groups ask for what a group's rows read of others so many groups before its turn: half a
/// microsecond, several times what memory takes to answer.
inline constexpr std::size_t groups_ahead = 2;

/// Called in the turn of `group`, asks for records that the rows of the group after next read: neighbours
/// come in no order that processors foresee. Without, a bed that caches do not hold costs half as much again
/// a particle as one that they do; with, a tenth.
template <class... Record>
[[gnu::always_inline]] inline void prefetch_records(const NeighbourList& list, std::size_t group,
                                                    const std::vector<Record>&... records) {
  list.prefetch_rows_behind(group);
  const std::size_t ahead = group + groups_ahead, count = std::min({records.size()...});
  if (ahead * group_size >= count) return;
  for (const Index other : list.groups_first_read(ahead)) {
    const std::size_t first = static_cast<std::size_t>(other) * group_size;
    (prefetch(records.data() + first, group_size), ...);
  }
}

/// Where the records of some particles lie, a lane each.
class RecordPlaces {
 public:
  explicit RecordPlaces(const RowEntry* entries) {
    for (std::size_t l = 0; l < group_size; ++l) place_[l] = entries[l].place();
  }

  /// The records as columns. Of a motion's the first three are integers: integer_difference.
  template <class Record>
  [[nodiscard]] std::array<SinglePack, Record::values> load(const std::vector<Record>& records) const {
    constexpr std::size_t bytes = sizeof(Record) / RowEntry::places;
    static_assert(bytes * RowEntry::places == sizeof(Record));
    return load_columns<Record::values>(
        RowsOf<float, bytes>{reinterpret_cast<const float*>(records.data()), place_});
  }

 private:
  std::array<std::size_t, group_size> place_;
};

/// Columns as the values of the records of `count` particles from i on.
template <class Record>
void store_records(const std::array<Pack, Record::values>& column, std::size_t i, std::size_t count,
                   std::vector<Record>& records) {
  auto* first = reinterpret_cast<float*>(&records[i]);
  const auto store_four = [&]<std::size_t c>(std::integral_constant<std::size_t, c> /*first column*/) {
    store_four_columns({narrowed(std::get<c>(column)), narrowed(std::get<c + 1>(column)),
                        narrowed(std::get<c + 2>(column)), narrowed(std::get<c + 3>(column))},
                       count, first + c, sizeof(Record) / sizeof(float));
  };
  [&]<std::size_t... k>(std::index_sequence<k...> /*fours*/) {
    (store_four(std::integral_constant<std::size_t, 4 * k>()), ...);
  }
  (std::make_index_sequence<Record::values / 4>());
}

using SingleVector = std::array<SinglePack, 3>;

/// What a pair loop sees of two particles.
struct PairMotion {
  SingleVector d;        ///< x_i - x_j, in units of position: whole numbers
  SinglePack q_squared;  ///< |d|^2 over h^2
  SingleVector u;        ///< v_j - v_i, m/s

  using Record = std::array<SinglePack, MotionRecord::values>;
  PairMotion(const Record& i, const Record& j)
      : d{integer_difference(i[0], j[0]), integer_difference(i[1], j[1]), integer_difference(i[2], j[2])},
        q_squared((MotionRecord::position_unit * MotionRecord::position_unit) *
                  (d[0] * d[0] + d[1] * d[1] + d[2] * d[2])),
        u{j[4] - i[4], j[5] - i[5], j[6] - i[6]} {}
};

/// Pairs of a lane that loops take before they go over them again.
inline constexpr std::size_t row_chunk = 32;

/// Calls body(entries, count) for the rows of a group, row_chunk entries of each at a time or fewer: entry k
/// of lane l is entries[k group_size + l].
template <class Body>
void for_chunks(const NeighbourList::GroupRows& rows, Body&& body) {
  for (std::size_t k = 0; k < rows.length; k += row_chunk)
    body(rows.first + k * group_size, std::min(row_chunk, rows.length - k));
}

/// `count` of the lanes are particles; the last pack of all may have fewer. The others repeat the first.
[[nodiscard]] inline Pack load_lanes(const double* first, std::size_t count) {
  if (count >= lanes) return Pack(first, stdx::element_aligned);
  return Pack([&](std::size_t lane) { return first[lane < count ? lane : 0]; });
}
[[nodiscard]] inline Pack load_lanes(const std::vector<double>& values, std::size_t i, std::size_t count) {
  return load_lanes(&values[i], count);
}
inline void store_lanes(const Pack& pack, std::vector<double>& values, std::size_t i, std::size_t count) {
  if (count >= lanes) return pack.copy_to(&values[i], stdx::element_aligned);
  for (std::size_t lane = 0; lane < count; ++lane) values[i + lane] = pack[lane];
}
/// Adds the particles' lanes alone.
[[nodiscard]] inline Pack only(const Pack& pack, std::size_t count) {
  if (count >= lanes) return pack;
  return Pack([&](std::size_t lane) { return lane < count ? double(pack[lane]) : 0.0; });
}

}  // namespace tuft::sph

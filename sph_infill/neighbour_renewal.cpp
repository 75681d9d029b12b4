/// NeighbourList::renew: what has moved is listed anew, and nothing else.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "sph_infill/neighbour_list.h"

namespace tuft::sph {
namespace {

/// Over the skin. Less: more rows to make each time. More: the list serves for a shorter time, since what
/// stays has used up part of the half skin that it may move by.
constexpr double least_move = 1.0 / 8;

}  // namespace

NeighbourList::Moved NeighbourList::find_moved(const Vec3Array& positions, std::size_t block) {
  const double least_squared = least_move * skin_ * least_move * skin_;
  const std::size_t n = positions.size(), end = std::min(n, (block + 1) * block_size);
  Moved found;
  for (std::size_t first = block * block_size; first < end; first += group_size) {
    double farthest = 0;
    bool stays = true;
    for (std::size_t i = first; i < std::min(end, first + group_size); ++i) {
      const double dx = positions.x[i] - places_.x[i], dy = positions.y[i] - places_.y[i],
                   dz = positions.z[i] - places_.z[i], squared = dx * dx + dy * dy + dz * dz;
      farthest = std::max(farthest, squared);
      stays = stays && squared <= least_squared;
    }
    moved_[first / group_size] = stays ? 0 : 1;
    if (stays) {
      found.farthest_squared = std::max(found.farthest_squared, farthest);
      continue;
    }
    ++found.groups;
  }
  return found;
}

/// Marks the groups in which neighbours of a block's moved groups are.
void NeighbourList::mark_neighbours(std::size_t block) {
  for (std::size_t k = 0; k < groups_per_block; ++k) {
    const std::size_t g = block * groups_per_block + k;
    if (g >= moved_.size()) return;
    if (moved_[g] == 0) continue;
    for (const Index other : groups_near(g))  // other threads mark, too
      std::atomic_ref(beside_[static_cast<std::size_t>(other)]).store(1, std::memory_order_relaxed);
  }
}

NeighbourList::Renewal NeighbourList::renew(const Vec3Array& positions) {
  const std::size_t n = positions.size(), groups = (n + group_size - 1) / group_size;
  moved_.resize(groups);
  moved_blocks_.resize(blocks_.size());
  parallel_for(blocks_.size(), [&](std::size_t b) { moved_blocks_[b] = find_moved(positions, b); });
  Moved all;
  to_make_.clear();
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    all.farthest_squared = std::max(all.farthest_squared, moved_blocks_[b].farthest_squared);
    all.groups += moved_blocks_[b].groups;
    if (moved_blocks_[b].groups > 0) to_make_.push_back(static_cast<Index>(b));
  }
  if (2 * all.groups > groups) {
    build(positions);
    return {0, groups};
  }

  for (std::size_t g = 0; g < groups; ++g) {
    if (moved_[g] == 0) continue;
    for (std::size_t i = g * group_size; i < std::min(n, (g + 1) * group_size); ++i)
      places_.set(i, positions[i]);
  }
  sort_into_cells(places_);
  beside_.assign(groups, 0);
  // Rows are symmetric: who loses a neighbour is found in its old row, who gains one in its new.
  parallel_for(to_make_.size(), [&](std::size_t k) {
    const auto b = static_cast<std::size_t>(to_make_[k]);
    mark_neighbours(b);
    make_rows(places_, b, moved_.data());
    mark_neighbours(b);
  });
  to_make_.clear();
  std::size_t made = all.groups;
  for (std::size_t g = 0; g < groups; ++g) {
    if (moved_[g] != 0) beside_[g] = 0;  // made already
    if (beside_[g] == 0) continue;
    ++made;
    const auto b = static_cast<Index>(g / groups_per_block);
    if (to_make_.empty() || to_make_.back() != b) to_make_.push_back(b);
  }
  parallel_for(to_make_.size(), [&](std::size_t k) {
    make_rows(places_, static_cast<std::size_t>(to_make_[k]), beside_.data());
  });
  return {std::sqrt(all.farthest_squared), made};
}

}  // namespace tuft::sph

#pragma once
/// Lists of pairs that may touch, sorted by key, each with its memory; and the sums that contact leaves
/// behind.
#include <cstdint>
#include <vector>

#include "coupler/contact_law.h"

namespace tuft::coupler {

/// Pair of a point (particle or node) and what it may touch (shell surface or body), ordered by point first.
using PairKey = std::uint64_t;
[[nodiscard]] constexpr PairKey make_key(Index point, Index other) {
  return (static_cast<PairKey>(static_cast<std::uint32_t>(point)) << 32) | static_cast<std::uint32_t>(other);
}
[[nodiscard]] constexpr Index key_point(PairKey key) {
  return static_cast<Index>(key >> 32);
}
[[nodiscard]] constexpr Index key_other(PairKey key) {
  return static_cast<Index>(key & 0xffffffffu);
}

/// What is known of pairs, for new_keys: that of old_keys where a key stays, fresh elsewhere. Both key lists
/// are sorted and unique. Pairs that fall out of the list are apart by more than the skin, so nothing is lost
/// with them.
template <class Known>
[[nodiscard]] std::vector<Known> carry_over(const std::vector<PairKey>& old_keys,
                                            const std::vector<Known>& known,
                                            const std::vector<PairKey>& new_keys) {
  std::vector<Known> result(new_keys.size());
  std::size_t old = 0;
  for (std::size_t i = 0; i < new_keys.size(); ++i) {
    while (old < old_keys.size() && old_keys[old] < new_keys[i]) ++old;
    if (old < old_keys.size() && old_keys[old] == new_keys[i]) result[i] = known[old];
  }
  return result;
}

/// Energies of one kind of contact, J. `elastic` is the present state; the rest adds up over the run.
struct ContactEnergy {
  double elastic = 0;
  double damped = 0;
  double friction = 0;
  double released = 0;  ///< put in by letting initial overlap go

  ContactEnergy& operator+=(const ContactEnergy& other) {
    elastic += other.elastic;
    damped += other.damped;
    friction += other.friction;
    released += other.released;
    return *this;
  }
};

/// What was found when contact first looked.
struct InitialOverlap {
  std::size_t pairs = 0;
  double largest = 0;  ///< m
};

}  // namespace tuft::coupler

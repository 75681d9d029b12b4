#pragma once
/// Pairs of particles that a thin sheet lies between: the visibility criterion (Belytschko, Lu & Gu 1994, doi
/// 10.1002/nme.1620370205, there for cracks). A continuum of points does not know of a sheet inside it: what
/// is on one side would act on the other straight through it.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vector.h"

namespace tuft::sph {

/// Corners in order, m; taken as the two triangles (0,1,2) and (0,2,3).
using Sheet = std::array<Vec3, 4>;

class SeparatedPairs {
 public:
  SeparatedPairs() = default;
  /// All pairs closer than `reach` (m) whose line of centres a sheet crosses, or passes its edge by no
  /// more than some 0.02 of the reach. A particle in the plane of a sheet counts as above it.
  SeparatedPairs(const Vec3Array& positions, std::span<const Sheet> sheets, double reach);
  /// As `values` gave them, of `count` particles; sizes and order are the caller's to check.
  SeparatedPairs(std::span<const double> values, std::size_t count);

  [[nodiscard]] bool empty() const { return partner_.empty(); }
  /// Those that i is separated from, sorted.
  [[nodiscard]] std::span<const Index> of(std::size_t i) const {
    if (begin_.empty()) return {};
    return std::span(partner_).subspan(begin_[i], begin_[i + 1] - begin_[i]);
  }
  /// Lower and higher index of each pair, in order: for checkpoints.
  [[nodiscard]] std::vector<double> values() const;
  bool operator==(const SeparatedPairs&) const = default;

 private:
  using Pair = std::array<Index, 2>;  ///< lower index first
  void list(std::vector<Pair>& pairs, std::size_t count);

  std::vector<std::uint32_t> begin_;  ///< by particle, and an end; empty where there is no pair
  std::vector<Index> partner_;
};

}  // namespace tuft::sph

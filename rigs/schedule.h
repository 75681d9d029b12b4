#pragma once
/// The grid of times that a run keeps to.
#include <cstdint>

#include "core/scene.h"

namespace tuft::rigs {

/// Everything is scheduled on a grid of output.histories: settling, drop, frames and checkpoints are whole
/// numbers of its intervals, so that times do not drift and a resumed run meets the same instants.
struct Schedule {
  double interval = 0;  ///< s
  /// Intervals of conditioning: plate down, up, and away; or the roller's pass, 0, and rest.
  std::uint64_t press = 0, lift = 0, rest = 0;
  std::uint64_t presses = 1;  ///< how often that comes, at most
  /// Intervals of settling between that and the release: of grains at most, and they settle for
  /// `settle_least` at least; in between they are looked at every `look_every`.
  std::uint64_t settle = 0, settle_least = 0, look_every = 1;
  std::uint64_t settle_expected = 0;  ///< an estimate, for plans
  std::uint64_t end = 0;              ///< intervals in all
  std::uint64_t frame_every = 1;
  std::uint64_t conditioning_frame_every = 1;
  std::uint64_t checkpoint_every = 0;  ///< 0: only at the end and on interruption

  [[nodiscard]] std::uint64_t cycle() const { return press + lift + rest; }
  [[nodiscard]] std::uint64_t conditioned() const { return presses * cycle(); }
  [[nodiscard]] std::uint64_t release() const { return conditioned() + settle; }
  [[nodiscard]] double time(std::uint64_t index) const {
    return (static_cast<double>(index) - static_cast<double>(release())) * interval;
  }
};
[[nodiscard]] Schedule make_schedule(const Scene& scene);

}  // namespace tuft::rigs

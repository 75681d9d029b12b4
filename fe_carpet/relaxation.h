#pragma once
/// Static answers by explicit dynamics: dynamic relaxation of a carpet under loads.
#include <cstdint>
#include <functional>

#include "fe_carpet/carpet.h"

namespace tuft::fe {

/// Fills force (N) and moment (N m), one of each per node and zero when called, at a share of the full load.
/// The nodes are given so that loads can follow them.
using LoadAtShare =
    std::function<void(const NodeView& nodes, double share, Vec3Array& force, Vec3Array& moment)>;

struct RelaxationOptions {
  double from = 0, to = 1;  ///< shares of the load at the beginning and at the end
  /// s, >= 0, over which the share rises. Materials in rate form and large rotations want a path without
  /// violence: a few periods of the slowest motion.
  double ramp_time = 0;
  double step_safety = 0.9;  ///< of the stable step, (0, 1)
  /// At rest when the largest kinetic energy of a swing is under this share of the elastic energy.
  double tolerance = 1e-9;
  std::uint64_t most_steps = 100'000'000;
};

struct RelaxationResult {
  bool at_rest = false;      ///< false: most_steps were not enough
  std::uint64_t steps = 0;   ///< taken
  std::uint64_t swings = 0;  ///< times that the motion was stopped
  double kinetic_share = 0;  ///< kinetic over elastic energy at the last swing's peak
};

/// Kinetic damping (Cundall 1976; Barnes 1999, Int. J. Space Struct. 14, 89): the carpet moves without
/// damping, and whenever its kinetic energy passes a peak, all of it is stopped. Needs no estimate of a
/// frequency. The energy taken out is booked as the carpet's damping. The carpet's own damping rate should be
/// zero. Throws what Carpet::step throws; std::logic_error on options out of range.
RelaxationResult relax(Carpet& carpet, const LoadAtShare& load, const RelaxationOptions& options);

}  // namespace tuft::fe

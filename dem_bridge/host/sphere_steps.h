#pragma once
/// Moves spheres in LIGGGHTS' arrays by one step: a kick and a drift in one pass through memory.
///
/// LIGGGHTS' own integrator goes through them twice a step, before and after its forces, with gravity and
/// loads of the bridge as a third pass. Here positions and forces are of t and velocities of t - dt/2 when
/// LIGGGHTS has evaluated its forces; the whole kick and the drift follow, and LIGGGHTS finds x(t + dt) and
/// v(t + dt/2): as its own integrator would have it.
#include <cstddef>
#include <span>

#include "core/vector.h"
#include "dem_bridge/host/kick_sums.h"
#include "dem_bridge/host/load_cursor.h"

namespace tuft::dem {

/// By more than its radius in a step (s).
inline bool moves_past_itself(double vx, double vy, double vz, double radius, double step) {
  return (vx * vx + vy * vy + vz * vz) * step * step > radius * radius;
}

/// Where the state that the driver is to see is written to, by component and grain, and what of it is amiss.
struct StateOut {
  double *x, *y, *z, *vx, *vy, *vz, *wx, *wy, *wz;
  Vec3 low, high;  ///< m, of the box that grains may not leave

  std::size_t outside = 0;  ///< grains that have
  std::size_t fast = 0;     ///< that move by more than their radius in a step
  double poison = 0;        ///< not a number where anything is not finite
};

struct SphereStep {
  double *position, *velocity, *spin;  ///< rows of three, one behind the other
  const double *force, *torque;        ///< of the other grains, at t
  const double *mass, *radius;
  double step;        ///< s
  double per_second;  ///< of a load's impulse: the force
  double damping;     ///< 1/s
  Vec3 gravity;       ///< m/s^2
};

/// The sphere in place `a` of LIGGGHTS' arrays. `loads`: its own, one or none.
void step_sphere(const SphereStep& step, std::size_t a, std::span<const LoadRecord> loads, KickSums& sums);

/// The spheres from `first` to before `end`, which lie in our order, in blocks. with_kinetic: their kinetic
/// energy is summed up; it is not for all where this is false. out: gets their state after the step; null:
/// another step follows before the driver looks.
void step_spheres(const SphereStep& step, std::size_t first, std::size_t end, bool with_kinetic,
                  LoadCursor& cursor, KickSums& sums, StateOut* out);

}  // namespace tuft::dem

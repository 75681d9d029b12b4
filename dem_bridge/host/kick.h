#pragma once
/// What the bridge adds to one grain in one step: a pure function, apart from LIGGGHTS' arrays.
///
/// Leapfrog from v- = v(t - dt/2) to v+ = v(t + dt/2) under the pair force f, gravity, the contact force and
/// a damping force -c m v taken at the middle: v = (v- + v+)/2 solves v = (v- + dt a/2) / (1 + c dt/2), which
/// is stable for any c dt and never feeds energy in. Spin alike, with the moment of inertia 2/5 m r^2.
#include "core/vector.h"

namespace tuft::dem {

struct GrainState {
  Vec3 velocity;     ///< m/s, v- + dt f/2m: at t as far as the pair force goes
  Vec3 spin;         ///< rad/s, alike
  Vec3 pair_force;   ///< N, of the other grains at t
  Vec3 pair_torque;  ///< N m
  double mass;       ///< kg
  double inertia;    ///< kg m^2
};

struct GrainLoad {
  Vec3 contact_force;   ///< N
  Vec3 contact_torque;  ///< N m
  Vec3 gravity;         ///< m/s^2
  double damping;       ///< 1/s
  double step;          ///< s
};

struct GrainKick {
  Vec3 middle;        ///< m/s, velocity at t
  Vec3 middle_spin;   ///< rad/s
  Vec3 added_force;   ///< N, to be added to the pair force
  Vec3 added_torque;  ///< N m
  double kinetic;     ///< J, mean of the values before and after
  double pair_work;   ///< J over the step
  double contact_work;
  double damping_work;
};

[[gnu::always_inline]] inline GrainKick kick_grain(const GrainState& grain, const GrainLoad& load) {
  const double half = 0.5 * load.step;
  const double slowing = 1.0 / (1.0 + load.damping * half);
  const Vec3 force = load.contact_force + grain.mass * load.gravity;
  GrainKick kick;
  kick.middle = (grain.velocity + half / grain.mass * force) * slowing;
  kick.middle_spin = (grain.spin + half / grain.inertia * load.contact_torque) * slowing;
  kick.added_force = force - load.damping * grain.mass * kick.middle;
  kick.added_torque = load.contact_torque - load.damping * grain.inertia * kick.middle_spin;
  // (v-^2 + v+^2)/2 = v^2 + (dt a/2)^2
  const Vec3 change = half / grain.mass * (grain.pair_force + kick.added_force);
  const Vec3 spin_change = half / grain.inertia * (grain.pair_torque + kick.added_torque);
  const double squared = kick.middle.squaredNorm(), spin_squared = kick.middle_spin.squaredNorm();
  kick.kinetic = 0.5 * grain.mass * (squared + change.squaredNorm()) +
                 0.5 * grain.inertia * (spin_squared + spin_change.squaredNorm());
  kick.pair_work = load.step * (grain.pair_force.dot(kick.middle) + grain.pair_torque.dot(kick.middle_spin));
  kick.contact_work =
      load.step * (load.contact_force.dot(kick.middle) + load.contact_torque.dot(kick.middle_spin));
  kick.damping_work = -load.step * load.damping * (grain.mass * squared + grain.inertia * spin_squared);
  return kick;
}

}  // namespace tuft::dem

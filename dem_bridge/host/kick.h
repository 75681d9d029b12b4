#pragma once
/// What the bridge adds to one grain in one step: a pure function, apart from LIGGGHTS' arrays.
///
/// Leapfrog from v- = v(t - dt/2) to v+ = v(t + dt/2) under the grain's own forces, gravity, the contact
/// force and a damping force -c m v taken at the middle: v = (v- + v+)/2 solves v = (v- + dt a/2) / (1 + c
/// dt/2), which is stable for any c dt and never feeds energy in. Spin alike, with the moment of inertia 2/5
/// m r^2.
#include "core/vector.h"

namespace tuft::dem {

struct GrainState {
  Vec3 velocity;     ///< m/s at t - dt/2
  Vec3 spin;         ///< rad/s at t - dt/2
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
  Vec3 added_force;   ///< N, to be added to the pair force
  Vec3 added_torque;  ///< N m
  double kinetic;     ///< J, mean of the values before and after
  double pair_work;   ///< J over the step
  double contact_work;
  double damping_work;
};

inline GrainKick kick_grain(const GrainState& grain, const GrainLoad& load) {
  const double half = 0.5 * load.step;
  const double slowing = 1.0 / (1.0 + load.damping * half);
  const Vec3 force = load.contact_force + grain.mass * load.gravity;
  const Vec3 middle = (grain.velocity + half / grain.mass * (grain.pair_force + force)) * slowing;
  const Vec3 middle_spin =
      (grain.spin + half / grain.inertia * (grain.pair_torque + load.contact_torque)) * slowing;
  GrainKick kick;
  kick.added_force = force - load.damping * grain.mass * middle;
  kick.added_torque = load.contact_torque - load.damping * grain.inertia * middle_spin;
  // (v-^2 + v+^2)/2 = v^2 + (v - v-)^2
  kick.kinetic = 0.5 * grain.mass * (middle.squaredNorm() + (middle - grain.velocity).squaredNorm()) +
                 0.5 * grain.inertia * (middle_spin.squaredNorm() + (middle_spin - grain.spin).squaredNorm());
  kick.pair_work = load.step * (grain.pair_force.dot(middle) + grain.pair_torque.dot(middle_spin));
  kick.contact_work = load.step * (load.contact_force.dot(middle) + load.contact_torque.dot(middle_spin));
  kick.damping_work = -load.step * load.damping *
                      (grain.mass * middle.squaredNorm() + grain.inertia * middle_spin.squaredNorm());
  return kick;
}

}  // namespace tuft::dem

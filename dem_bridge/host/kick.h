#pragma once
/// What the bridge adds to one grain in one step: a pure function, apart from LIGGGHTS' arrays.
///
/// Leapfrog from v- = v(t - dt/2) to v+ = v(t + dt/2) under the pair force f, gravity, the contact force and
/// a damping force -c m v taken at the middle: v = (v- + v+)/2 solves v = (v- + dt a/2) / (1 + c dt/2), which
/// is stable for any c dt and never feeds energy in. Spin alike, with the moment of inertia 2/5 m r^2.
///
/// Written for one grain (Vec3 and double) and for as many at once as there are lanes (Pack3 and Pack).
#include "core/lanes.h"
#include "core/vector.h"

namespace tuft::dem {

/// A vector in each lane.
struct Pack3 {
  Pack x, y, z;

  [[nodiscard]] Pack dot(const Pack3& o) const { return x * o.x + y * o.y + z * o.z; }
  [[nodiscard]] Pack squaredNorm() const { return dot(*this); }
  friend Pack3 operator+(const Pack3& a, const Pack3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Pack3 operator-(const Pack3& a, const Pack3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Pack3 operator*(const Pack& s, const Pack3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

template <class Vector, class Number>
struct GrainStateOf {
  Vector velocity;     ///< m/s, v- + dt f/2m: at t as far as the pair force goes
  Vector spin;         ///< rad/s, alike
  Vector pair_force;   ///< N, of the other grains at t
  Vector pair_torque;  ///< N m
  Number mass;         ///< kg
  Number inertia;      ///< kg m^2
};
using GrainState = GrainStateOf<Vec3, double>;

template <class Vector>
struct GrainLoadOf {
  Vector contact_force;   ///< N
  Vector contact_torque;  ///< N m
  Vector gravity;         ///< m/s^2
  double damping;         ///< 1/s
  double step;            ///< s
};
using GrainLoad = GrainLoadOf<Vec3>;

template <class Vector, class Number>
struct GrainKickOf {
  Vector middle;        ///< m/s, velocity at t
  Vector middle_spin;   ///< rad/s
  Vector added_force;   ///< N, to be added to the pair force
  Vector added_torque;  ///< N m
  Vector gain;          ///< m/s, what these add to the velocity in half a step
  Vector spin_gain;     ///< rad/s
  Number kinetic;       ///< J, mean of the values before and after
  Number pair_work;     ///< J over the step
  Number contact_work;
  Number damping_work;
};
using GrainKick = GrainKickOf<Vec3, double>;

template <class Vector, class Number>
[[gnu::always_inline]] inline GrainKickOf<Vector, Number> kick_grain(
    const GrainStateOf<Vector, Number>& grain, const GrainLoadOf<Vector>& load) {
  const double half = 0.5 * load.step;
  const Number slowing = 1.0 / (1.0 + load.damping * half), damping = load.damping;
  const Number of_force = half / grain.mass, of_torque = half / grain.inertia;
  // Gravity does not go through the mass, so that a grain without contact gets the same bits from
  // `free_kick`.
  const Vector push = Number(half) * load.gravity + of_force * load.contact_force,
               turn = of_torque * load.contact_torque;
  GrainKickOf<Vector, Number> kick;
  kick.middle = slowing * Vector(grain.velocity + push);
  kick.middle_spin = slowing * Vector(grain.spin + turn);
  kick.gain = push - Number(half * damping) * kick.middle;
  kick.spin_gain = turn - Number(half * damping) * kick.middle_spin;
  kick.added_force =
      load.contact_force + grain.mass * load.gravity - Number(damping * grain.mass) * kick.middle;
  kick.added_torque = load.contact_torque - Number(damping * grain.inertia) * kick.middle_spin;
  // (v-^2 + v+^2)/2 = v^2 + (dt a/2)^2
  const Vector change = of_force * Vector(grain.pair_force + kick.added_force);
  const Vector spin_change = of_torque * Vector(grain.pair_torque + kick.added_torque);
  const Number squared = kick.middle.squaredNorm(), spin_squared = kick.middle_spin.squaredNorm();
  kick.kinetic = 0.5 * grain.mass * (squared + change.squaredNorm()) +
                 0.5 * grain.inertia * (spin_squared + spin_change.squaredNorm());
  kick.pair_work = load.step * (grain.pair_force.dot(kick.middle) + grain.pair_torque.dot(kick.middle_spin));
  kick.contact_work =
      load.step * (load.contact_force.dot(kick.middle) + load.contact_torque.dot(kick.middle_spin));
  kick.damping_work = -load.step * damping * (grain.mass * squared + grain.inertia * spin_squared);
  return kick;
}

template <class Vector, class Number>
struct FreeKickOf {
  Vector velocity;   ///< m/s, after the whole step
  Number pair_work;  ///< J over the step
};

/// As kick_grain between two runs for grains that nothing touches but others and that nothing damps, where
/// their kinetic energy is not asked for. gravity_gain: m/s, in half a step.
template <class Vector, class Number>
[[gnu::always_inline]] inline FreeKickOf<Vector, Number> free_kick(const Vector& velocity, const Vector& spin,
                                                                   const Vector& pair_force,
                                                                   const Vector& pair_torque,
                                                                   const Vector& gravity_gain,
                                                                   const Number& step) {
  const Vector middle = velocity + gravity_gain;
  return {middle + gravity_gain, step * (pair_force.dot(middle) + pair_torque.dot(spin))};
}

}  // namespace tuft::dem

#pragma once
/// What one step does to the velocities of one grain: a pure function, apart from LIGGGHTS' arrays.
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
  Vector velocity;     ///< m/s, v-
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
  Vector velocity;   ///< m/s, v+
  Vector spin;       ///< rad/s
  Number kinetic;    ///< J, mean of the values before and after
  Number pair_work;  ///< J over the step
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
  const Vector pair_push = of_force * grain.pair_force, pair_turn = of_torque * grain.pair_torque;
  const Vector push = Number(half) * load.gravity + of_force * load.contact_force,
               turn = of_torque * load.contact_torque;
  const Vector middle = slowing * Vector(grain.velocity + pair_push + push),
               middle_spin = slowing * Vector(grain.spin + pair_turn + turn);
  GrainKickOf<Vector, Number> kick;
  kick.velocity = middle + push + pair_push - Number(half * damping) * middle;
  kick.spin = middle_spin + turn + pair_turn - Number(half * damping) * middle_spin;
  kick.kinetic = 0.25 * grain.mass * (grain.velocity.squaredNorm() + kick.velocity.squaredNorm()) +
                 0.25 * grain.inertia * (grain.spin.squaredNorm() + kick.spin.squaredNorm());
  kick.pair_work = load.step * (grain.pair_force.dot(middle) + grain.pair_torque.dot(middle_spin));
  kick.contact_work = load.step * (load.contact_force.dot(middle) + load.contact_torque.dot(middle_spin));
  kick.damping_work =
      -load.step * damping * (grain.mass * middle.squaredNorm() + grain.inertia * middle_spin.squaredNorm());
  return kick;
}

}  // namespace tuft::dem

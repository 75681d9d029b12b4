#pragma once
/// What the bridge adds to one rigid body in one step: kick.h for a body whose moments of inertia differ.
///
/// Angular momentum L takes the place of spin: L = (L- + L+)/2 is to the torque what v is to the force, with
/// damping -c L, and the spin is I^-1 L with the inertia I as the body lies at t, in all three of them. So
/// (L-.I^-1 L- + L+.I^-1 L+)/2 = L.I^-1 L + (dt/2)^2 T.I^-1 T, and the change of energy over the kick is the
/// work of the torques at the spin in the middle, exactly. Between kicks L stands still and the body turns.
#include "core/vector.h"

namespace tuft::dem {

struct BodyState {
  Vec3 velocity;          ///< m/s of the centre of mass, v- + dt f/2m: at t as far as the pair force goes
  Vec3 angular_momentum;  ///< kg m^2/s about the centre of mass, alike
  Vec3 pair_force;        ///< N, of other grains on all spheres at t
  Vec3 pair_torque;       ///< N m about the centre of mass
  double mass;            ///< kg
  Mat3 inverse_inertia;   ///< 1/(kg m^2), along the axes of space, at t
};

struct BodyLoad {
  Vec3 contact_force;   ///< N
  Vec3 contact_torque;  ///< N m about the centre of mass
  Vec3 gravity;         ///< m/s^2
  double damping;       ///< 1/s
  double step;          ///< s
};

struct BodyKick {
  Vec3 middle;                   ///< m/s, velocity at t
  Vec3 middle_angular_momentum;  ///< kg m^2/s
  Vec3 added_force;              ///< N, to be added to the pair force
  Vec3 added_torque;             ///< N m
  double kinetic;                ///< J, mean of the values before and after
  double pair_work;              ///< J over the step
  double contact_work;
  double damping_work;
};

[[nodiscard]] inline BodyKick kick_body(const BodyState& body, const BodyLoad& load) {
  const double half = 0.5 * load.step, slowing = 1 / (1 + load.damping * half);
  const Vec3 force = load.contact_force + body.mass * load.gravity;
  BodyKick kick;
  kick.middle = slowing * (body.velocity + half / body.mass * force);
  kick.middle_angular_momentum = slowing * (body.angular_momentum + half * load.contact_torque);
  kick.added_force = force - load.damping * body.mass * kick.middle;
  kick.added_torque = load.contact_torque - load.damping * kick.middle_angular_momentum;
  const Vec3 spin = body.inverse_inertia * kick.middle_angular_momentum;
  const Vec3 change = half * (body.pair_force + kick.added_force),
             turn_change = half * (body.pair_torque + kick.added_torque);
  const double squared = body.mass * kick.middle.squaredNorm(),
               spin_squared = spin.dot(kick.middle_angular_momentum);
  kick.kinetic = 0.5 * (squared + change.squaredNorm() / body.mass) +
                 0.5 * (spin_squared + turn_change.dot(body.inverse_inertia * turn_change));
  kick.pair_work = load.step * (body.pair_force.dot(kick.middle) + body.pair_torque.dot(spin));
  kick.contact_work = load.step * (load.contact_force.dot(kick.middle) + load.contact_torque.dot(spin));
  kick.damping_work = -load.step * load.damping * (squared + spin_squared);
  return kick;
}

}  // namespace tuft::dem

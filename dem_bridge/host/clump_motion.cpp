/// The bridge's part in the motion of grains that are clumps: what kicks.cpp and exchange.cpp do for spheres.
#include <array>

#include "dem_bridge/host/engine_impl.h"
#include "dem_bridge/host/kick_sums.h"
#include "dem_bridge/host/load_cursor.h"

namespace tuft::dem {

/// The whole load of a body acts on its centre of mass, so that the spheres' own forces stay those of their
/// contacts.
void LiggghtsEngine::Impl::kick_clumps(bool in_run, KickSums& sums) {
  if (!in_our_order()) {
    trouble = "LIGGGHTS has put the spheres of clumps into another order";
    return;
  }
  const auto* const atom = lammps->atom;
  const double half = 0.5 * shared.step,
               per_second = 1.0 / (static_cast<double>(shared.substeps) * shared.step);
  const auto expelled = memory.array(SharedArrays::expelled);
  LoadCursor cursor(memory.loads());
  BodyLoad load{Vec3(0, 0, 0), Vec3(0, 0, 0), load3(shared.gravity.data()), shared.damping, shared.step};
  for (const Clumps::Body& body : clumps->bodies()) {
    const auto first = static_cast<std::size_t>(body.first),
               end = first + static_cast<std::size_t>(body.count);
    if (expelled[first] != 0) continue;
    BodyState state = clumps->state(body);
    if (in_run) {
      state.velocity += half / state.mass * state.pair_force;
      state.angular_momentum += half * state.pair_torque;
    }
    load.contact_force = load.contact_torque = Vec3(0, 0, 0);
    const Vec3 centre = clumps->centre(body);
    for (const LoadRecord& one : cursor.of(first, end)) {
      const Vec3 force = per_second * load3(one.impulse.data());
      load.contact_force += force;
      load.contact_torque +=
          per_second * load3(one.angular.data()) + (load3(atom->x[one.grain]) - centre).cross(force);
      sums.receive(shared.step * force);
    }
    const BodyKick kick = kick_body(state, load);
    if (in_run) {
      clumps->set_added(body, kick.added_force, kick.added_torque);
    } else {
      clumps->set_motion(body, kick.middle, kick.middle_angular_momentum);
      clumps->set_forces(body, state.pair_force + kick.added_force, state.pair_torque + kick.added_torque);
    }
    sums.kinetic += kick.kinetic;
    sums.pair_work += kick.pair_work;
    sums.contact_work += kick.contact_work;
    sums.damping_work += kick.damping_work;
  }
}

/// A clump leaves as a whole, with its centre of mass, and is booked once: see expel().
void LiggghtsEngine::Impl::expel_clumps() {
  const Vec3 low = load3(shared.box_low.data()), high = load3(shared.box_high.data());
  const auto expelled = memory.array(SharedArrays::expelled);
  const BodyLoad weight{Vec3(0, 0, 0), Vec3(0, 0, 0), load3(shared.gravity.data()), 0, shared.step};
  for (const Clumps::Body& body : clumps->bodies()) {
    const Vec3 x = clumps->centre(body);
    if (expelled[index(body.first)] != 0 ||
        ((x.array() >= low.array()).all() && (x.array() < high.array()).all()))
      continue;
    for (int a = body.first; a < body.first + body.count; ++a) expelled[index(a)] = 1;
    BodyState state = clumps->state(body);
    state.pair_force = state.pair_torque = Vec3(0, 0, 0);
    const Vec3 momentum = state.mass * state.velocity;
    ++report.expelled;
    report.expelled_mass += state.mass;
    for (std::size_t c = 0; c < 3; ++c) report.expelled_momentum[c] += momentum[static_cast<Eigen::Index>(c)];
    report.expelled_energy += kick_body(state, weight).kinetic;
  }
}

/// Before hold_expelled() looks at spheres, which then are parked already.
void LiggghtsEngine::Impl::hold_expelled_clumps() {
  const auto expelled = memory.array(SharedArrays::expelled);
  const Vec3 none(0, 0, 0);
  for (const Clumps::Body& body : clumps->bodies()) {
    if (expelled[index(body.first)] == 0) continue;
    if (!parked.contains(index(body.first))) {
      for (int a = body.first; a < body.first + body.count; ++a) parked[index(a)] = load3(lammps->atom->x[a]);
      clumps->park(body, parking_place(clumps->centre(body)));
    }
    clumps->set_motion(body, none, none);
    clumps->set_forces(body, none, none);
    clumps->set_added(body, none, none);
  }
}

/// From those of the spheres, which move as the driver has set them: rigidly.
void LiggghtsEngine::Impl::take_clump_velocities() {
  const auto* const atom = lammps->atom;
  for (const Clumps::Body& body : clumps->bodies()) {
    Vec3 velocity(0, 0, 0);
    for (int a = body.first; a < body.first + body.count; ++a)
      velocity += clumps->share(a) * load3(atom->v[a]);
    clumps->set_velocity_and_spin(body, velocity, load3(atom->omega[body.first]));
  }
}

/// The half kick that the pair forces have made already, longer by `change` (s).
void LiggghtsEngine::Impl::change_clump_step(double change) {
  for (const Clumps::Body& body : clumps->bodies()) {
    const BodyState state = clumps->state(body);
    clumps->set_motion(body, state.velocity + change / state.mass * state.pair_force,
                       state.angular_momentum + change * state.pair_torque);
  }
}

}  // namespace tuft::dem

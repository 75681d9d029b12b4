/// What goes from the shared memory into LIGGGHTS' arrays and back.
#include <algorithm>
#include <array>

#include "dem_bridge/host/engine_impl.h"
#include "dem_bridge/host/kick.h"

namespace tuft::dem {

/// Positions, velocities and spins, and the grains that have left. The memory is gone through in its own
/// order and LIGGGHTS' arrays, where a grain's three components lie together, out of order: nine arrays
/// written out of order took twice as long.
void LiggghtsEngine::Impl::publish_state() {
  const auto* const atom = lammps->atom;
  const int count = atom->nlocal;
  place.assign(memory.grains(), -1);
  for (int a = 0; a < count; ++a) place[static_cast<std::size_t>(atom->tag[a] - 1)] = a;
  const Components x = components(SharedArrays::position_x), v = components(SharedArrays::velocity_x),
                   w = components(SharedArrays::spin_x);
  const Vec3 low = load3(shared.box_low.data()), high = load3(shared.box_high.data());
  // Rows follow each other: no need to look up where a row begins.
  const double *const positions = count > 0 ? atom->x[0] : nullptr,
                      *const velocities = count > 0 ? atom->v[0] : nullptr,
                      *const spins = count > 0 ? atom->omega[0] : nullptr;
  constexpr std::size_t ahead = 16;  // grains that are fetched before it is their turn
  double poison = 0;
  bool all_inside = true;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (i + ahead < place.size() && place[i + ahead] >= 0) {
      const std::ptrdiff_t next = 3 * static_cast<std::ptrdiff_t>(place[i + ahead]);
      __builtin_prefetch(positions + next);
      __builtin_prefetch(velocities + next);
      __builtin_prefetch(spins + next);
    }
    if (place[i] < 0) continue;
    const std::ptrdiff_t row = 3 * static_cast<std::ptrdiff_t>(place[i]);
    const double *const position = positions + row, *const velocity = velocities + row,
                        *const spin = spins + row;
    x.x[i] = position[0], x.y[i] = position[1], x.z[i] = position[2];
    v.x[i] = velocity[0], v.y[i] = velocity[1], v.z[i] = velocity[2];
    w.x[i] = spin[0], w.y[i] = spin[1], w.z[i] = spin[2];
    for (int c = 0; c < 3; ++c) {
      // 0, or not a number for what is not finite.
      poison += (position[c] - position[c]) + (velocity[c] - velocity[c]) + (spin[c] - spin[c]);
      all_inside &= (position[c] >= low[c]) & (position[c] < high[c]);
    }
  }
  if (poison != 0) {
    const std::array<const char*, 3> names{"position", "velocity", "spin"};
    for (std::size_t f = 0; f < 3 && trouble.empty(); ++f)
      for (std::size_t i = 0; i < place.size() && trouble.empty(); ++i)
        if (place[i] >= 0 && !components(SharedArrays::position_x + 3 * f)[i].allFinite())
          trouble = fmt::format("the {} of grain {} is not finite", names[f], i);
  }
  report.expelled = 0;
  report.expelled_mass = report.expelled_energy = 0;
  report.expelled_momentum = {};
  if (all_inside || !trouble.empty()) return;
  const auto expelled = memory.array(SharedArrays::expelled);
  for (std::size_t i = 0; i < place.size(); ++i)
    if (place[i] >= 0 && expelled[i] == 0 &&
        ((x[i].array() < low.array()).any() || (x[i].array() >= high.array()).any()))
      expel(place[i]);
}

/// Books what a grain takes along that has left the box; LIGGGHTS' own box is wider, so that none is lost to
/// it before. Flying alone, its kinetic energy at the force evaluation that comes is that of the last one
/// and the work of its weight on the way.
void LiggghtsEngine::Impl::expel(int a) {
  auto* const atom = lammps->atom;
  const double mass = atom->rmass[a], radius = atom->radius[a];
  const Vec3 v = load3(atom->v[a]), momentum = mass * v;
  const GrainState grain{v,    load3(atom->omega[a]),       Vec3(0, 0, 0), Vec3(0, 0, 0),
                         mass, 0.4 * mass * radius * radius};
  GrainLoad load{Vec3(0, 0, 0), Vec3(0, 0, 0), load3(shared.gravity.data()), 0, shared.step};
  memory.array(SharedArrays::expelled)[index(a)] = 1;
  ++report.expelled;
  report.expelled_mass += mass;
  for (std::size_t c = 0; c < 3; ++c) report.expelled_momentum[c] += momentum[static_cast<Eigen::Index>(c)];
  report.expelled_energy += kick_grain(grain, load).kinetic;
}

/// Expelled grains stand still where they left, and nothing touches them, from the kick after that on: until
/// then velocity, forces and size are those of the last evaluation, which contacts are listed for.
void LiggghtsEngine::Impl::hold_expelled() {
  auto* const atom = lammps->atom;
  const auto expelled = memory.array(SharedArrays::expelled), radius = memory.array(SharedArrays::radius);
  for (int a = 0; a < local_count(); ++a) {
    const std::size_t i = index(a);
    if (expelled[i] == 0) continue;
    for (double** field : {atom->v, atom->omega, atom->f, atom->torque}) store3(field[a], Vec3(0, 0, 0));
    atom->radius[a] = 1e-6 * radius[i];
  }
  for (int ghost = atom->nlocal; ghost < atom->nlocal + atom->nghost; ++ghost)
    if (expelled[index(ghost)] != 0) atom->radius[ghost] = 1e-6 * radius[index(ghost)];
}

/// Adds the window's load to the forces. In a run LIGGGHTS makes the closing half kick afterwards, under all
/// forces. Between runs it has made it already, under the pair forces: then the rest of it is made here.
void LiggghtsEngine::Impl::kick(bool in_run) {
  auto* const atom = lammps->atom;
  double** const v = atom->v;
  double** const omega = atom->omega;
  double** const f = atom->f;
  double** const torque = atom->torque;
  const GrainLoadRecord* const loads = memory.loads().data();
  const double per_second =
      1.0 / (static_cast<double>(shared.substeps) * shared.step);  // even over the substeps
  const double half = 0.5 * shared.step;
  GrainLoad load;
  load.gravity = load3(shared.gravity.data());
  load.damping = shared.damping;
  load.step = shared.step;
  Vec3 received(0, 0, 0), scale(0, 0, 0);
  double kinetic = 0, pair_work = 0, contact_work = 0, damping_work = 0;
  const bool some_expelled = shared.expelled > 0;
  const double* const expelled = memory.array(SharedArrays::expelled).data();
  if (some_expelled) hold_expelled();
  constexpr int ahead = 16;  // grains for which the load is fetched before it is their turn
  const int count = atom->nlocal;
  for (int a = 0; a < count; ++a) {
    if (a + ahead < count) __builtin_prefetch(loads + index(a + ahead));
    const std::size_t i = index(a);
    if (some_expelled && expelled[i] != 0) continue;
    const double mass = atom->rmass[a], radius = atom->radius[a];
    GrainState grain{
        load3(v[a]), load3(omega[a]), load3(f[a]), load3(torque[a]), mass, 0.4 * mass * radius * radius};
    if (in_run) {
      grain.velocity += half / mass * grain.pair_force;
      grain.spin += half / grain.inertia * grain.pair_torque;
    }
    load.contact_force = per_second * load3(loads[i].linear.data());
    load.contact_torque = per_second * load3(loads[i].angular.data());
    const GrainKick kick = kick_grain(grain, load);
    store3(f[a], grain.pair_force + kick.added_force);
    store3(torque[a], grain.pair_torque + kick.added_torque);
    if (!in_run) {
      store3(v[a], kick.middle);
      store3(omega[a], kick.middle_spin);
    }
    received += shared.step * load.contact_force;
    scale += shared.step * load.contact_force.cwiseAbs();
    kinetic += kick.kinetic;
    pair_work += kick.pair_work;
    contact_work += kick.contact_work;
    damping_work += kick.damping_work;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    report.impulse_received[c] += received[static_cast<Eigen::Index>(c)];
    report.impulse_scale[c] += scale[static_cast<Eigen::Index>(c)];
  }
  if (shared.energy_wanted != 0 && (in_run ? substep : 0) == shared.substeps - 1) note_stored_energy();
  report.kinetic = kinetic;
  report.pair_work += report.last_pair_work = pair_work;
  report.contact_work += report.last_contact_work = contact_work;
  report.damping_work += report.last_damping_work = damping_work;
}

void LiggghtsEngine::Impl::take_velocities() {
  const Components v = components(SharedArrays::velocity_x), w = components(SharedArrays::spin_x);
  for (int a = 0; a < local_count(); ++a) {
    store3(lammps->atom->v[a], v[index(a)]);
    store3(lammps->atom->omega[a], w[index(a)]);
  }
}

void LiggghtsEngine::Impl::publish_own_forces() {
  for (int a = 0; a < local_count(); ++a) {
    GrainLoadRecord& record = memory.loads()[index(a)];
    std::copy_n(lammps->atom->f[a], 3, record.linear.begin());
    std::copy_n(lammps->atom->torque[a], 3, record.angular.begin());
  }
}

void LiggghtsEngine::Impl::restore_own_forces() {
  for (int a = 0; a < local_count(); ++a) {
    const GrainLoadRecord& record = memory.loads()[index(a)];
    std::copy_n(record.linear.begin(), 3, lammps->atom->f[a]);
    std::copy_n(record.angular.begin(), 3, lammps->atom->torque[a]);
  }
}

}  // namespace tuft::dem

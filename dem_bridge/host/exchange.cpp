/// What goes from the shared memory into LIGGGHTS' arrays and back.
#include <algorithm>
#include <array>

#include "core/prefetch.h"
#include "dem_bridge/host/engine_impl.h"
#include "dem_bridge/host/kick.h"

namespace tuft::dem {

/// LIGGGHTS is told not to sort its grains, and packings number them so that neighbours in space have nearly
/// the same numbers: so on one rank its arrays are in our order, and steps run straight through memory.
bool LiggghtsEngine::Impl::in_our_order() const {
  const auto* const atom = lammps->atom;
  const auto count = static_cast<std::size_t>(atom->nlocal);
  if (count != memory.grains()) return false;
  const int* const tag = atom->tag;
  int strangers = 0;
#pragma omp simd reduction(+ : strangers)
  for (std::size_t a = 0; a < count; ++a) strangers += tag[a] != static_cast<int>(a) + 1;
  return strangers == 0;
}

/// True when all values are finite; `all_inside` as found.
///
/// The memory is gone through in its own order and LIGGGHTS' arrays, where a grain's three components lie
/// together, out of order: nine arrays written out of order took twice as long.
bool LiggghtsEngine::Impl::copy_by_number(bool& all_inside) {
  const auto* const atom = lammps->atom;
  const Components x = components(SharedArrays::position_x), v = components(SharedArrays::velocity_x),
                   w = components(SharedArrays::spin_x);
  const Vec3 low = load3(shared.box_low.data()), high = load3(shared.box_high.data());
  const double *const positions = atom->nlocal > 0 ? atom->x[0] : nullptr,
                      *const velocities = atom->nlocal > 0 ? atom->v[0] : nullptr,
                      *const spins = atom->nlocal > 0 ? atom->omega[0] : nullptr;
  const double* const radius = atom->radius;
  std::uint64_t fast = 0;
  constexpr std::size_t ahead = 16;  // grains that are fetched before it is their turn
  double poison = 0;
  all_inside = true;
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (i + ahead < place.size() && place[i + ahead] >= 0) {
      const std::ptrdiff_t next = 3 * static_cast<std::ptrdiff_t>(place[i + ahead]);
      prefetch(positions + next, 3);
      prefetch(velocities + next, 3);
      prefetch(spins + next, 3);
    }
    if (place[i] < 0) continue;
    const std::ptrdiff_t row = 3 * static_cast<std::ptrdiff_t>(place[i]);
    const double *const position = positions + row, *const velocity = velocities + row,
                        *const spin = spins + row;
    x.x[i] = position[0], x.y[i] = position[1], x.z[i] = position[2];
    v.x[i] = velocity[0], v.y[i] = velocity[1], v.z[i] = velocity[2];
    w.x[i] = spin[0], w.y[i] = spin[1], w.z[i] = spin[2];
    fast += moves_past_itself(velocity[0], velocity[1], velocity[2], radius[place[i]], shared.step);
    for (int c = 0; c < 3; ++c) {
      // 0, or not a number for what is not finite.
      poison += (position[c] - position[c]) + (velocity[c] - velocity[c]) + (spin[c] - spin[c]);
      all_inside &= (position[c] >= low[c]) & (position[c] < high[c]);
    }
  }
  report.fast = fast;
  return poison == 0;
}

/// Positions, velocities and spins, and the grains that have left.
void LiggghtsEngine::Impl::publish_state() {
  const auto* const atom = lammps->atom;
  const auto find_places = [&] {
    place.assign(memory.grains(), -1);
    for (int a = 0; a < atom->nlocal; ++a) place[index(a)] = a;
  };
  // Places are needed only of grains that have left where all are written and still in order.
  const bool is_written = written && in_our_order();
  bool finite = true, all_inside = true;
  if (is_written) {
    finite = written->poison == 0;
    all_inside = written->outside == 0;
    report.fast = written->fast;
  } else {
    find_places();
    finite = copy_by_number(all_inside);
  }
  for (const auto& [i, left] : parked) {
    components(SharedArrays::position_x).set(i, left);
    for (const std::size_t motion : {SharedArrays::velocity_x, SharedArrays::spin_x})
      components(motion).set(i, Vec3(0, 0, 0));
  }
  report.expelled = 0;
  report.expelled_mass = report.expelled_energy = 0;
  report.expelled_momentum = {};
  if (finite && all_inside) return;
  if (is_written) find_places();
  if (!finite) {
    const std::array<const char*, 3> names{"position", "velocity", "spin"};
    for (std::size_t f = 0; f < 3 && trouble.empty(); ++f)
      for (std::size_t i = 0; i < place.size() && trouble.empty(); ++i)
        if (place[i] >= 0 && !components(SharedArrays::position_x + 3 * f)[i].allFinite())
          trouble = fmt::format("the {} of grain {} is not finite", names[f], i);
    return;
  }
  const Components x = components(SharedArrays::position_x);
  const Vec3 low = load3(shared.box_low.data()), high = load3(shared.box_high.data());
  const auto expelled = memory.array(SharedArrays::expelled);
  expel_clumps();
  for (std::size_t i = 0; i < place.size(); ++i)
    if (place[i] >= 0 && expelled[i] == 0 && clumps->of_atom(place[i]) < 0 &&
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

void LiggghtsEngine::Impl::take_velocities() {
  const Components v = components(SharedArrays::velocity_x), w = components(SharedArrays::spin_x);
  for (int a = 0; a < local_count(); ++a) {
    store3(lammps->atom->v[a], v[index(a)]);
    store3(lammps->atom->omega[a], w[index(a)]);
  }
  take_clump_velocities();
}

void LiggghtsEngine::Impl::publish_own_forces() {
  const Components force = components(SharedArrays::own_force_x),
                   torque = components(SharedArrays::own_torque_x);
  for (int a = 0; a < local_count(); ++a) {
    force.set(index(a), load3(lammps->atom->f[a]));
    torque.set(index(a), load3(lammps->atom->torque[a]));
  }
}

void LiggghtsEngine::Impl::restore_own_forces() {
  const Components force = components(SharedArrays::own_force_x),
                   torque = components(SharedArrays::own_torque_x);
  for (int a = 0; a < local_count(); ++a) {
    store3(lammps->atom->f[a], force[index(a)]);
    store3(lammps->atom->torque[a], torque[index(a)]);
  }
}

}  // namespace tuft::dem

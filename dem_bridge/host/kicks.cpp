/// The step of grains: spheres by the bridge, clumps with its part of their forces; and grains that have
/// left.
#include <algorithm>

#include "dem_bridge/host/engine_impl.h"
#include "dem_bridge/host/kick_sums.h"
#include "dem_bridge/host/load_cursor.h"
#include "dem_bridge/host/sphere_steps.h"

namespace tuft::dem {

/// Out of reach of all others.
Vec3 LiggghtsEngine::Impl::parking_place(const Vec3& left) const {
  const Vec3 low = load3(shared.box_low.data()), high = load3(shared.box_high.data());
  Vec3 place_to_be = left;
  for (Eigen::Index c = 0; c < 3; ++c) {
    if (left[c] < low[c])
      place_to_be[c] = low[c] - parking_distance;
    else if (left[c] >= high[c])
      place_to_be[c] = high[c] + parking_distance;
  }
  return place_to_be;
}

/// A point nearly, for those that may be parked there too.
void LiggghtsEngine::Impl::park(int a) {
  auto* const atom = lammps->atom;
  const Vec3 left = load3(atom->x[a]);
  parked[index(a)] = left;
  store3(atom->x[a], parking_place(left));
  atom->radius[a] *= 1e-6;
}

/// After a restart: which of the grains that have left are parked already, as those are that are elsewhere.
void LiggghtsEngine::Impl::find_parked() {
  const auto expelled = memory.array(SharedArrays::expelled);
  const Components left = components(SharedArrays::position_x);
  for (int a = 0; a < local_count(); ++a)
    if (const std::size_t i = index(a); expelled[i] != 0 && load3(lammps->atom->x[a]) != left[i])
      parked[i] = left[i];
}

/// Expelled grains stand still, and nothing touches them, from the kick after that on: until then place,
/// velocity, forces and size are those of the last evaluation, which contacts are listed for.
void LiggghtsEngine::Impl::hold_expelled() {
  auto* const atom = lammps->atom;
  const auto expelled = memory.array(SharedArrays::expelled);
  hold_expelled_clumps();
  for (int a = 0; a < local_count(); ++a) {
    const std::size_t i = index(a);
    if (expelled[i] == 0) continue;
    if (!parked.contains(i)) park(a);
    for (double** field : {atom->v, atom->omega, atom->f, atom->torque}) store3(field[a], Vec3(0, 0, 0));
  }
}

/// One step of all grains under LIGGGHTS' forces and the window's load: spheres to x(t + dt), v(t + dt/2). Of
/// clumps, which LIGGGHTS integrates: in a run it makes the closing half kick afterwards, under all forces;
/// between runs it has made it already, under the pair forces, and the rest of it is made here.
void LiggghtsEngine::Impl::step_grains(bool in_run) {
  auto* const atom = lammps->atom;
  const auto count = static_cast<std::size_t>(atom->nlocal);
  const bool last = (in_run ? substep : 0) == shared.substeps - 1;
  if (shared.expelled > 0) hold_expelled();
  KickSums sums;
  written.reset();
  // Where the forces are from: spheres move on in this.
  if (last && shared.energy_wanted == EnergyWanted::all) note_stored_energy();
  if (count > 0) {
    const SphereStep step{atom->x[0], atom->v[0], atom->omega[0], atom->f[0], atom->torque[0], atom->rmass,
                          atom->radius, shared.step,
                          // Even over the substeps.
                          1.0 / (static_cast<double>(shared.substeps) * shared.step), shared.damping,
                          load3(shared.gravity.data())};
    LoadCursor cursor(memory.loads());
    if (!clumps->empty()) kick_clumps(in_run, sums);
    if (clumps->empty() && in_our_order())
      step_in_order(step, last, cursor, sums);
    else
      step_by_number(step, cursor, sums);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    report.impulse_received[c] += sums.received[c];
    report.impulse_scale[c] += sums.scale[c];
  }
  report.kinetic = sums.kinetic;
  report.pair_work += report.last_pair_work = sums.pair_work;
  report.contact_work += report.last_contact_work = sums.contact_work;
  report.damping_work += report.last_damping_work = sums.damping_work;
}

/// All that are not parked, as many at once as there are lanes. What LIGGGHTS then evaluates forces for is
/// what the driver is to see, after the last step of a window: it is written while it is at hand.
void LiggghtsEngine::Impl::step_in_order(const SphereStep& step, bool last, LoadCursor& cursor,
                                         KickSums& sums) {
  const bool with_kinetic = shared.energy_wanted != EnergyWanted::none;
  if (last) {
    const Components x = components(SharedArrays::position_x), v = components(SharedArrays::velocity_x),
                     w = components(SharedArrays::spin_x);
    written = StateOut{x.x,
                       x.y,
                       x.z,
                       v.x,
                       v.y,
                       v.z,
                       w.x,
                       w.y,
                       w.z,
                       load3(shared.box_low.data()),
                       load3(shared.box_high.data())};
  }
  std::size_t first = 0;
  const auto up_to = [&](std::size_t end) {
    step_spheres(step, first, end, with_kinetic, cursor, sums, written ? &*written : nullptr);
    first = end + 1;
  };
  for (const auto& [i, left] : parked) up_to(i);
  up_to(static_cast<std::size_t>(local_count()));
}

void LiggghtsEngine::Impl::step_by_number(const SphereStep& step, LoadCursor& cursor, KickSums& sums) {
  const auto expelled = memory.array(SharedArrays::expelled);
  for (int a = 0; a < local_count(); ++a) {
    const std::size_t i = index(a);
    if (expelled[i] != 0 || clumps->of_atom(a) >= 0) continue;
    step_sphere(step, static_cast<std::size_t>(a), cursor.of(i, i + 1), sums);
  }
}

}  // namespace tuft::dem

/// What the bridge adds to LIGGGHTS' forces at every step, and the sums of energy that go with it.
#include <algorithm>
#include <array>

#include "dem_bridge/host/engine_impl.h"
#include "dem_bridge/host/kick.h"
#include "dem_bridge/host/kick_sums.h"
#include "dem_bridge/host/load_cursor.h"

namespace tuft::dem {
namespace {

/// A kick of LIGGGHTS' grains, of a step that is under way (`in_run`) or between two runs.
///
/// In a run what is added goes to the forces, for both half kicks are to come. Between runs it goes to the
/// velocities as a whole: LIGGGHTS still makes its second half kick under the forces that it has, and those
/// need not be written.
struct Kick {
  double *velocity, *spin, *force, *torque;  // rows of three, one behind the other
  const double *mass, *radius;
  double step, per_second, damping;
  Vec3 gravity;
  bool in_run;
};

/// The grain in place `a` of LIGGGHTS' arrays. `loads`: its own, one or none.
void kick_one(const Kick& kick, std::size_t a, std::span<const LoadRecord> loads, KickSums& sums) {
  const double half = 0.5 * kick.step, mass = kick.mass[a], radius = kick.radius[a];
  double *const v = kick.velocity + 3 * a, *const w = kick.spin + 3 * a, *const f = kick.force + 3 * a,
                *const t = kick.torque + 3 * a;
  GrainState grain{load3(v), load3(w), load3(f), load3(t), mass, 0.4 * mass * radius * radius};
  if (kick.in_run) {
    grain.velocity += half / mass * grain.pair_force;
    grain.spin += half / grain.inertia * grain.pair_torque;
  }
  GrainLoad load{Vec3(0, 0, 0), Vec3(0, 0, 0), kick.gravity, kick.damping, kick.step};
  if (!loads.empty()) {
    load.contact_force = kick.per_second * load3(loads.front().impulse.data());
    load.contact_torque = kick.per_second * load3(loads.front().angular.data());
  }
  const GrainKick done = kick_grain(grain, load);
  if (kick.in_run) {
    store3(f, grain.pair_force + done.added_force);
    store3(t, grain.pair_torque + done.added_torque);
  } else {
    store3(v, done.middle + done.gain);
    store3(w, done.middle_spin + done.spin_gain);
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const double impulse = kick.step * load.contact_force[static_cast<Eigen::Index>(c)];
    sums.received[c] += impulse;
    sums.scale[c] += std::abs(impulse);
  }
  sums.kinetic += done.kinetic;
  sums.pair_work += done.pair_work;
  sums.contact_work += done.contact_work;
  sums.damping_work += done.damping_work;
}

/// Grains that are kicked at once.
constexpr std::size_t kick_block_size = 32;
static_assert(kick_block_size % lanes == 0);

/// Three values of each grain of a block, by component, and back.
struct alignas(stdx::memory_alignment_v<Pack>) BlockRows {
  std::array<double, kick_block_size> x, y, z;

  void read(const double* rows) {
    for (std::size_t k = 0; k < kick_block_size; ++k) {
      x[k] = rows[3 * k];
      y[k] = rows[3 * k + 1];
      z[k] = rows[3 * k + 2];
    }
  }
  void write(double* rows) const {
    for (std::size_t k = 0; k < kick_block_size; ++k) {
      rows[3 * k] = x[k];
      rows[3 * k + 1] = y[k];
      rows[3 * k + 2] = z[k];
    }
  }
  [[nodiscard]] Pack3 pack(std::size_t k) const { return {load(&x[k]), load(&y[k]), load(&z[k])}; }
  void set(std::size_t k, const Pack3& value) {
    store(&x[k], value.x);
    store(&y[k], value.y);
    store(&z[k], value.z);
  }
};

/// Contact forces and torques on the grains of a block.
struct BlockLoads {
  BlockRows force, torque;                              ///< set in packs of which any grain is touched
  std::array<bool, kick_block_size / lanes> touched{};  ///< by pack

  void read(std::span<const LoadRecord> loads, std::size_t first, double per_second) {
    for (const LoadRecord& load : loads) {
      const std::size_t k = load.grain - first, pack = k / lanes;
      if (!touched[pack]) {
        const Pack none = 0.0;
        force.set(pack * lanes, {none, none, none});
        torque.set(pack * lanes, {none, none, none});
        touched[pack] = true;
      }
      force.x[k] = per_second * load.impulse[0];
      force.y[k] = per_second * load.impulse[1];
      force.z[k] = per_second * load.impulse[2];
      torque.x[k] = per_second * load.angular[0];
      torque.y[k] = per_second * load.angular[1];
      torque.z[k] = per_second * load.angular[2];
    }
  }
};

Pack3 absolute(const Pack3& a) {
  using std::abs;
  return {abs(a.x), abs(a.y), abs(a.z)};
}

/// As kick_one for the block of grains from `first` on, which lie in our order, as many at once as there are
/// lanes. `loads`: of these grains. Those that free_kick is for take it: two divisions fewer, and no masses.
template <bool in_run, bool loaded, bool with_kinetic>
void kick_block(const Kick& kick, std::size_t first, std::span<const LoadRecord> loads, KickSums& sums) {
  BlockRows v, w, f, t;
  v.read(kick.velocity + 3 * first);
  w.read(kick.spin + 3 * first);
  f.read(kick.force + 3 * first);
  t.read(kick.torque + 3 * first);
  BlockLoads block_loads;
  if constexpr (loaded) block_loads.read(loads, first, kick.per_second);
  const double half = 0.5 * kick.step;
  const Pack none = 0.0;
  const Pack3 gravity{kick.gravity.x(), kick.gravity.y(), kick.gravity.z()};
  Pack kinetic = 0.0, pair_work = 0.0, contact_work = 0.0, damping_work = 0.0;
  Pack3 received{none, none, none}, scale{none, none, none};
  const bool may_be_free = !in_run && !with_kinetic && kick.damping == 0;
  const Pack3 half_gravity{half * kick.gravity.x(), half * kick.gravity.y(), half * kick.gravity.z()};
  for (std::size_t k = 0; k < kick_block_size; k += lanes) {
    if (may_be_free && !block_loads.touched[k / lanes]) {
      const auto done = free_kick(v.pack(k), w.pack(k), f.pack(k), t.pack(k), half_gravity, Pack(kick.step));
      v.set(k, done.velocity);
      pair_work += done.pair_work;
      continue;
    }
    const Pack mass(kick.mass + first + k, stdx::element_aligned),
        radius(kick.radius + first + k, stdx::element_aligned);
    GrainStateOf<Pack3, Pack> grain{v.pack(k), w.pack(k), f.pack(k),
                                    t.pack(k), mass,      0.4 * mass * radius * radius};
    if constexpr (in_run) {
      const Pack of_force = half / mass, of_torque = half / grain.inertia;
      grain.velocity = grain.velocity + of_force * grain.pair_force;
      grain.spin = grain.spin + of_torque * grain.pair_torque;
    }
    GrainLoadOf<Pack3> load{{none, none, none}, {none, none, none}, gravity, kick.damping, kick.step};
    if (loaded && block_loads.touched[k / lanes]) {
      load.contact_force = block_loads.force.pack(k);
      load.contact_torque = block_loads.torque.pack(k);
      received = received + load.contact_force;
      scale = scale + absolute(load.contact_force);
    }
    const auto done = kick_grain(grain, load);
    if constexpr (in_run) {
      f.set(k, grain.pair_force + done.added_force);
      t.set(k, grain.pair_torque + done.added_torque);
    } else {
      v.set(k, done.middle + done.gain);
      w.set(k, done.middle_spin + done.spin_gain);
    }
    if constexpr (with_kinetic) kinetic += done.kinetic;
    pair_work += done.pair_work;
    contact_work += done.contact_work;
    damping_work += done.damping_work;
  }
  const bool turned = loaded || kick.damping != 0;
  if constexpr (in_run) {
    f.write(kick.force + 3 * first);
    if (turned) t.write(kick.torque + 3 * first);
  } else {
    v.write(kick.velocity + 3 * first);
    if (turned) w.write(kick.spin + 3 * first);
  }
  sums.kinetic += sum_lanes(kinetic);
  sums.pair_work += sum_lanes(pair_work);
  sums.contact_work += sum_lanes(contact_work);
  sums.damping_work += sum_lanes(damping_work);
  if constexpr (loaded) {
    const std::array<const Pack*, 3> of_load{&received.x, &received.y, &received.z},
        of_scale{&scale.x, &scale.y, &scale.z};
    for (std::size_t c = 0; c < 3; ++c) {
      sums.received[c] += kick.step * sum_lanes(*of_load[c]);
      sums.scale[c] += kick.step * sum_lanes(*of_scale[c]);
    }
  }
}

/// The grains from `first` to before `end`, which lie in our order.
template <bool in_run, bool with_kinetic>
void kick_in_order(const Kick& kick, std::size_t first, std::size_t end, LoadCursor& cursor, KickSums& sums) {
  for (; first + kick_block_size <= end; first += kick_block_size) {
    const auto loads = cursor.of(first, first + kick_block_size);
    loads.empty() ? kick_block<in_run, false, with_kinetic>(kick, first, loads, sums)
                  : kick_block<in_run, true, with_kinetic>(kick, first, loads, sums);
  }
  for (; first < end; ++first) kick_one(kick, first, cursor.of(first, first + 1), sums);
}

}  // namespace

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

/// Adds the window's load to the forces. In a run LIGGGHTS makes the closing half kick afterwards, under all
/// forces. Between runs it has made it already, under the pair forces: then the rest of it is made here.
void LiggghtsEngine::Impl::kick(bool in_run) {
  auto* const atom = lammps->atom;
  const auto count = static_cast<std::size_t>(atom->nlocal);
  const bool some_expelled = shared.expelled > 0;
  if (some_expelled) hold_expelled();
  KickSums sums;
  if (count > 0) {
    const Kick kick{atom->v[0], atom->omega[0], atom->f[0], atom->torque[0], atom->rmass, atom->radius,
                    shared.step,
                    // Even over the substeps.
                    1.0 / (static_cast<double>(shared.substeps) * shared.step), shared.damping,
                    load3(shared.gravity.data()), in_run};
    const auto expelled = memory.array(SharedArrays::expelled);
    LoadCursor cursor(memory.loads());
    if (!clumps->empty()) kick_clumps(in_run, sums);
    if (clumps->empty() && in_our_order()) {
      std::size_t first = 0;
      const auto kick_up_to = [&](std::size_t end) {
        const bool with_kinetic = shared.energy_wanted != EnergyWanted::none;
        const auto of_all = in_run ? with_kinetic ? kick_in_order<true, true> : kick_in_order<true, false>
                            : with_kinetic ? kick_in_order<false, true>
                                           : kick_in_order<false, false>;
        of_all(kick, first, end, cursor, sums);
        first = end + 1;
      };
      for (const auto& [i, left] : parked) kick_up_to(i);
      kick_up_to(count);
    } else {
      for (std::size_t a = 0; a < count; ++a) {
        const std::size_t i = index(static_cast<int>(a));
        if (some_expelled && expelled[i] != 0) continue;
        if (clumps->of_atom(static_cast<int>(a)) >= 0) continue;
        kick_one(kick, a, cursor.of(i, i + 1), sums);
      }
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    report.impulse_received[c] += sums.received[c];
    report.impulse_scale[c] += sums.scale[c];
  }
  if (shared.energy_wanted == EnergyWanted::all && (in_run ? substep : 0) == shared.substeps - 1)
    note_stored_energy();
  report.kinetic = sums.kinetic;
  report.pair_work += report.last_pair_work = sums.pair_work;
  report.contact_work += report.last_contact_work = sums.contact_work;
  report.damping_work += report.last_damping_work = sums.damping_work;
}

}  // namespace tuft::dem

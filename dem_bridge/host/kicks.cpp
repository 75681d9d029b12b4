/// What the bridge adds to LIGGGHTS' forces at every step, and the sums of energy that go with it.
#include <algorithm>
#include <array>

#include "dem_bridge/host/engine_impl.h"
#include "dem_bridge/host/kick.h"
#include "dem_bridge/host/kick_sums.h"

namespace tuft::dem {
namespace {

/// A kick of LIGGGHTS' grains, of a step that is under way (`in_run`) or between two runs.
struct Kick {
  double *velocity, *spin, *force, *torque;  // rows of three, one behind the other
  const double *mass, *radius;
  std::array<const double*, 6> impulses;  // of the window: linear, angular; by the grain's number
  double step, per_second, damping;
  Vec3 gravity;
  bool in_run;
};

/// Grain `i`, in place `a` of LIGGGHTS' arrays.
void kick_one(const Kick& kick, std::size_t a, std::size_t i, bool loaded, KickSums& sums) {
  const double half = 0.5 * kick.step, mass = kick.mass[a], radius = kick.radius[a];
  double *const v = kick.velocity + 3 * a, *const w = kick.spin + 3 * a, *const f = kick.force + 3 * a,
                *const t = kick.torque + 3 * a;
  GrainState grain{load3(v), load3(w), load3(f), load3(t), mass, 0.4 * mass * radius * radius};
  if (kick.in_run) {
    grain.velocity += half / mass * grain.pair_force;
    grain.spin += half / grain.inertia * grain.pair_torque;
  }
  GrainLoad load{Vec3(0, 0, 0), Vec3(0, 0, 0), kick.gravity, kick.damping, kick.step};
  if (loaded) {
    const auto& p = kick.impulses;
    load.contact_force = kick.per_second * Vec3(p[0][i], p[1][i], p[2][i]);
    load.contact_torque = kick.per_second * Vec3(p[3][i], p[4][i], p[5][i]);
  }
  const GrainKick done = kick_grain(grain, load);
  store3(f, grain.pair_force + done.added_force);
  store3(t, grain.pair_torque + done.added_torque);
  if (!kick.in_run) {
    store3(v, done.middle);
    store3(w, done.middle_spin);
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

static_assert(load_block % lanes == 0);

/// Three values of each grain of a block, by component, and back.
struct alignas(stdx::memory_alignment_v<Pack>) BlockRows {
  std::array<double, load_block> x, y, z;

  void read(const double* rows, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      x[k] = rows[3 * k];
      y[k] = rows[3 * k + 1];
      z[k] = rows[3 * k + 2];
    }
  }
  void write(double* rows, std::size_t count) const {
    for (std::size_t k = 0; k < count; ++k) {
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

/// Of the grains from i on, three components from `first` on.
Pack3 forces_of(const Kick& kick, std::size_t first, std::size_t i) {
  const Pack scale = kick.per_second;
  const auto component = [&](std::size_t c) { return scale * load(kick.impulses[first + c] + i); };
  return {component(0), component(1), component(2)};
}

Pack3 absolute(const Pack3& a) {
  using std::abs;
  return {abs(a.x), abs(a.y), abs(a.z)};
}

/// As kick_one for the block of grains from `first` on, which lie in our order, as many at once as there are
/// lanes.
template <bool in_run, bool loaded>
void kick_block(const Kick& kick, std::size_t first, KickSums& sums) {
  BlockRows v, w, f, t;
  v.read(kick.velocity + 3 * first, load_block);
  w.read(kick.spin + 3 * first, load_block);
  f.read(kick.force + 3 * first, load_block);
  t.read(kick.torque + 3 * first, load_block);
  const double half = 0.5 * kick.step;
  const Pack none = 0.0;
  const Pack3 gravity{kick.gravity.x(), kick.gravity.y(), kick.gravity.z()};
  Pack kinetic = 0.0, pair_work = 0.0, contact_work = 0.0, damping_work = 0.0;
  Pack3 received{none, none, none}, scale{none, none, none};
  for (std::size_t k = 0; k < load_block; k += lanes) {
    const Pack mass(kick.mass + first + k, stdx::element_aligned),
        radius(kick.radius + first + k, stdx::element_aligned);
    GrainStateOf<Pack3, Pack> grain{v.pack(k), w.pack(k), f.pack(k),
                                    t.pack(k), mass,      0.4 * mass * radius * radius};
    if constexpr (in_run) {
      grain.velocity = grain.velocity + Pack(half / mass) * grain.pair_force;
      grain.spin = grain.spin + Pack(half / grain.inertia) * grain.pair_torque;
    }
    GrainLoadOf<Pack3> load{{none, none, none}, {none, none, none}, gravity, kick.damping, kick.step};
    if constexpr (loaded) {
      load.contact_force = forces_of(kick, 0, first + k);
      load.contact_torque = forces_of(kick, 3, first + k);
      received = received + load.contact_force;
      scale = scale + absolute(load.contact_force);
    }
    const auto done = kick_grain(grain, load);
    f.set(k, grain.pair_force + done.added_force);
    t.set(k, grain.pair_torque + done.added_torque);
    if constexpr (!in_run) {
      v.set(k, done.middle);
      w.set(k, done.middle_spin);
    }
    kinetic += done.kinetic;
    pair_work += done.pair_work;
    contact_work += done.contact_work;
    damping_work += done.damping_work;
  }
  f.write(kick.force + 3 * first, load_block);
  t.write(kick.torque + 3 * first, load_block);
  if constexpr (!in_run) {
    v.write(kick.velocity + 3 * first, load_block);
    w.write(kick.spin + 3 * first, load_block);
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

/// All grains, which lie in our order.
template <bool in_run>
void kick_in_order(const Kick& kick, std::size_t count, const double* loaded, KickSums& sums) {
  std::size_t first = 0;
  for (; first + load_block <= count; first += load_block)
    loaded[first / load_block] != 0 ? kick_block<in_run, true>(kick, first, sums)
                                    : kick_block<in_run, false>(kick, first, sums);
  for (; first < count; ++first) kick_one(kick, first, first, loaded[first / load_block] != 0, sums);
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
    std::array<const double*, 6> impulses{};
    for (std::size_t c = 0; c < 6; ++c) impulses[c] = memory.array(SharedArrays::impulse_x + c).data();
    const Kick kick{atom->v[0], atom->omega[0], atom->f[0], atom->torque[0], atom->rmass, atom->radius,
                    impulses, shared.step,
                    // Even over the substeps.
                    1.0 / (static_cast<double>(shared.substeps) * shared.step), shared.damping,
                    load3(shared.gravity.data()), in_run};
    const auto loaded = memory.array(SharedArrays::loaded), expelled = memory.array(SharedArrays::expelled);
    if (!clumps->empty()) kick_clumps(in_run, sums);
    if (!some_expelled && clumps->empty() && in_our_order()) {
      in_run ? kick_in_order<true>(kick, count, loaded.data(), sums)
             : kick_in_order<false>(kick, count, loaded.data(), sums);
    } else {
      for (std::size_t a = 0; a < count; ++a) {
        const std::size_t i = index(static_cast<int>(a));
        if (some_expelled && expelled[i] != 0) continue;
        if (clumps->of_atom(static_cast<int>(a)) >= 0) continue;
        kick_one(kick, a, i, loaded[i / load_block] != 0, sums);
      }
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    report.impulse_received[c] += sums.received[c];
    report.impulse_scale[c] += sums.scale[c];
  }
  if (shared.energy_wanted != 0 && (in_run ? substep : 0) == shared.substeps - 1) note_stored_energy();
  report.kinetic = sums.kinetic;
  report.pair_work += report.last_pair_work = sums.pair_work;
  report.contact_work += report.last_contact_work = sums.contact_work;
  report.damping_work += report.last_damping_work = sums.damping_work;
}

}  // namespace tuft::dem

#include "dem_bridge/host/liggghts_engine.h"

#include <fmt/format.h>
#include <mpi.h>

#include <liggghts/lammps.h>
// LIGGGHTS' headers lean on each other's order.
#include <liggghts/atom.h>
#include <liggghts/fix_external.h>
#include <liggghts/fix_property_global.h>
#include <liggghts/force.h>
#include <liggghts/input.h>
#include <liggghts/integrate.h>
#include <liggghts/modify.h>
#include <liggghts/neigh_list.h>
#include <liggghts/pair_gran.h>
#include <liggghts/update.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/vector.h"
#include "dem_bridge/cohesion.h"
#include "dem_bridge/hertz.h"
#include "dem_bridge/hooke.h"
#include "dem_bridge/hooke_hysteresis.h"
#include "dem_bridge/host/contact_history.h"
#include "dem_bridge/host/contact_network.h"
#include "dem_bridge/host/kick.h"
#include "dem_bridge/host/screen_ring.h"

namespace tuft::dem {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Vec3 load3(const double* p) {
  return {p[0], p[1], p[2]};
}
/// One grain's entry of three arrays that follow each other.
struct Components {
  double *x, *y, *z;
  [[nodiscard]] Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
};

void store3(double* p, const Vec3& v) {
  p[0] = v.x();
  p[1] = v.y();
  p[2] = v.z();
}

}  // namespace

struct LiggghtsEngine::Impl {
  SharedMemory& memory;
  SharedState& shared;
  LAMMPS_NS::LAMMPS* lammps = nullptr;
  bool started = false;
  bool stepping = false;        // callbacks outside `advance` (set-ups) only look away
  std::int64_t substep = 0;     // of the window under way
  double callback_seconds = 0;  // of the window under way
  std::string trouble;          // found in a callback, thrown when LIGGGHTS has returned

  explicit Impl(SharedMemory& shared_memory) : memory(shared_memory), shared(shared_memory.state()) {
    const char* arguments[] = {"liggghts", "-log", "none", "-nocite", "-screen", "none"};
    std::vector<char*> pointers;
    for (const char* text : arguments)
      pointers.push_back(const_cast<char*>(text));  // LIGGGHTS only reads them
    lammps = new LAMMPS_NS::LAMMPS(static_cast<int>(pointers.size()), pointers.data(), MPI_COMM_WORLD);
    lammps->screen = open_screen_ring(shared);
  }
  ~Impl() { delete lammps; }

  void command(const std::string& line) { lammps->input->one(line.c_str()); }

  /// LIGGGHTS reallocates and reorders its arrays: nothing of them may be kept between calls.
  [[nodiscard]] std::size_t index(int atom) const {
    return static_cast<std::size_t>(lammps->atom->tag[atom] - 1);
  }
  [[nodiscard]] int local_count() const { return lammps->atom->nlocal; }

  [[nodiscard]] Components components(std::size_t first) const {
    return {memory.array(first).data(), memory.array(first + 1).data(), memory.array(first + 2).data()};
  }
  void restore(double** field, SharedArrays::Name first) {
    const Components from = components(first);
    for (int a = 0; a < local_count(); ++a) store3(field[a], from[index(a)]);
  }
  /// Returns false when a value is not finite.
  bool publish(double** field, SharedArrays::Name first) {
    const Components to = components(first);
    const int* const tag = lammps->atom->tag;
    const int count = local_count();
    double poison = 0;
    for (int a = 0; a < count; ++a) {
      const int i = tag[a] - 1;
      const double x = field[a][0], y = field[a][1], z = field[a][2];
      to.x[i] = x;
      to.y[i] = y;
      to.z[i] = z;
      poison += (x - x) + (y - y) + (z - z);
    }
    return poison == 0;
  }

  void publish_state();
  void expel_what_left();
  void expel(int atom);
  void hold_expelled();
  void kick(bool in_run);
  void set_step(double step);
  void check_count();
  void start();
  static void callback(void* self, LAMMPS_NS::bigint, int count, int*, double**, double** external);

  template <class Visit>
  void for_each_contact(Visit&& visit);
  /// What a `fix property/global` of the commands holds; null where there is none.
  [[nodiscard]] LAMMPS_NS::FixPropertyGlobal* property(const char* name, const char* style, int rows,
                                                       int columns);
  [[nodiscard]] std::vector<double> property_of_types(const char* name);
  /// Of plastic springs; one law for all kinds of grains. Empty where they are not.
  [[nodiscard]] std::optional<Hysteresis> hysteresis();
  /// As of the kick under way, or between kicks, nearly, as of the last.
  [[nodiscard]] double stored_energy(bool in_kick);
  void note_stored_energy();
};

void LiggghtsEngine::Impl::publish_state() {
  const std::array<std::pair<double**, SharedArrays::Name>, 3> fields{
      {{lammps->atom->x, SharedArrays::position_x},
       {lammps->atom->v, SharedArrays::velocity_x},
       {lammps->atom->omega, SharedArrays::spin_x}}};
  const std::array<const char*, 3> names{"position", "velocity", "spin"};
  for (std::size_t f = 0; f < fields.size(); ++f) {
    if (publish(fields[f].first, fields[f].second) || !trouble.empty()) continue;
    for (std::size_t i = 0; i < memory.grains(); ++i)
      if (!components(fields[f].second)[i].allFinite()) {
        trouble = fmt::format("the {} of grain {} is not finite", names[f], i);
        break;
      }
  }
  expel_what_left();
}

/// Grains whose centre is outside the box. LIGGGHTS' own box is wider, so that none is lost to it before.
void LiggghtsEngine::Impl::expel_what_left() {
  const auto* const tag = lammps->atom->tag;
  const Components x = components(SharedArrays::position_x);
  const auto expelled = memory.array(SharedArrays::expelled);
  const auto &low = shared.box_low, &high = shared.box_high;
  for (int a = 0; a < local_count(); ++a) {
    const auto i = static_cast<std::size_t>(tag[a] - 1);
    const bool inside = x.x[i] >= low[0] && x.x[i] < high[0] && x.y[i] >= low[1] && x.y[i] < high[1] &&
                        x.z[i] >= low[2] && x.z[i] < high[2];
    if (!inside && expelled[i] == 0 && trouble.empty()) expel(a);
  }
}

/// Books what a grain takes along. Flying alone, its kinetic energy at the force evaluation that comes is
/// that of the last one and the work of its weight on the way.
void LiggghtsEngine::Impl::expel(int a) {
  auto* const atom = lammps->atom;
  const double mass = atom->rmass[a], radius = atom->radius[a];
  const Vec3 v = load3(atom->v[a]), momentum = mass * v;
  const GrainState grain{v,    load3(atom->omega[a]),       Vec3(0, 0, 0), Vec3(0, 0, 0),
                         mass, 0.4 * mass * radius * radius};
  GrainLoad load{Vec3(0, 0, 0), Vec3(0, 0, 0), load3(shared.gravity.data()), 0, shared.step};
  memory.array(SharedArrays::expelled)[index(a)] = 1;
  ++shared.expelled;
  shared.expelled_mass += mass;
  for (std::size_t c = 0; c < 3; ++c) shared.expelled_momentum[c] += momentum[static_cast<Eigen::Index>(c)];
  shared.expelled_pending += kick_grain(grain, load).kinetic;
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
}

/// Adds the window's load to the forces. In a run LIGGGHTS makes the closing half kick afterwards, under all
/// forces. Between runs it has made it already, under the pair forces: then the rest of it is made here.
void LiggghtsEngine::Impl::kick(bool in_run) {
  auto* const atom = lammps->atom;
  double** const v = atom->v;
  double** const omega = atom->omega;
  double** const f = atom->f;
  double** const torque = atom->torque;
  const Components linear = components(SharedArrays::linear_x), angular = components(SharedArrays::angular_x);
  const double per_second =
      1.0 / (static_cast<double>(shared.substeps) * shared.step);  // even over the substeps
  const double half = 0.5 * shared.step;
  GrainLoad load;
  load.gravity = load3(shared.gravity.data());
  load.damping = shared.damping;
  load.step = shared.step;
  Vec3 received(0, 0, 0), scale(0, 0, 0);
  double kinetic = 0, pair_work = 0, contact_work = 0, damping_work = 0;
  const auto expelled = memory.array(SharedArrays::expelled);
  if (shared.expelled > 0) hold_expelled();
  shared.expelled_energy += std::exchange(shared.expelled_pending, 0);
  for (int a = 0; a < atom->nlocal; ++a) {
    const std::size_t i = index(a);
    if (expelled[i] != 0) continue;
    const double mass = atom->rmass[a], radius = atom->radius[a];
    GrainState grain{
        load3(v[a]), load3(omega[a]), load3(f[a]), load3(torque[a]), mass, 0.4 * mass * radius * radius};
    if (in_run) {
      grain.velocity += half / mass * grain.pair_force;
      grain.spin += half / grain.inertia * grain.pair_torque;
    }
    load.contact_force = per_second * linear[i];
    load.contact_torque = per_second * angular[i];
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
    shared.impulse_received[c] += received[static_cast<Eigen::Index>(c)];
    shared.impulse_scale[c] += scale[static_cast<Eigen::Index>(c)];
  }
  if (shared.energy_wanted != 0 && (in_run ? substep : 0) == shared.substeps - 1) note_stored_energy();
  shared.kinetic = kinetic;
  shared.pair_work += shared.last_pair_work = pair_work;
  shared.contact_work += shared.last_contact_work = contact_work;
  shared.damping_work += shared.last_damping_work = damping_work;
}

/// x(t), v(t - dt/2), own forces at t: before the last substep's closing half kick they are published, before
/// the others' the window's load is added.
void LiggghtsEngine::Impl::callback(void* self, LAMMPS_NS::bigint, int count, int*, double**,
                                    double** external) {
  auto& engine = *static_cast<Impl*>(self);
  for (int a = 0; a < count; ++a) std::fill_n(external[a], 3, 0.0);
  if (!engine.stepping) return;
  const auto start = Clock::now();
  if (++engine.substep < engine.shared.substeps)
    engine.kick(true);
  else
    engine.publish_state();
  engine.callback_seconds += seconds_since(start);
}

/// The half kick that the pair forces have made already must be half of the new step.
void LiggghtsEngine::Impl::set_step(double step) {
  auto* const update = lammps->update;
  if (step == update->dt) return;
  if (started) {
    auto* const atom = lammps->atom;
    const double change = 0.5 * (step - update->dt);
    for (int a = 0; a < atom->nlocal; ++a) {
      const double mass = atom->rmass[a], inertia = 0.4 * mass * atom->radius[a] * atom->radius[a];
      store3(atom->v[a], load3(atom->v[a]) + change / mass * load3(atom->f[a]));
      store3(atom->omega[a], load3(atom->omega[a]) + change / inertia * load3(atom->torque[a]));
    }
  }
  update->update_time();
  update->dt = step;
  update->integrate->reset_dt();
  lammps->force->pair->reset_dt();
  for (int i = 0; i < lammps->modify->nfix; ++i) lammps->modify->fix[i]->reset_dt();
}

void LiggghtsEngine::Impl::check_count() {
  if (static_cast<std::size_t>(local_count()) == memory.grains()) return;
  std::vector<char> present(memory.grains(), 0);
  for (int a = 0; a < local_count(); ++a) present[index(a)] = 1;
  const auto lost = static_cast<std::size_t>(std::find(present.begin(), present.end(), 0) - present.begin());
  if (lost == memory.grains())
    throw std::runtime_error(fmt::format("{} grains became {}", memory.grains(), local_count()));
  const Vec3 x = components(SharedArrays::position_x)[lost];
  throw std::runtime_error(fmt::format(
      "{} of {} grains left the box; grain {} was last seen at ({:.6g}, {:.6g}, {:.6g}) m",
      memory.grains() - static_cast<std::size_t>(local_count()), memory.grains(), lost, x.x(), x.y(), x.z()));
}

/// First pair forces, from positions and velocities alone, and the half kick they make.
void LiggghtsEngine::Impl::start() {
  restore(lammps->atom->v, SharedArrays::velocity_x);
  restore(lammps->atom->omega, SharedArrays::spin_x);
  command("run 0 post no");
  check_count();
  lammps->modify->final_integrate();
  started = true;
}

template <class Visit>
void LiggghtsEngine::Impl::for_each_contact(Visit&& visit) {
  auto* pair = dynamic_cast<LAMMPS_NS::PairGran*>(lammps->force->pair);
  if (pair == nullptr || pair->list == nullptr)
    throw std::runtime_error("LIGGGHTS has no granular neighbour list");
  auto* atom = lammps->atom;
  for (int k = 0; k < pair->list->inum; ++k) {
    const int a = pair->list->ilist[k];
    for (int n = 0; n < pair->list->numneigh[a]; ++n) {
      const int b = pair->list->firstneigh[a][n] & NEIGHMASK;
      const double* history =
          pair->listgranhistory->firstdouble[a] + static_cast<std::ptrdiff_t>(pair->dnum()) * n;
      visit(a, b, load3(atom->x[a]) - load3(atom->x[b]), history);
    }
  }
}

LAMMPS_NS::FixPropertyGlobal* LiggghtsEngine::Impl::property(const char* name, const char* style, int rows,
                                                             int columns) {
  return dynamic_cast<LAMMPS_NS::FixPropertyGlobal*>(lammps->modify->find_fix_property(
      name, "property/global", style, rows, columns, "liggghts_host", false));
}

std::vector<double> LiggghtsEngine::Impl::property_of_types(const char* name) {
  const int types = lammps->atom->ntypes;
  auto* fix = property(name, "peratomtype", types, 0);
  if (fix == nullptr) throw std::runtime_error(fmt::format("the commands define no property {}", name));
  std::vector<double> values;
  for (int t = 0; t < types; ++t) values.push_back(fix->compute_vector(t));
  return values;
}

std::optional<Hysteresis> LiggghtsEngine::Impl::hysteresis() {
  const int types = lammps->atom->ntypes;
  const auto of_first = [&](const char* name) {
    auto* const fix = property(name, "peratomtypepair", types, types);
    return fix == nullptr ? 0.0 : fix->compute_array(0, 0);
  };
  if (property("coefficientMaxElasticStiffness", "peratomtypepair", types, types) == nullptr)
    return std::nullopt;
  return Hysteresis{of_first("coefficientMaxElasticStiffness"), of_first("coefficientPlasticityDepth"),
                    of_first("coefficientAdhesionStiffness")};
}

/// Elastic energy of all contacts where the last kick was made, less what cohesion has given. Between kicks
/// positions are moved back by one step, but springs' elongations stay those of the present positions, which
/// is off by their force times the slip of a step. Which models there are is asked of LIGGGHTS: a
/// characteristic velocity is Hooke's, a ratio of stiffnesses that of plastic springs, a second vector of
/// history the rolling spring's.
double LiggghtsEngine::Impl::stored_energy(bool in_kick) {
  const auto* atom = lammps->atom;
  const auto young = property_of_types("youngsModulus"), poisson = property_of_types("poissonsRatio");
  auto* const velocity_of_hooke = property("characteristicVelocity", "scalar", 0, 0);
  auto* const cohesion = property("cohesionEnergyDensity", "peratomtypepair", atom->ntypes, atom->ntypes);
  const std::optional<Hysteresis> plastic = hysteresis();
  const int values = static_cast<LAMMPS_NS::PairGran*>(lammps->force->pair)->dnum(),
            tangential_spring = first_vector(values);
  const bool rolling_spring = values >= 6;
  const double back = started && !in_kick ? shared.step : 0;
  const Components velocity = components(SharedArrays::velocity_x);
  double energy = 0;
  for_each_contact([&](int a, int b, const Vec3& distance, const double* history) {
    const Vec3 relative = velocity[index(a)] - velocity[index(b)];
    const double sum = atom->radius[a] + atom->radius[b];
    const double distance_before = (distance - back * relative).norm(), before = sum - distance_before;
    const double now = sum - distance.norm();
    if (before <= 0 && now <= 0) return;
    const double radius = atom->radius[a] * atom->radius[b] / sum;
    const int s = atom->type[a] - 1, t = atom->type[b] - 1;
    const double modulus = effective_young_modulus(young[s], poisson[s], young[t], poisson[t]);
    double tangential = 0;
    if (velocity_of_hooke != nullptr) {
      const double mass = atom->rmass[a] * atom->rmass[b] / (atom->rmass[a] + atom->rmass[b]);
      tangential = hooke_stiffness(modulus, radius, mass, velocity_of_hooke->compute_scalar());
      if (before > 0)
        energy += plastic ? hysteretic_energy(*plastic, tangential, radius, before, history[0])
                          : 0.5 * tangential * before * before;
    } else {
      if (before > 0) energy += normal_energy(modulus, radius, before);
      if (now > 0)
        tangential = tangential_stiffness(effective_shear_modulus(young[s], poisson[s], young[t], poisson[t]),
                                          radius, now);
    }
    if (cohesion != nullptr)
      energy -=
          cohesion->compute_array(s, t) * overlap_volume(atom->radius[a], atom->radius[b], distance_before);
    if (now <= 0) return;
    const double* const spring = history + tangential_spring;
    energy += 0.5 * tangential * load3(spring).squaredNorm();
    if (rolling_spring) energy += 0.5 * load3(spring + 3).squaredNorm() / (tangential * radius * radius);
  });
  return energy;
}

/// In a kick, which may be within LIGGGHTS: no exception may pass through it.
void LiggghtsEngine::Impl::note_stored_energy() {
  try {
    shared.stored_energy = stored_energy(true);
  } catch (const std::exception& error) {
    trouble = error.what();
  }
}

LiggghtsEngine::LiggghtsEngine(SharedMemory& memory) : impl_(std::make_unique<Impl>(memory)) {}
LiggghtsEngine::~LiggghtsEngine() = default;

void LiggghtsEngine::set_up(const std::string& commands) {
  Impl& my = *impl_;
  std::istringstream stream(commands);
  for (std::string line; std::getline(stream, line);) my.command(line);
  my.command(contact_forces_command);
  auto* coupling = dynamic_cast<LAMMPS_NS::FixExternal*>(my.lammps->modify->find_fix_id("coupling"));
  if (coupling == nullptr) throw std::runtime_error("the commands define no `fix coupling all external`");
  coupling->set_callback(&Impl::callback, &my);
  my.command("run 0 post no");
  my.check_count();
  const auto mass = my.memory.array(SharedArrays::mass), radius = my.memory.array(SharedArrays::radius);
  for (int a = 0; a < my.local_count(); ++a) {
    mass[my.index(a)] = my.lammps->atom->rmass[a];
    radius[my.index(a)] = my.lammps->atom->radius[a];
  }
}

void LiggghtsEngine::resume() {
  Impl& my = *impl_;
  my.set_step(my.shared.step);
  my.restore(my.lammps->atom->f, SharedArrays::linear_x);
  my.restore(my.lammps->atom->torque, SharedArrays::angular_x);
  my.started = true;
}

void LiggghtsEngine::advance() {
  Impl& my = *impl_;
  const auto begin = Clock::now();
  my.set_step(my.shared.step);
  if (!my.started) my.start();
  const auto kicking = Clock::now();
  my.shared.impulse_received = {};
  my.shared.impulse_scale = {};
  my.kick(false);
  const double kick_seconds = seconds_since(kicking);

  my.stepping = true;
  my.substep = 0;
  my.callback_seconds = 0;
  my.command(fmt::format("run {} pre no post no", my.shared.substeps));
  my.stepping = false;
  my.shared.copy_seconds = kick_seconds + my.callback_seconds;
  my.shared.run_seconds = seconds_since(begin) - my.shared.copy_seconds;
  if (!my.trouble.empty()) throw std::runtime_error(my.trouble);
  my.check_count();
}

void LiggghtsEngine::compute_stored_energy() {
  impl_->shared.stored_energy = impl_->stored_energy(false);
}

void LiggghtsEngine::compute_contacts() {
  Impl& my = *impl_;
  auto* atom = my.lammps->atom;
  const auto coordination = my.memory.array(SharedArrays::coordination);
  std::fill(coordination.begin(), coordination.end(), 0.0);
  std::vector<double> overlaps;
  my.for_each_contact([&](int a, int b, const Vec3& distance, const double*) {
    const double overlap = atom->radius[a] + atom->radius[b] - distance.norm();
    if (overlap <= 0) return;
    overlaps.push_back(overlap / std::min(atom->radius[a], atom->radius[b]));
    coordination[my.index(a)] += 1;
    coordination[my.index(b)] += 1;
  });
  std::sort(overlaps.begin(), overlaps.end());
  double sum = 0;
  for (double overlap : overlaps) sum += overlap;
  const std::size_t count = overlaps.size();
  my.shared.contacts = count;
  my.shared.overlap_mean = count == 0 ? 0 : sum / static_cast<double>(count);
  my.shared.overlap_percentile_99 = count == 0 ? 0 : overlaps[(count - 1) * 99 / 100];
  my.shared.overlap_largest = count == 0 ? 0 : overlaps.back();
}

std::string LiggghtsEngine::list_contacts() {
  return dem::list_contacts(*impl_->lammps, impl_->memory, impl_->started);
}

/// Writing a restart file alone would let this run and one resumed from the file part in the order of their
/// sums; the set-up after it (`run 0`) brings both to the same order. It evaluates the forces anew without
/// advancing the springs, which is a slightly different force: so the old ones are put back, here and after
/// reading.
void LiggghtsEngine::save(const std::string& restart_file) {
  Impl& my = *impl_;
  my.publish(my.lammps->atom->f, SharedArrays::linear_x);
  my.publish(my.lammps->atom->torque, SharedArrays::angular_x);
  my.command("write_restart " + restart_file);
  my.command("run 0 post no");
  my.check_count();
  my.restore(my.lammps->atom->f, SharedArrays::linear_x);
  my.restore(my.lammps->atom->torque, SharedArrays::angular_x);
}

}  // namespace tuft::dem

#include "dem_bridge/dem_infill.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/lane_math.h"
#include "dem_bridge/dem_contacts.h"
#include "dem_bridge/dem_infill_impl.h"
#include "dem_bridge/grain_contact.h"
#include "dem_bridge/hertz.h"

namespace tuft::dem {

using Clock = std::chrono::steady_clock;

DemInfill::Impl::Impl(const Grains& given, const std::vector<Material>& given_materials,
                      const DemSettings& given_settings)
    : grains(given),
      materials(given_materials),
      settings(given_settings),
      bodies(find_bodies(given, given_materials)),
      used(used_materials(given)) {
  const auto [smallest, largest] = std::minmax_element(grains.radius.begin(), grains.radius.end());
  sizes = {grains.size(), *smallest, *largest};
  stable_step = rayleigh_time = std::numeric_limits<double>::infinity();
  const auto take_step = [&](std::size_t i, double density, double mass_ratio) {
    const GrainMaterial& grain = *materials[static_cast<std::size_t>(grains.material[i])].grain;
    rayleigh_time = std::min(rayleigh_time, stable_grain_step(grains.radius[i], density, grain.young_modulus,
                                                              grain.poisson_ratio) /
                                                stable_rayleigh_share);
    stable_step = std::min(stable_step, stable_step_of_grain(grains.radius[i], density, grains.material[i],
                                                             used, materials, settings.options, mass_ratio));
  };
  for (std::size_t i = 0; i < grains.size(); ++i)
    if (grains.body.empty() || grains.body[i] < 0) take_step(i, grains.density[i], 1);
  for (const GrainBody& body : bodies.bodies)
    for (std::size_t k = 0; k < body.count; ++k) {
      const auto [density, ratio] = sphere_of_clump(bodies.shape_of(body), k, grains.density[body.first]);
      take_step(body.first + k, density, ratio);
    }
  overlap_largest.assign(used.size() * (used.size() + 1) / 2, 0);
}

void DemInfill::Impl::new_host() {
  host.reset();
  host = std::make_unique<HostLink>(settings.options, grains.size());
  for (std::size_t c = 0; c < 3; ++c) {
    const auto axis = static_cast<Eigen::Index>(c);
    shared().gravity[c] = settings.gravity[axis];
    shared().box_low[c] = settings.box[0][axis];
    shared().box_high[c] = settings.box[1][axis];
  }
}

void DemInfill::Impl::set_up(const std::string& source_command) {
  ask(Request::commands, set_up_commands(source_command, used, materials, settings, sizes, stable_step,
                                         clumped_materials(grains, used)));
  check_count();
}

void DemInfill::Impl::start_fresh() {
  new_host();
  const std::array<const std::vector<double>*, 3> position{&grains.position.x, &grains.position.y,
                                                           &grains.position.z};
  for (std::size_t c = 0; c < 3; ++c)
    std::copy(position[c]->begin(), position[c]->end(), array(SharedArrays::position_x + c).begin());
  host->write_file("grains.data", data_file(grains, used, host_domain(settings)));
  if (!bodies.empty()) host->write_file(bodies_file_name, bodies_file(bodies, grains));
  set_up("read_data grains.data");
  ask_stored();
  initial_stored = sums.stored;
}

/// Writes what touches grains into the shared memory and refuses what is not finite: LIGGGHTS would carry it
/// on in silence. Few grains are touched, and what one process writes and another reads costs the most.
void DemInfill::Impl::write_loads(const ContactImpulses& contact) {
  const std::size_t count = grains.size();
  const std::array<const std::vector<double>*, 6> components{&contact.linear.x,  &contact.linear.y,
                                                             &contact.linear.z,  &contact.angular.x,
                                                             &contact.angular.y, &contact.angular.z};
  for (const std::vector<double>* component : components)
    if (component->size() != count)
      throw_run_error("DEM infill at t = {:.9g} s: {} contact impulses for {} grains", time,
                      component->size(), count);
  std::array<const double*, 6> of;
  for (std::size_t c = 0; c < of.size(); ++c) of[c] = components[c]->data();
  LoadRecord* record = memory().load_room().data();
  const auto note = [&](std::size_t i) {
    *record++ = {i, {of[0][i], of[1][i], of[2][i]}, {of[3][i], of[4][i], of[5][i]}};
  };
  Pack poison_lanes = 0;  // 0, or not a number for what is not finite
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    Pack size = 0;
    for (const double* component : of) size += abs(Pack(component + i, stdx::element_aligned));
    poison_lanes += size - size;
    for (unsigned touched = lanes_below(-size, 0); touched != 0; touched &= touched - 1)
      note(i + static_cast<std::size_t>(std::countr_zero(touched)));
  }
  double poison = sum_lanes(poison_lanes);
  for (; i < count; ++i) {
    double size = 0;
    for (const double* component : of) size += std::abs(component[i]);
    poison += size - size;
    if (size > 0) note(i);
  }
  shared().loads = static_cast<std::uint64_t>(record - memory().load_room().data());
  if (poison == 0) return;
  for (std::size_t c = 0; c < components.size(); ++c)
    for (std::size_t k = 0; k < count; ++k)
      if (!std::isfinite(of[c][k]))
        throw_run_error("DEM infill at t = {:.9g} s: the {} contact impulse of grain {} is {}", time,
                        c < 3 ? "linear" : "angular", k, of[c][k]);
}

/// A grain that moves on by more than its radius in a step can pass through what it should meet, unseen by
/// LIGGGHTS. The host has counted them.
void DemInfill::Impl::check_speeds(double step) {
  std::uint64_t fast = 0;
  for (std::size_t r = 0; r < memory().ranks(); ++r) fast += memory().rank(r).fast;
  if (fast == 0) return;
  const auto vx = array(SharedArrays::velocity_x), vy = array(SharedArrays::velocity_y),
             vz = array(SharedArrays::velocity_z);
  const double* const radius = grains.radius.data();
  const auto too_fast = [&](std::size_t i) {
    const double square = vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i], most = radius[i] / step;
    return square > most * most;
  };
  for (std::size_t i = 0; i < grains.size(); ++i) {
    if (!too_fast(i)) continue;
    const double speed = std::sqrt(vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i]);
    if (!expelled_mask.empty() && expelled_mask[i] != 0) continue;
    throw_run_error(
        "DEM infill at t = {:.9g} s: grain {} of {:.3g} mm radius is {:.3g} m/s fast and moves {:.3g} mm in "
        "a step of "
        "{:.3g} us, past what it should touch; lower numerics.step_safety, or see what shot it out",
        time, i, 1e3 * grains.radius[i], speed, 1e3 * step * speed, 1e6 * step);
  }
}

const GrainBody* DemInfill::Impl::body_of(std::size_t grain) const {
  // Bodies are in the order of their spheres.
  const auto after = std::upper_bound(bodies.bodies.begin(), bodies.bodies.end(), grain,
                                      [](std::size_t g, const GrainBody& body) { return g < body.first; });
  if (after == bodies.bodies.begin()) return nullptr;
  const GrainBody& body = *(after - 1);
  return grain < body.first + body.count ? &body : nullptr;
}

void DemInfill::Impl::take_report(AdvanceReport& report) {
  HostSums& s = sums;
  s.last_pair_work = s.last_contact_work = s.last_damping_work = 0;
  double kinetic = 0, pair_work = 0, contact_work = 0, damping_work = 0, run_seconds = 0;
  const std::uint64_t gone = expelled.grains;
  for (std::size_t r = 0; r < memory().ranks(); ++r) {
    const RankState& rank = memory().rank(r);
    report.impulse_received += Vec3(rank.impulse_received.data());
    report.impulse_scale += Vec3(rank.impulse_scale.data());
    pair_work += rank.pair_work;
    contact_work += rank.contact_work;
    damping_work += rank.damping_work;
    s.last_pair_work += rank.last_pair_work;
    s.last_contact_work += rank.last_contact_work;
    s.last_damping_work += rank.last_damping_work;
    kinetic += rank.kinetic;
    run_seconds = std::max(run_seconds, rank.run_seconds);
    expelled.grains += rank.expelled;
    expelled.mass += rank.expelled_mass;
    for (std::size_t c = 0; c < 3; ++c) expelled.momentum[c] += rank.expelled_momentum[c];
    expelled.pending += rank.expelled_energy;
  }
  if (shared().energy_wanted != EnergyWanted::none) s.kinetic = kinetic;
  s.pair_work += pair_work;
  s.contact_work += contact_work;
  s.damping_work += damping_work;
  waiting += run_seconds;
  exchanging -= run_seconds;
  if (expelled.grains == gone) return;
  shared().expelled = expelled.grains;
  read_expelled();
}

void DemInfill::Impl::check_count() {
  std::uint64_t present = 0;
  for (std::size_t r = 0; r < memory().ranks(); ++r) present += memory().rank(r).grains;
  if (present == grains.size()) return;
  const auto marks = array(SharedArrays::coordination);
  std::fill(marks.begin(), marks.end(), 0.0);
  ask(Request::census);
  const auto lost = static_cast<std::size_t>(std::find(marks.begin(), marks.end(), 0.0) - marks.begin());
  if (lost == grains.size())
    throw_run_error("DEM infill at t = {:.9g} s: {} grains became {}", time, grains.size(), present);
  throw_run_error(
      "DEM infill at t = {:.9g} s: {} of {} grains left the box; grain {} was last seen at ({:.6g}, {:.6g}, "
      "{:.6g}) m",
      time, grains.size() - present, grains.size(), lost, array(SharedArrays::position_x)[lost],
      array(SharedArrays::position_y)[lost], array(SharedArrays::position_z)[lost]);
}

DemInfill::DemInfill(const Grains& grains, const std::vector<Material>& materials,
                     const DemSettings& settings) {
  check_grains(grains, materials, settings);
  impl_ = std::make_unique<Impl>(grains, materials, settings);
  impl_->start_fresh();
}

DemInfill::~DemInfill() = default;

ParticleView DemInfill::particles() const {
  Impl& my = *impl_;
  const auto view = [&](SharedArrays::Name name) { return std::span<const double>(my.array(name)); };
  ParticleView particles;
  particles.x = view(SharedArrays::position_x);
  particles.y = view(SharedArrays::position_y);
  particles.z = view(SharedArrays::position_z);
  particles.vx = view(SharedArrays::velocity_x);
  particles.vy = view(SharedArrays::velocity_y);
  particles.vz = view(SharedArrays::velocity_z);
  particles.wx = view(SharedArrays::spin_x);
  particles.wy = view(SharedArrays::spin_y);
  particles.wz = view(SharedArrays::spin_z);
  particles.radius = my.grains.radius;
  particles.mass = view(SharedArrays::mass);
  particles.layer = my.grains.layer;
  particles.material = my.grains.material;
  particles.expelled = my.expelled_mask;
  return particles;
}

double DemInfill::stable_step() const {
  return impl_->stable_step;
}

void DemInfill::begin_window(double, int, bool energy_wanted) {
  impl_->energy_wanted = energy_wanted ? EnergyWanted::all : EnergyWanted::none;
}

AdvanceReport DemInfill::advance(double window, int substeps, const ContactImpulses& contact) {
  Impl& my = *impl_;
  if (!(window > 0) || !std::isfinite(window) || substeps < 1)
    throw_run_error("DEM infill at t = {:.9g} s: a window of {} s in {} substeps cannot be made", my.time,
                    window, substeps);
  const auto begin = Clock::now();
  my.write_loads(contact);
  SharedState& shared = my.shared();
  shared.step = window / substeps;
  shared.substeps = substeps;
  shared.damping = my.damping;
  shared.energy_wanted = my.energy_wanted;
  my.ask(Request::advance);
  my.check_count();
  my.expelled.energy += std::exchange(my.expelled.pending, 0);
  AdvanceReport report;
  report.substeps = substeps;
  my.take_report(report);
  my.started = true;
  my.stored_is_current = std::exchange(my.energy_wanted, EnergyWanted::kinetic) == EnergyWanted::all;
  my.time += window;
  if (my.stored_is_current) {
    my.sum_stored();
    my.take_overlaps();
  }
  my.largest_step = std::max(my.largest_step, shared.step);
  my.steps += static_cast<std::uint64_t>(substeps);
  my.check_speeds(shared.step);
  my.exchanging += std::chrono::duration<double>(Clock::now() - begin).count();
  return report;
}

double DemInfill::rayleigh_share() const {
  return impl_->largest_step / impl_->rayleigh_time;
}

void DemInfill::set_damping(double rate) {
  if (!(rate >= 0) || !std::isfinite(rate))
    throw_run_error("DEM infill: damping of {} 1/s; it must be 0 or more", rate);
  impl_->damping = rate;
}

std::uint64_t DemInfill::particle_steps() const {
  return impl_->steps * impl_->grains.size();
}

ContactNetwork DemInfill::contacts() const {
  return read_contacts(impl_->ask(Request::network), particles());
}

void DemInfill::set_velocity(std::size_t i, const Vec3& linear, const Vec3& spin) {
  Impl& my = *impl_;
  if (my.started) throw std::logic_error("DemInfill::set_velocity after the first advance");
  if (i >= my.grains.size()) throw std::out_of_range("DemInfill::set_velocity: no such grain");
  const auto set = [&](std::size_t k, const Vec3& velocity) {
    for (std::size_t c = 0; c < 3; ++c) {
      my.array(SharedArrays::velocity_x + c)[k] = velocity[static_cast<Eigen::Index>(c)];
      my.array(SharedArrays::spin_x + c)[k] = spin[static_cast<Eigen::Index>(c)];
    }
  };
  const GrainBody* const body = my.body_of(i);
  if (body == nullptr) return set(i, linear);
  const Vec3 here = particles().position(i);
  for (std::size_t k = body->first; k < body->first + body->count; ++k)
    set(k, linear + spin.cross(particles().position(k) - here));
}

std::span<const Index> DemInfill::clumps() const {
  return impl_->grains.body;
}
double DemInfill::solid_volume(std::size_t i) const {
  const Grains& grains = impl_->grains;
  if (!grains.body.empty() && grains.body[i] >= 0) return particles().mass[i] / grains.density[i];
  const double r = grains.radius[i];
  return 4.0 / 3 * std::numbers::pi * r * r * r;
}
double DemInfill::waiting_seconds() const {
  return impl_->waiting;
}
double DemInfill::exchange_seconds() const {
  return impl_->exchanging;
}
int DemInfill::host_process() const {
  return impl_->host->process_id();
}

}  // namespace tuft::dem

#include "dem_bridge/dem_infill.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "dem_bridge/dem_contacts.h"
#include "dem_bridge/grain_contact.h"
#include "dem_bridge/host_link.h"
#include "dem_bridge/liggghts_script.h"

namespace tuft::dem {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<std::uint8_t> read_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream || bytes.empty()) throw_run_error("liggghts_host left no restart file {}", file.string());
  return bytes;
}

void write_bytes(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw_run_error("{} cannot be written; free space in the temporary folder", file.string());
}

}  // namespace

struct DemInfill::Impl {
  Grains grains;
  std::vector<Material> materials;
  DemSettings settings;
  std::vector<Index> used;
  double stable_step = 0;
  GrainSizes sizes;

  std::unique_ptr<HostLink> host;
  bool started = false;
  bool energy_wanted = false;      // of the coming window
  bool stored_is_current = false;  // the host has stored energy at the last kick
  double time = 0;                 // s, end of the last window
  double damping = 0;              // 1/s
  double initial_stored = 0;
  double missing =
      0;  // J, energy that left the motion of the grains and is not stored, at the last `energy()`
  double dissipated = 0;    // J, sum of all increases of `missing`
  std::uint64_t steps = 0;  // substeps so far
  double waiting = 0, exchanging = 0;
  std::vector<std::uint8_t> expelled_mask;  // as ParticleView has it

  Impl(const Grains& given, const std::vector<Material>& given_materials, const DemSettings& given_settings)
      : grains(given), materials(given_materials), settings(given_settings), used(used_materials(given)) {
    const auto [smallest, largest] = std::minmax_element(grains.radius.begin(), grains.radius.end());
    sizes = {grains.size(), *smallest, *largest};
    stable_step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < grains.size(); ++i)
      stable_step =
          std::min(stable_step, stable_step_of_grain(grains.radius[i], grains.density[i], grains.material[i],
                                                     used, materials, settings.options));
  }

  [[nodiscard]] SharedState& shared() { return host->memory().state(); }
  [[nodiscard]] std::span<double> array(std::size_t name) { return host->memory().array(name); }
  std::string ask(Request request, std::string_view text = {}) {
    return host->ask(request, text, fmt::format("DEM infill at t = {:.9g} s", time));
  }

  /// A host of its own for each life: LIGGGHTS cannot be emptied and filled again safely.
  void start_host(const std::string& source_command, const std::filesystem::path& source_name) {
    const std::string source = source_command + " " + (host->folder() / source_name).string();
    ask(Request::commands, set_up_commands(source, used, materials, settings, sizes, stable_step));
  }
  void tell_surroundings() {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto axis = static_cast<Eigen::Index>(c);
      shared().gravity[c] = settings.gravity[axis];
      shared().box_low[c] = settings.box[0][axis];
      shared().box_high[c] = settings.box[1][axis];
    }
  }
  void start_fresh() {
    host = std::make_unique<HostLink>(settings.options.host, grains.size(), settings.options.answer_timeout);
    const std::array<const std::vector<double>*, 3> position{&grains.position.x, &grains.position.y,
                                                             &grains.position.z};
    for (std::size_t c = 0; c < 3; ++c)
      std::copy(position[c]->begin(), position[c]->end(), array(SharedArrays::position_x + c).begin());
    tell_surroundings();
    write_data_file(host->folder() / "grains.data", grains, used, host_domain(settings));
    start_host("read_data", "grains.data");
    ask(Request::energy);
    initial_stored = shared().stored_energy;
  }

  void write_vectors(h5::Group& group, const char* name, std::size_t first) {
    std::vector<double> values;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto component = array(first + c);
      values.insert(values.end(), component.begin(), component.end());
    }
    group.write(name, values, {3, grains.size()});
  }
  void read_vectors(const h5::Group& group, const char* name, std::size_t first) {
    const std::vector<double> values = group.read_doubles(name);
    if (values.size() != 3 * grains.size())
      throw_input_error("checkpoint: {} holds {} values for {} grains: it is of another scene, or damaged",
                        name, values.size(), grains.size());
    for (std::size_t c = 0; c < 3; ++c)
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(c * grains.size()), grains.size(),
                  array(first + c).begin());
  }

  void send_impulses(const ContactImpulses& contact);
  void check_speeds(double step);
  void read_expelled();
  [[nodiscard]] double kinetic_of_view();
  [[nodiscard]] double gravity_potential();
};

/// Copies the impulses into the shared memory and refuses what is not finite: LIGGGHTS would carry it on in
/// silence.
void DemInfill::Impl::send_impulses(const ContactImpulses& contact) {
  const std::size_t count = grains.size();
  const std::array<const std::vector<double>*, 6> components{&contact.linear.x,  &contact.linear.y,
                                                             &contact.linear.z,  &contact.angular.x,
                                                             &contact.angular.y, &contact.angular.z};
  for (std::size_t c = 0; c < components.size(); ++c) {
    const std::vector<double>& from = *components[c];
    if (from.size() != count)
      throw_run_error("DEM infill at t = {:.9g} s: {} contact impulses for {} grains", time, from.size(),
                      count);
    const auto to = array(SharedArrays::linear_x + c);
    double poison = 0;
    for (std::size_t i = 0; i < count; ++i) {
      to[i] = from[i];
      poison += from[i] - from[i];
    }
    if (poison == 0) continue;
    for (std::size_t i = 0; i < count; ++i)
      if (!std::isfinite(from[i]))
        throw_run_error("DEM infill at t = {:.9g} s: the {} contact impulse of grain {} is {}", time,
                        c < 3 ? "linear" : "angular", i, from[i]);
  }
}

/// A grain that moves on by more than its radius in a step can pass through what it should meet, unseen by
/// LIGGGHTS.
void DemInfill::Impl::check_speeds(double step) {
  const auto vx = array(SharedArrays::velocity_x), vy = array(SharedArrays::velocity_y),
             vz = array(SharedArrays::velocity_z);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const double square = vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i], most = grains.radius[i] / step;
    if (square <= most * most) continue;
    if (!expelled_mask.empty() && expelled_mask[i] != 0) continue;
    throw_run_error(
        "DEM infill at t = {:.9g} s: grain {} of {:.3g} mm radius is {:.3g} m/s fast and moves {:.3g} mm in "
        "a step of "
        "{:.3g} us, past what it should touch; lower numerics.step_safety, or see what shot it out",
        time, i, 1e3 * grains.radius[i], std::sqrt(square), 1e3 * step * std::sqrt(square), 1e6 * step);
  }
}

void DemInfill::Impl::read_expelled() {
  if (shared().expelled == 0) return;
  const auto flags = array(SharedArrays::expelled);
  expelled_mask.assign(flags.begin(), flags.end());
}

double DemInfill::Impl::kinetic_of_view() {
  double sum = 0;
  const auto mass = array(SharedArrays::mass);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    double speed = 0, spin = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      speed += array(SharedArrays::velocity_x + c)[i] * array(SharedArrays::velocity_x + c)[i];
      spin += array(SharedArrays::spin_x + c)[i] * array(SharedArrays::spin_x + c)[i];
    }
    sum += 0.5 * mass[i] * (speed + 0.4 * grains.radius[i] * grains.radius[i] * spin);
  }
  return sum;
}

/// At the last kick: positions one step back along the velocity they have moved with since.
double DemInfill::Impl::gravity_potential() {
  const double back = started ? shared().step : 0;
  const auto mass = array(SharedArrays::mass);
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto x = array(SharedArrays::position_x + c), v = array(SharedArrays::velocity_x + c);
    const double g = settings.gravity[static_cast<Eigen::Index>(c)];
    for (std::size_t i = 0; i < grains.size(); ++i) sum -= mass[i] * g * (x[i] - back * v[i]);
  }
  return sum;
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

Expelled DemInfill::expelled() const {
  const SharedState& shared = impl_->shared();
  return {shared.expelled, shared.expelled_mass, Vec3(shared.expelled_momentum.data()),
          shared.expelled_energy + shared.expelled_pending};
}

double DemInfill::stable_step() const {
  return impl_->stable_step;
}

void DemInfill::begin_window(double, int, bool energy_wanted) {
  impl_->energy_wanted = energy_wanted;
}

AdvanceReport DemInfill::advance(double window, int substeps, const ContactImpulses& contact) {
  Impl& my = *impl_;
  if (!(window > 0) || !std::isfinite(window) || substeps < 1)
    throw_run_error("DEM infill at t = {:.9g} s: a window of {} s in {} substeps cannot be made", my.time,
                    window, substeps);
  const auto begin = Clock::now();
  my.send_impulses(contact);
  SharedState& shared = my.shared();
  shared.step = window / substeps;
  shared.substeps = substeps;
  shared.damping = my.damping;
  const std::uint64_t gone = shared.expelled;
  shared.energy_wanted = my.energy_wanted ? 1 : 0;
  my.ask(Request::advance);
  if (shared.expelled != gone) my.read_expelled();
  my.started = true;
  my.stored_is_current = std::exchange(my.energy_wanted, false);
  my.time += window;
  my.steps += static_cast<std::uint64_t>(substeps);
  my.check_speeds(shared.step);
  my.waiting += shared.run_seconds;
  my.exchanging += std::chrono::duration<double>(Clock::now() - begin).count() - shared.run_seconds;
  AdvanceReport report;
  report.impulse_received = Vec3(shared.impulse_received.data());
  report.impulse_scale = Vec3(shared.impulse_scale.data());
  report.substeps = substeps;
  return report;
}

void DemInfill::set_damping(double rate) {
  if (!(rate >= 0) || !std::isfinite(rate))
    throw_run_error("DEM infill: damping of {} 1/s; it must be 0 or more", rate);
  impl_->damping = rate;
}

InfillEnergy DemInfill::energy() const {
  Impl& my = *impl_;
  if (!my.stored_is_current) my.ask(Request::energy);
  const SharedState& shared = my.shared();
  InfillEnergy energy;
  energy.stored = shared.stored_energy;
  energy.gravity_potential = my.gravity_potential();
  if (!my.started) {
    energy.kinetic = my.kinetic_of_view();
    return energy;
  }
  // The moment is the middle of the last kick, so half of its work has been done.
  const double pair_work = shared.pair_work - 0.5 * shared.last_pair_work;
  energy.kinetic = shared.kinetic;
  energy.expelled = shared.expelled_energy;
  energy.contact_work = shared.contact_work - 0.5 * shared.last_contact_work;
  energy.damping = -(shared.damping_work - 0.5 * shared.last_damping_work);
  const double missing = -pair_work - (energy.stored - my.initial_stored);
  my.dissipated += std::max(0.0, missing - my.missing);
  my.missing = missing;
  energy.dissipated = my.dissipated;
  return energy;
}

std::uint64_t DemInfill::particle_steps() const {
  return impl_->steps * impl_->grains.size();
}

void DemInfill::save(h5::Group& group) {
  Impl& my = *impl_;
  const std::filesystem::path file = my.host->folder() / "restart";
  my.ask(Request::save, file.string());
  const SharedState& shared = my.shared();
  group.write("radius", my.grains.radius);
  group.write("restart", read_bytes(file));
  std::filesystem::remove(file);
  my.write_vectors(group, "position", SharedArrays::position_x);
  my.write_vectors(group, "velocity", SharedArrays::velocity_x);
  my.write_vectors(group, "spin", SharedArrays::spin_x);
  my.write_vectors(group, "own_force", SharedArrays::linear_x);
  my.write_vectors(group, "own_torque", SharedArrays::angular_x);
  group.write("works",
              std::vector<double>{shared.pair_work, shared.contact_work, shared.damping_work,
                                  shared.last_pair_work, shared.last_contact_work, shared.last_damping_work,
                                  shared.kinetic, shared.stored_energy, my.stored_is_current ? 1.0 : 0.0});
  const auto expelled = my.array(SharedArrays::expelled);
  group.write("expelled", std::vector<double>(expelled.begin(), expelled.end()));
  const auto& momentum = shared.expelled_momentum;
  group.write("expelled_sums",
              std::vector<double>{static_cast<double>(shared.expelled), shared.expelled_mass, momentum[0],
                                  momentum[1], momentum[2], shared.expelled_energy, shared.expelled_pending});
  group.write_scalar("time", my.time);
  group.write_scalar("step", shared.step);
  group.write_scalar("steps", my.steps);
  group.write_scalar("damping", my.damping);
  group.write_scalar("initial_stored", my.initial_stored);
  group.write_scalar("missing", my.missing);
  group.write_scalar("dissipated", my.dissipated);
  group.write_scalar("started", static_cast<std::uint64_t>(my.started));
}

void DemInfill::load(const h5::Group& group) {
  Impl& my = *impl_;
  if (group.read_doubles("radius") != my.grains.radius)
    throw_input_error(
        "checkpoint: its grains are not those of this scene ({} grains); resume with the scene it was made "
        "of",
        my.grains.size());
  const std::vector<double> works = group.read_doubles("works");
  if (works.size() != 9)
    throw_input_error("checkpoint: {} works of the infill instead of 9: it is damaged", works.size());
  my.host = std::make_unique<HostLink>(my.settings.options.host, my.grains.size(),
                                       my.settings.options.answer_timeout);
  SharedState& shared = my.shared();
  my.tell_surroundings();
  my.time = group.read_double("time");
  my.steps = group.read_count("steps");
  my.damping = group.read_double("damping");
  my.initial_stored = group.read_double("initial_stored");
  my.missing = group.read_double("missing");
  my.dissipated = group.read_double("dissipated");
  my.started = group.read_count("started") != 0;
  write_bytes(my.host->folder() / "restart", group.read_bytes("restart"));
  my.start_host("read_restart", "restart");
  std::filesystem::remove(my.host->folder() / "restart");

  my.read_vectors(group, "position", SharedArrays::position_x);
  my.read_vectors(group, "velocity", SharedArrays::velocity_x);
  my.read_vectors(group, "spin", SharedArrays::spin_x);
  my.read_vectors(group, "own_force", SharedArrays::linear_x);
  my.read_vectors(group, "own_torque", SharedArrays::angular_x);
  shared.step = group.read_double("step");
  shared.pair_work = works[0];
  shared.contact_work = works[1];
  shared.damping_work = works[2];
  shared.last_pair_work = works[3];
  shared.last_contact_work = works[4];
  shared.last_damping_work = works[5];
  shared.kinetic = works[6];
  shared.stored_energy = works[7];
  my.stored_is_current = works[8] != 0;
  const std::vector<double> expelled = group.read_doubles("expelled"),
                            sums = group.read_doubles("expelled_sums");
  if (expelled.size() != my.grains.size() || sums.size() != 7)
    throw_input_error(
        "checkpoint: {} marks and {} sums of expelled grains instead of {} and 7: it is damaged",
        expelled.size(), sums.size(), my.grains.size());
  std::copy(expelled.begin(), expelled.end(), my.array(SharedArrays::expelled).begin());
  shared.expelled = static_cast<std::uint64_t>(sums[0]);
  shared.expelled_mass = sums[1];
  shared.expelled_momentum = {sums[2], sums[3], sums[4]};
  shared.expelled_energy = sums[5];
  shared.expelled_pending = sums[6];
  my.read_expelled();
  if (my.started) my.ask(Request::resume);
}

std::vector<Infill::Field> DemInfill::fields() const {
  Impl& my = *impl_;
  my.ask(Request::contacts);
  const auto coordination = my.array(SharedArrays::coordination);
  return {{"coordination", "1", std::vector<double>(coordination.begin(), coordination.end())}};
}

ContactNetwork DemInfill::contacts() const {
  return read_contacts(impl_->ask(Request::network), particles());
}

void DemInfill::set_velocity(std::size_t i, const Vec3& linear, const Vec3& spin) {
  Impl& my = *impl_;
  if (my.started) throw std::logic_error("DemInfill::set_velocity after the first advance");
  if (i >= my.grains.size()) throw std::out_of_range("DemInfill::set_velocity: no such grain");
  for (std::size_t c = 0; c < 3; ++c) {
    my.array(SharedArrays::velocity_x + c)[i] = linear[static_cast<Eigen::Index>(c)];
    my.array(SharedArrays::spin_x + c)[i] = spin[static_cast<Eigen::Index>(c)];
  }
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

DemInfill::OverlapStatistics DemInfill::overlaps() const {
  Impl& my = *impl_;
  my.ask(Request::contacts);
  const SharedState& shared = my.shared();
  return {shared.overlap_mean, shared.overlap_percentile_99, shared.overlap_largest,
          static_cast<std::size_t>(shared.contacts)};
}

}  // namespace tuft::dem

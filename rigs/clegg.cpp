#include "rigs/clegg.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "rigs/butterworth.h"

namespace tuft::rigs {
namespace {
constexpr double standard_gravity = 9.80665;  // m/s^2, ISO 80000-3: the unit "g" of the results
constexpr double pulse_share = 0.1;           // of the peak: where a pulse begins and ends

/// Time around the sample `peak` in which the signal stays above a tenth of its value there, s; ends are
/// interpolated between samples.
double pulse_duration(const std::vector<double>& signal, std::size_t peak, double interval) {
  const double level = pulse_share * signal[peak];
  if (!(level > 0)) return 0;
  double first = 0, last = static_cast<double>(signal.size() - 1);
  for (std::size_t i = peak; i > 0; --i)
    if (signal[i - 1] <= level) {
      first = static_cast<double>(i) - (signal[i] - level) / (signal[i] - signal[i - 1]);
      break;
    }
  for (std::size_t i = peak; i + 1 < signal.size(); ++i)
    if (signal[i + 1] <= level) {
      last = static_cast<double>(i) + (signal[i] - level) / (signal[i] - signal[i + 1]);
      break;
    }
  return (last - first) * interval;
}

/// The sample before the first force over the threshold ends where contact begins.
double height_at(const DropRecord& record, std::size_t touch) {
  return touch > 0 ? record.height[touch - 1] : record.height[0];
}

}  // namespace

void TouchClock::sample(double force) {
  if (force < touch_force_)
    candidate_.reset();
  else if (!candidate_)
    candidate_ = samples_;
  ++samples_;
  if (!(force > largest_)) return;
  largest_ = force;
  touch_ = candidate_;
}

DropResults evaluate_drop(const DropRecord& record, const std::vector<double>& filtered, double mass,
                          double touch_force) {
  DropResults r;
  const std::size_t n = record.acceleration.size();
  TouchClock clock(touch_force);
  for (const double acceleration : record.acceleration) clock.sample(acceleration * mass);
  if (!clock.touched()) return r;
  const std::size_t touch = clock.touch();
  r.touched = true;
  r.touch_time = static_cast<double>(touch) * record.interval;
  r.impact_velocity = -(touch > 0 ? record.velocity[touch - 1] : record.velocity[0]);
  std::size_t peak = touch, deepest = touch;
  for (std::size_t i = touch; i < n; ++i) {
    if (filtered[i] > filtered[peak]) peak = i;
    if (record.height[i] < record.height[deepest]) deepest = i;
  }
  r.peak_g = filtered[peak] / standard_gravity;
  r.time_of_peak = static_cast<double>(peak - touch) * record.interval;
  r.pulse_duration = pulse_duration(filtered, peak, record.interval);
  r.max_penetration = height_at(record, touch) - record.height[deepest];
  std::size_t last_contact = touch;
  for (std::size_t i = touch; i < n; ++i)
    if (record.acceleration[i] * mass >= touch_force) last_contact = i;
  r.separated = last_contact + 1 < n && last_contact > deepest && record.velocity[last_contact] > 0;
  r.contact_time = static_cast<double>(last_contact - touch + 1) * record.interval;
  if (r.separated) {
    r.rebound_velocity = record.velocity[last_contact];
  } else {
    for (std::size_t i = deepest; i < n; ++i)
      r.rebound_velocity = std::max(r.rebound_velocity, record.velocity[i]);
  }
  return r;
}

std::vector<coupler::RigidBody> CleggTester::bodies() const {
  coupler::RigidBody missile;
  missile.name = "missile";
  missile.shape = coupler::Cylinder{0.5 * settings_.diameter, settings_.height};
  missile.position = Vec3(settings_.position[0], settings_.position[1], 0);
  missile.mass = settings_.mass;
  missile.freedom = Vec3(0, 0, 1);
  missile.present = false;
  return {missile};
}

double CleggTester::energy_scale() const {
  return 0.5 * settings_.mass * settings_.speed * settings_.speed;
}

void CleggTester::release(coupler::Simulation& simulation) {
  const double x = settings_.position[0], y = settings_.position[1], radius = 0.5 * settings_.diameter;
  const double infill = simulation.highest_infill(x, y, radius);
  const double start =
      std::max(infill, simulation.highest_carpet(x, y, radius)) + 1e-4;  // clear of everything by 0.1 mm
  // The asked speed is the one at the infill's surface; above it the missile falls free through the pile's
  // tips.
  const double squared = settings_.speed * settings_.speed - 2 * gravity_ * (start - infill);
  if (!(squared > 0))
    throw_run_error(
        "rig.speed = {:.3g} m/s is too slow to be reached by a fall of {:.3g} mm from the fibres' tips to "
        "the infill",
        settings_.speed, 1e3 * (start - infill));
  simulation.release_body(body_, Vec3(x, y, start), Vec3(0, 0, -std::sqrt(squared)));
}

void CleggTester::sample(const coupler::Simulation& simulation, double time, double interval) {
  if (time <= 0) {
    ++samples_before_release_;
    return;
  }
  record_.interval = interval;
  const coupler::RigidBody& body = simulation.bodies()[body_];
  const double acceleration = simulation.interval_impulse()[body_].z() / (settings_.mass * interval);
  clock_.sample(acceleration * settings_.mass);
  record_.acceleration.push_back(acceleration);
  record_.velocity.push_back(body.velocity.z());
  record_.height.push_back(body.position.z());
}

std::vector<HistoryColumn> CleggTester::columns() const {
  return {{"acceleration", "m/s^2"}, {"velocity", "m/s"}, {"height", "m"}, {"contact_force", "N"}};
}

std::vector<double> CleggTester::row() const {
  if (record_.acceleration.empty()) return {0, 0, 0, 0};
  const double acceleration = record_.acceleration.back();
  return {acceleration, record_.velocity.back(), record_.height.back(), acceleration * settings_.mass};
}

std::vector<double> CleggTester::penetration() const {
  std::vector<double> depth(record_.height.size(), 0.0);
  if (!clock_.touched()) return depth;
  const double surface = height_at(record_, clock_.touch());
  for (std::size_t i = clock_.touch(); i < depth.size(); ++i) depth[i] = surface - record_.height[i];
  return depth;
}

std::vector<double> CleggTester::filtered() const {
  return zero_phase_lowpass(record_.acceleration, record_.interval, settings_.filter_cutoff);
}

std::vector<Rig::FinishedColumn> CleggTester::finished_columns() const {
  const auto since_release = [&](const std::vector<double>& samples) {
    std::vector<double> column(samples_before_release_, 0.0);
    column.insert(column.end(), samples.begin(), samples.end());
    return column;
  };
  return {{{"acceleration_filtered", "m/s^2"},
           since_release(record_.acceleration.empty() ? std::vector<double>{} : filtered())},
          {{"penetration", "m"}, since_release(penetration())}};
}

std::map<std::string, Quantity> CleggTester::results() const {
  if (record_.acceleration.empty()) return {};
  const DropResults r = evaluate_drop(record_, filtered(), settings_.mass, settings_.touch_force);
  if (!r.touched) return {};
  const auto highest = std::max_element(record_.acceleration.begin(), record_.acceleration.end());
  return {{"peak_g", {r.peak_g, "g"}},
          {"peak_g_raw", {*highest / standard_gravity, "g"}},
          {"time_of_peak", {r.time_of_peak, "s"}},
          {"rebound_velocity", {r.rebound_velocity, "m/s"}},
          {"max_penetration", {r.max_penetration, "m"}},
          {"pulse_duration", {r.pulse_duration, "s"}},
          {"contact_time", {r.contact_time, "s"}},
          {"impact_velocity", {r.impact_velocity, "m/s"}},
          {"separated", {r.separated ? 1.0 : 0.0, "1"}}};
}

void CleggTester::save(h5::Group& group) const {
  group.write("acceleration", std::span<const double>(record_.acceleration));
  group.write("velocity", std::span<const double>(record_.velocity));
  group.write("height", std::span<const double>(record_.height));
  group.write_scalar("interval", record_.interval);
  group.write_scalar("samples_before_release", static_cast<std::uint64_t>(samples_before_release_));
}

void CleggTester::load(const h5::Group& group) {
  record_.acceleration = group.read_doubles("acceleration");
  record_.velocity = group.read_doubles("velocity");
  record_.height = group.read_doubles("height");
  record_.interval = group.read_double("interval");
  clock_ = TouchClock(settings_.touch_force);
  for (const double acceleration : record_.acceleration) clock_.sample(acceleration * settings_.mass);
  samples_before_release_ = group.read_count("samples_before_release");
}

std::unique_ptr<Rig> make_rig(const Scene& scene) {
  if (scene.rig.type == "clegg") return std::make_unique<CleggTester>(scene.rig.clegg, 9.81);
  throw_input_error("{}: rig.type: \"{}\" is not a rig; known: clegg", scene.file, scene.rig.type);
}

}  // namespace tuft::rigs

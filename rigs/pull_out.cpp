#include "rigs/pull_out.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/checkpoint_values.h"
#include "core/error.h"
#include "rigs/row_table.h"

namespace tuft::rigs {
namespace {

enum Body : std::size_t { upper_platen, lower_platen };
constexpr double pressing = 0, held = 1, drawing = 2;  // PullRow::phase

/// Over the last of the way to the stress (this share of it, or so many rows at the present pace) the platens
/// slow down in proportion to what is left.
constexpr double approach_share = 0.05, approach_rows = 5, slowest = 0.02;
constexpr double most_compression = 0.7;  // of the height

coupler::RigidBody plane(const char* name, const Vec3& position, const Vec3& normal, double friction) {
  coupler::RigidBody body;
  body.name = name;
  body.shape = coupler::HalfSpace{normal};
  body.position = position;
  body.friction = FrictionLaw{friction, friction, 0};
  return body;
}

/// N, sum of the normal forces of infill on the strand.
double pressed_on_strand(const coupler::Simulation& simulation) {
  const ContactNetwork network = simulation.boundary_contacts();
  double sum = 0;
  for (std::size_t c = 0; c < network.size(); ++c)
    if (network.kind[c] == ContactKind::fibre) sum += network.normal_force[c].norm();
  return sum;
}

}  // namespace

std::array<double, PullRow::count> PullRow::values() const {
  return {time, phase, displacement, force, normal_stress, pressure, closed};
}

PullRow PullRow::of(std::span<const double> v) {
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
}

PullResults evaluate_pull(std::span<const PullRow> rows, const StripFriction& strip) {
  PullResults results;
  const double travel = strip.rig.travel;
  double force = 0, stress = 0, pressure = 0, over_platens = 0, over_strand = 0;
  std::size_t count = 0;
  bool reached = false;
  for (const PullRow& row : rows) {
    if (row.phase != drawing) continue;
    if (row.force > results.peak_force) {
      results.peak_force = row.force;
      results.displacement_at_peak = row.displacement;
    }
    reached = reached || row.displacement >= 0.98 * travel;
    if (row.displacement < 0.5 * travel) continue;
    const double faces = 2 * strip.friction * strip.width * embedded_length(strip.rig, row.displacement);
    force += row.force;
    stress += row.normal_stress;
    pressure += row.pressure;
    over_platens += faces * row.normal_stress;
    over_strand += faces * row.pressure;
    ++count;
  }
  if (!reached || count == 0) return results;
  const auto n = static_cast<double>(count);
  results.steady_force = force / n;
  results.normal_stress = stress / n;
  results.pressure = pressure / n;
  if (over_platens > 0) results.over_platens = force / over_platens;
  if (over_strand > 0) results.over_strand = force / over_strand;
  return results;
}

PullOut::PullOut(const Scene& scene)
    : rig_(scene.rig.specimen),
      strand_(make_pull_out_strand(scene)),
      strand_width_(scene.turf.carpet.strand_width),
      rows_(scene.rig.specimen.speeds.size()) {
  const bool with_rate = effect_on(decide_effects(scene), "friction_rate");
  for (const double speed : rig_.speeds) friction_.push_back(strand_friction(scene, speed, with_rate));
  // M grows with the stress: 3/2 stress / M is what grains give way, and more than a continuum does.
  const double expected = 1.5 * rig_.normal_stress /
                          coupler::placed_modulus(scene, rig_.material, rig_.normal_stress) * rig_.height;
  closing_ = 0.5 * expected / rig_.load_time;
}

double PullOut::run_speed(std::size_t test) const {
  return rig_.run_speed > 0 ? rig_.run_speed : rig_.speeds.at(test);
}

StripFriction PullOut::strip(std::size_t test) const {
  return {friction_.at(test), strand_width_, rig_};
}

std::string PullOut::label(std::size_t test) const {
  return fmt::format("{:g} mm/s", 1e3 * rig_.speeds.at(test));
}

std::string PullOut::prefix(std::size_t test) const {
  return fmt::format("speed_{:g}_mm_s_", 1e3 * rig_.speeds.at(test));
}

coupler::SpecimenRoom PullOut::room() const {
  return {rig_.material, rig_.height, rig_.size};
}

void PullOut::adjust(Scene& scene, std::size_t test) const {
  run_friction_of(scene, rig_.speeds.at(test), run_speed(test));
}

/// Both platens are driven, so that the strand between them stays at its height.
std::vector<coupler::RigidBody> PullOut::bodies(std::size_t, const coupler::Specimen& specimen) const {
  const double reach = specimen.reach, x = 0.5 * rig_.size[0] + reach, y = 0.5 * rig_.size[1] + reach;
  std::vector<coupler::RigidBody> bodies{
      plane("upper_platen", Vec3(0, 0, specimen.top), Vec3(0, 0, -1), rig_.platen_friction),
      plane("lower_platen", Vec3(0, 0, -reach), Vec3(0, 0, 1), rig_.platen_friction),
      plane("wall_x_low", Vec3(-x, 0, 0), Vec3(1, 0, 0), rig_.wall_friction),
      plane("wall_x_high", Vec3(x, 0, 0), Vec3(-1, 0, 0), rig_.wall_friction),
      plane("wall_y_low", Vec3(0, -y, 0), Vec3(0, 1, 0), rig_.wall_friction),
      plane("wall_y_high", Vec3(0, y, 0), Vec3(0, -1, 0), rig_.wall_friction)};
  bodies[upper_platen].driven = bodies[lower_platen].driven = true;
  return bodies;
}

double PullOut::energy_scale(std::size_t) const {
  return 1e-3 * rig_.normal_stress * area() * rig_.height;
}

double PullOut::interval() const {
  return rig_.sample_travel / run_speed(test_);
}

std::size_t PullOut::held_rows() const {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(rig_.load_time / interval())));
}

void PullOut::begin(std::size_t test, const coupler::Simulation& simulation) {
  test_ = test;
  held_ = 0;
  pressed_ = false;
  grip_speed_ = platen_speed_ = displacement_ = 0;
  grip_impulse_ = simulation.carpet().grips().impulse.x();
  start_gap_ =
      simulation.bodies()[upper_platen].position.z() - simulation.bodies()[lower_platen].position.z();
}

void PullOut::drive(coupler::Simulation& simulation) {
  const std::vector<PullRow>& rows = rows_[test_];
  if (!pressed_) {
    const double stress = rows.empty() ? 0 : rows.back().normal_stress;
    const double change = rows.size() > 1 ? std::abs(stress - rows[rows.size() - 2].normal_stress) : 0;
    const double pace = platen_speed_ > 0 ? change * closing_ / platen_speed_ : 0;  // Pa a row at full speed
    const double zone = std::max(approach_share * rig_.normal_stress, approach_rows * pace);
    const double wanted = closing_ * std::clamp((rig_.normal_stress - stress) / zone, slowest, 1.0);
    platen_speed_ = std::min(wanted, platen_speed_ + speed_step * closing_);
  } else {
    platen_speed_ = 0;
  }
  simulation.drive_body(upper_platen, Vec3(0, 0, -platen_speed_));
  simulation.drive_body(lower_platen, Vec3(0, 0, platen_speed_));
  if (pressed_ && held_ >= held_rows())
    grip_speed_ = std::min(run_speed(test_), grip_speed_ + speed_step * run_speed(test_));
  simulation.drive_carpet(strand_.driven, Vec3(grip_speed_, 0, 0));
}

void PullOut::sample(const coupler::Simulation& simulation) {
  const double dt = interval();
  std::vector<PullRow>& rows = rows_[test_];
  PullRow row;
  row.time = (static_cast<double>(rows.size()) + 0.5) * dt;
  row.phase = grip_speed_ > 0 ? drawing : pressed_ ? held : pressing;
  const double moved = grip_speed_ * dt, impulse = simulation.carpet().grips().impulse.x();
  row.displacement = displacement_ + 0.5 * moved;
  displacement_ += moved;
  row.force = (impulse - grip_impulse_) / dt;
  grip_impulse_ = impulse;
  row.normal_stress =
      0.5 * (mean_force(simulation, upper_platen, dt).z() - mean_force(simulation, lower_platen, dt).z()) /
      area();
  row.pressure = pressed_on_strand(simulation) / (2 * strand_width_ * embedded_length(rig_, displacement_));
  row.closed = start_gap_ - (simulation.bodies()[upper_platen].position.z() -
                             simulation.bodies()[lower_platen].position.z());
  rows.push_back(row);
  if (pressed_) ++held_;
  pressed_ = pressed_ || row.normal_stress >= rig_.normal_stress;
  if (row.closed > most_compression * start_gap_)
    throw_run_error(
        "pull_out: {:.3g} kPa after the platens have closed by {:.3g} mm, {:g} % of the height, and "
        "rig.normal_stress "
        "of {:g} kPa is not reached; lower it",
        1e-3 * row.normal_stress, 1e3 * row.closed, 100 * most_compression, 1e-3 * rig_.normal_stress);
}

bool PullOut::done() const {
  return displacement_ >= rig_.travel * (1 - 1e-9);
}

double PullOut::share_done() const {
  constexpr double pressing_over_held = 3;  // in rows: gathering speed and slowing down before the stress
  const auto held_in_all = static_cast<double>(held_rows());
  const double to_press = pressing_over_held * held_in_all, to_draw = rig_.travel / rig_.sample_travel;
  const double rows_done = pressed_ ? to_press + std::min(static_cast<double>(held_), held_in_all) +
                                          to_draw * displacement_ / rig_.travel
                                    : std::min(to_press, static_cast<double>(rows_[test_].size()));
  return std::min(1.0, rows_done / (to_press + held_in_all + to_draw));
}

std::string PullOut::stage() const {
  return fmt::format("{}, {}", label(test_), grip_speed_ > 0 ? "drawing" : pressed_ ? "held" : "pressing");
}

std::vector<HistoryColumn> PullOut::columns() const {
  return {{"test", "1"},
          {"test_time", "s"},
          {"phase", "1"},
          {"displacement", "m"},
          {"force", "N"},
          {"normal_stress", "Pa"},
          {"strand_pressure", "Pa"},
          {"closed", "m"}};
}

std::vector<double> PullOut::row() const {
  std::vector<double> row{static_cast<double>(test_)};
  const auto values = rows_[test_].empty() ? PullRow{}.values() : rows_[test_].back().values();
  row.insert(row.end(), values.begin(), values.end());
  return row;
}

void PullOut::add_results(std::map<std::string, Quantity>& results,
                          std::map<std::string, Quantity>& notes) const {
  for (std::size_t test = 0; test < tests(); ++test) {
    const std::string of = prefix(test);
    const PullResults r = evaluate_pull(rows_[test], strip(test));
    if (!(r.peak_force > 0)) continue;
    const auto add = [&](const char* name, const std::optional<double>& value, const char* unit) {
      if (value) results[of + name] = {*value, unit};
    };
    add("peak_force", r.peak_force, "N");
    add("displacement_at_peak", r.displacement_at_peak, "m");
    add("steady_force", r.steady_force, "N");
    add("normal_stress", r.normal_stress, "Pa");
    add("strand_pressure", r.pressure, "Pa");
    add("force_over_strip_formula", r.over_platens, "1");
    add("force_over_friction_on_strand", r.over_strand, "1");
    notes[of + "friction"] = {friction_[test], "1"};
    notes[of + "run_speed"] = {run_speed(test), "m/s"};
    notes[of + "closed"] = {rows_[test].back().closed, "m"};
  }
}

std::map<std::string, Quantity> PullOut::result_names() const {
  std::map<std::string, Quantity> names;
  for (std::size_t test = 0; test < tests(); ++test) {
    const std::string of = prefix(test);
    names[of + "peak_force"] = names[of + "steady_force"] = {0, "N"};
    names[of + "displacement_at_peak"] = {0, "m"};
    names[of + "normal_stress"] = names[of + "strand_pressure"] = {0, "Pa"};
    names[of + "force_over_strip_formula"] = names[of + "force_over_friction_on_strand"] = {0, "1"};
  }
  return names;
}

std::vector<SpecimenCurve> PullOut::curve_names() const {
  std::vector<SpecimenCurve> curves;
  for (std::size_t test = 0; test < tests(); ++test)
    curves.push_back({prefix(test) + "pull", "m", "N", "displacement of the grip", "force", {}, {}});
  return curves;
}

std::vector<SpecimenCurve> PullOut::curves() const {
  std::vector<SpecimenCurve> curves = curve_names();
  for (std::size_t test = 0; test < tests(); ++test)
    for (const PullRow& row : rows_[test]) {
      if (row.phase != drawing) continue;
      curves[test].x.push_back(row.displacement);
      curves[test].y.push_back(row.force);
    }
  return curves;
}

void PullOut::save(h5::Group& group) const {
  save_rows(group, rows_);
  const std::vector<double> state{static_cast<double>(held_),
                                  pressed_ ? 1.0 : 0.0,
                                  grip_speed_,
                                  platen_speed_,
                                  displacement_,
                                  grip_impulse_,
                                  start_gap_};
  group.write("state", std::span<const double>(state));
}

void PullOut::load(const h5::Group& group) {
  load_rows(group, rows_);
  const std::vector<double> state = h5::read_checked(group, "state", 7);
  h5::check_whole(group, "state", 0, state[0], h5::not_negative);
  held_ = static_cast<std::size_t>(state[0]);
  pressed_ = state[1] != 0;
  grip_speed_ = state[2];
  platen_speed_ = state[3];
  displacement_ = state[4];
  grip_impulse_ = state[5];
  start_gap_ = state[6];
}

}  // namespace tuft::rigs

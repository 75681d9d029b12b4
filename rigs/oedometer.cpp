#include "rigs/oedometer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/checkpoint_values.h"
#include "core/error.h"
#include "core/loading_branch.h"
#include "rigs/row_table.h"

namespace tuft::rigs {
namespace {

/// Over the last of the way to a force (this share of the preload, or so many rows at the present pace) the
/// plate slows down in proportion to what is left, so that it turns close to it.
constexpr double approach_share = 0.02, approach_rows = 20, slowest = 0.02;
constexpr double most_compression = 0.7;  // of the height

/// Integral of stress over strain, J/m^3.
double work(std::span<const OedometerRow> rows) {
  double sum = 0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    sum += 0.5 * (rows[i].stress + rows[i - 1].stress) * (rows[i].strain - rows[i - 1].strain);
  return sum;
}

}  // namespace

std::array<double, OedometerRow::count> OedometerRow::values() const {
  return {time,   cycle, direction,   travel,     compression,  strain,
          stress, force, force_below, force_ring, inertia_force};
}

OedometerRow OedometerRow::of(std::span<const double> v) {
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10]};
}

CycleResults evaluate_cycle(std::span<const OedometerRow> rows, double seating_force) {
  CycleResults results;
  const auto peak =
      std::max_element(rows.begin(), rows.end(),
                       [](const OedometerRow& a, const OedometerRow& b) { return a.force < b.force; });
  if (peak == rows.end()) return results;
  results.peak_force = peak->force;
  results.peak_strain = peak->strain;
  const auto split = static_cast<std::size_t>(peak - rows.begin()) + 1;
  const std::span<const OedometerRow> up = rows.first(split), down = rows.subspan(split - 1);
  results.loading_modulus =
      secant_modulus(up, cycle_low_share * peak->stress, cycle_high_share * peak->stress, 1);
  results.unloading_modulus =
      secant_modulus(down, cycle_high_share * peak->stress, cycle_low_share * peak->stress, -1);
  if (!(rows.back().force <= seating_force) || down.size() < 2) return results;
  results.residual_strain = rows.back().strain;
  if (const double put_in = work(up); put_in > 0) results.loss = 1 + work(down) / put_in;
  return results;
}

std::optional<double> loading_secant(std::span<const OedometerRow> rows, double low, double high) {
  return secant_modulus(rows, low, high, 1);
}

Oedometer::Oedometer(const Scene& scene)
    : rig_(scene.rig.specimen),
      of_grains_(scene.infill.approach == Approach::dem),
      rows_(scene.rig.specimen.preloads.size()) {
  if (!of_grains_) return;
  // M grows with the cube root of the stress, so the strain is 3/2 stress / M.
  for (const double preload : rig_.preloads) {
    const double stress = preload / area();
    expected_travel_.push_back(1.5 * stress / coupler::placed_modulus(scene, rig_.material, stress) *
                               rig_.height);
  }
}

double Oedometer::area() const {
  return std::numbers::pi / 4 * rig_.diameter * rig_.diameter;
}

std::string Oedometer::label(std::size_t test) const {
  return fmt::format("{:g} N", rig_.preloads.at(test));
}

coupler::SpecimenRoom Oedometer::room() const {
  return {rig_.material, rig_.height, {rig_.diameter, rig_.diameter}, true};
}

std::vector<coupler::RigidBody> Oedometer::bodies(std::size_t, const coupler::Specimen& specimen) const {
  const double reach = specimen.reach;
  coupler::RigidBody below, above, around;
  below.name = "lower_plate";
  below.shape = coupler::HalfSpace{Vec3(0, 0, 1)};
  below.position = Vec3(0, 0, -reach);
  above.name = "upper_plate";
  above.shape = coupler::HalfSpace{Vec3(0, 0, -1)};
  above.position = Vec3(0, 0, specimen.top);
  above.driven = true;
  around.name = "ring";
  around.shape = coupler::Bore{0.5 * rig_.diameter + reach};
  around.friction = FrictionLaw{rig_.wall_friction, rig_.wall_friction, 0};
  return {below, above, around};
}

double Oedometer::energy_scale(std::size_t test) const {
  return 1e-3 * rig_.preloads.at(test) * rig_.height;
}

double Oedometer::interval() const {
  return rig_.sample_travel / (rig_.speed * rig_.speed_factor);
}

void Oedometer::begin(std::size_t test, const coupler::Simulation& simulation) {
  test_ = test;
  cycle_ = 1;
  loading_ = true;
  speed_ = 0;
  start_height_ = height_before_ = simulation.bodies()[upper_plate].position.z();
  height_ = rig_.height;
  placed_height_ = start_height_;
  seated_ = !of_grains_;
  const ParticleView p = simulation.infill().particles();
  const std::vector<coupler::NormalSpring>& spring = simulation.particle_body().settings().spring;
  double below = 0, above = 0, mass = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    mass += p.mass[i];
    if (p.z[i] < 0.1 * p.radius[i]) below += spring[i].stiffness;
    if (p.z[i] > rig_.height - 0.1 * p.radius[i]) above += spring[i].stiffness;
  }
  // The contacts of a continuum are a penalty, which gives way by more than the infill; those of grains are
  // what grains have.
  give_below_ = of_grains_ ? 0 : 1 / below;
  give_above_ = of_grains_ ? 0 : 1 / above;
  weight_ = standard_weight * mass;
}

void Oedometer::drive(coupler::Simulation& simulation) {
  const double full = rig_.speed * rig_.speed_factor, preload = rig_.preloads[test_];
  const std::vector<OedometerRow>& rows = rows_[test_];
  const std::size_t count = rows.size();
  const double force = count > 0 ? rows.back().force : 0;
  const double last_change = count > 1 ? std::abs(force - rows[count - 2].force) : 0;
  const double pace = speed_ != 0 ? last_change * full / std::abs(speed_) : 0;  // N a row at full speed
  const double left = loading_ ? preload - force : force - rig_.seating_force;
  const double zone = std::max(approach_share * preload, approach_rows * pace);
  const double wanted = (loading_ ? 1 : -1) * full * std::clamp(left / zone, slowest, 1.0);
  // Gathering speed is gradual, braking is as the force asks.
  const bool turns = wanted * speed_ < 0;
  const double from = turns ? 0 : speed_;
  speed_ = std::abs(wanted) > std::abs(from)
               ? from + std::clamp(wanted - from, -speed_step * full, speed_step * full)
               : wanted;
  simulation.drive_body(upper_plate, Vec3(0, 0, -speed_));
}

void Oedometer::sample(const coupler::Simulation& simulation) {
  const double dt = interval();
  std::vector<OedometerRow>& rows = rows_[test_];
  OedometerRow row;
  row.time = (static_cast<double>(rows.size()) + 0.5) * dt;
  row.cycle = cycle_;
  row.direction = loading_ ? 1 : -1;
  const double height = simulation.bodies()[upper_plate].position.z();
  const double middle = 0.5 * (height_before_ + height);
  height_before_ = height;
  row.force = mean_force(simulation, upper_plate, dt).z();
  if (!seated_) {
    start_height_ = height_ = middle;
    seated_ = row.force >= rig_.seating_force;
  }
  row.travel = start_height_ - middle;
  row.force_below = -mean_force(simulation, lower_plate, dt).z();
  row.force_ring = -mean_force(simulation, ring, dt).z();
  row.inertia_force = row.force + weight_ - row.force_below - row.force_ring;
  row.compression = row.travel - give_above_ * row.force - give_below_ * row.force_below;
  row.strain = row.compression / height_;
  row.stress = row.force / area();
  rows.push_back(row);
  if (loading_ && row.force >= rig_.preloads[test_]) {
    loading_ = false;
  } else if (!loading_ && row.force <= rig_.seating_force) {
    loading_ = true;
    ++cycle_;
  }
  if (row.travel > most_compression * height_)
    throw_run_error(
        "oedometer: {:.3g} N after {:.3g} mm, {:g} % of the height, and the preload of {:g} N is not "
        "reached; lower "
        "rig.preloads",
        row.force, 1e3 * row.travel, 100 * most_compression, rig_.preloads[test_]);
}

double Oedometer::share_done() const {
  if (rows_[test_].empty()) return 0;
  double on_the_way = std::clamp(rows_[test_].back().force / rig_.preloads[test_], 0.0, 1.0);
  if (of_grains_) {
    // The plate has to reach them first; of the force nothing can be said before.
    const double lowest = std::min(rig_.height, placed_height_) - expected_travel_[test_];
    on_the_way = std::clamp((placed_height_ - height_before_) / (placed_height_ - lowest), 0.0, 1.0);
  }
  return std::min(1.0, (cycle_ - 1 + 0.5 * (loading_ ? on_the_way : 2 - on_the_way)) / rig_.cycles);
}

std::string Oedometer::stage() const {
  return fmt::format("{}, {} {}", label(test_), loading_ ? "loading" : "unloading", cycle_);
}

std::vector<HistoryColumn> Oedometer::columns() const {
  return {{"test", "1"},   {"test_time", "s"},   {"cycle", "1"},      {"direction", "1"},
          {"travel", "m"}, {"compression", "m"}, {"strain", "1"},     {"stress", "Pa"},
          {"force", "N"},  {"force_below", "N"}, {"force_ring", "N"}, {"inertia_force", "N"}};
}

std::vector<double> Oedometer::row() const {
  std::vector<double> row{static_cast<double>(test_)};
  const auto values = rows_[test_].empty() ? OedometerRow{}.values() : rows_[test_].back().values();
  row.insert(row.end(), values.begin(), values.end());
  return row;
}

void Oedometer::add_results(std::map<std::string, Quantity>& results,
                            std::map<std::string, Quantity>& notes) const {
  for (std::size_t test = 0; test < tests(); ++test) {
    const std::span<const OedometerRow> rows = rows_[test];
    const std::string prefix = fmt::format("preload_{:g}_", rig_.preloads[test]);
    const auto add = [&](const std::string& name, std::optional<double> value, const char* unit) {
      if (value) results[prefix + name] = {*value, unit};
    };
    double peak = 0, inertia = 0, friction = 0;
    for (const OedometerRow& row : rows) {
      peak = std::max(peak, row.force);
      inertia = std::max(inertia, std::abs(row.inertia_force));
      friction = std::max(friction, std::abs(row.force_ring));
    }
    if (!(peak > 0)) continue;
    std::size_t begin = 0;
    for (int cycle = 1; begin < rows.size(); ++cycle) {
      std::size_t end = begin;
      while (end < rows.size() && rows[end].cycle == cycle) ++end;
      const std::span<const OedometerRow> of_cycle = rows.subspan(begin, end - begin);
      begin = end;
      const bool turned = of_cycle.back().direction < 0;
      if (!turned) continue;  // not loaded to its end
      const CycleResults r = evaluate_cycle(of_cycle, rig_.seating_force);
      const std::string of = fmt::format("cycle_{}_", cycle);
      add(of + "loading_modulus", r.loading_modulus, "Pa");
      add(of + "unloading_modulus", r.unloading_modulus, "Pa");
      add(of + "loss", r.loss, "1");
      add(of + "strain_at_preload", r.peak_strain, "1");
      add(of + "residual_strain", r.residual_strain, "1");
      if (cycle > 1) continue;
      const auto split = std::find_if(of_cycle.begin(), of_cycle.end(),
                                      [](const OedometerRow& row) { return row.direction < 0; });
      const auto up = of_cycle.first(static_cast<std::size_t>(split - of_cycle.begin()));
      add("modulus_100_to_600_kpa", loading_secant(up, 100e3, 600e3), "Pa");
      if (r.loading_modulus && r.unloading_modulus)
        add("unloading_over_loading", *r.unloading_modulus / *r.loading_modulus, "1");
    }
    notes[prefix + "overshoot"] = {peak / rig_.preloads[test] - 1, "1"};
    notes[prefix + "inertia_share"] = {inertia / peak, "1"};
    notes[prefix + "ring_friction_share"] = {friction / peak, "1"};
    if (of_grains_ && rows.back().strain > 0) {
      const double height = rows.back().compression / rows.back().strain;
      notes[prefix + "seated_height"] = {height, "m"};
      notes[prefix + "seated_density"] = {weight_ / (standard_weight * area() * height), "kg/m^3"};
    }
    notes[prefix + "contact_compression"] = {(give_above_ + give_below_) * peak, "m"};
  }
}

std::map<std::string, Quantity> Oedometer::result_names() const {
  std::map<std::string, Quantity> names;
  for (const double preload : rig_.preloads) {
    const std::string prefix = fmt::format("preload_{:g}_", preload);
    for (int cycle = 1; cycle <= rig_.cycles; ++cycle) {
      const std::string of = fmt::format("{}cycle_{}_", prefix, cycle);
      for (const char* modulus : {"loading_modulus", "unloading_modulus"}) names[of + modulus] = {0, "Pa"};
      for (const char* share : {"loss", "strain_at_preload", "residual_strain"}) names[of + share] = {0, "1"};
    }
    names[prefix + "modulus_100_to_600_kpa"] = {0, "Pa"};
    names[prefix + "unloading_over_loading"] = {0, "1"};
  }
  return names;
}

std::vector<SpecimenCurve> Oedometer::curve_names() const {
  std::vector<SpecimenCurve> curves;
  for (const double preload : rig_.preloads)
    for (int cycle = 1; cycle <= rig_.cycles; ++cycle)
      for (const char* branch : {"loading", "unloading"})
        curves.push_back({fmt::format("preload_{:g}_cycle_{}_{}", preload, cycle, branch),
                          "1",
                          "Pa",
                          "compression",
                          "axial stress",
                          {},
                          {}});
  return curves;
}

std::vector<SpecimenCurve> Oedometer::curves() const {
  std::vector<SpecimenCurve> curves = curve_names();
  auto curve = curves.begin();
  for (std::size_t test = 0; test < tests(); ++test)
    for (int cycle = 1; cycle <= rig_.cycles; ++cycle)
      for (const double direction : {1.0, -1.0}) {
        for (const OedometerRow& row : rows_[test]) {
          if (row.cycle != cycle || row.direction != direction) continue;
          curve->x.push_back(row.strain);
          curve->y.push_back(row.stress);
        }
        ++curve;
      }
  return curves;
}

void Oedometer::save(h5::Group& group) const {
  save_rows(group, rows_);
  const std::vector<double> state{height_before_,       speed_,  static_cast<double>(cycle_),
                                  loading_ ? 1.0 : 0.0, height_, start_height_,
                                  seated_ ? 1.0 : 0.0};
  group.write("state", std::span<const double>(state));
}

void Oedometer::load(const h5::Group& group) {
  load_rows(group, rows_);
  const std::vector<double> state = h5::read_checked(group, "state", 7);
  height_before_ = state[0];
  speed_ = state[1];
  h5::check_whole(group, "state", 2, state[2], {0, std::numeric_limits<int>::max()});
  cycle_ = static_cast<int>(state[2]);
  loading_ = state[3] != 0;
  height_ = state[4];
  start_height_ = state[5];
  seated_ = state[6] != 0;
}

}  // namespace tuft::rigs

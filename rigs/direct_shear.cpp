#include "rigs/direct_shear.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/checkpoint_values.h"
#include "rigs/row_table.h"

namespace tuft::rigs {
namespace {

enum Body : std::size_t { upper_plate, lower_plate, first_upper_wall, first_lower_wall = 6, body_count = 10 };
constexpr std::size_t walls = 4;                            // of each half
constexpr double wall_thickness = 0.05, wall_height = 0.1;  // m, more than the specimen ever reaches

bool is_upper(std::size_t body) {
  return body == upper_plate || (body >= first_upper_wall && body < first_upper_wall + walls);
}

/// Four walls of one half around the specimen, from the plane of shearing upwards (side 1) or downwards (-1).
void add_walls(std::vector<coupler::RigidBody>& bodies, const SpecimenRig& rig, double reach, double side) {
  const char* half = side > 0 ? "upper" : "lower";
  const double z = 0.5 * rig.height + side * 0.5 * wall_height;
  const auto add = [&](const char* name, const Vec3& position, const Vec3& edges) {
    coupler::RigidBody wall;
    wall.name = fmt::format("{}_{}", half, name);
    wall.shape = coupler::Block{edges};
    wall.position = position;
    wall.driven = side < 0;
    wall.friction = FrictionLaw{rig.wall_friction, rig.wall_friction, 0};
    bodies.push_back(wall);
  };
  const double x = 0.5 * rig.size[0] + reach + 0.5 * wall_thickness,
               y = 0.5 * rig.size[1] + reach + 0.5 * wall_thickness;
  // Across, as long as the box is moved along it and more.
  const Vec3 of_x(0.5 * wall_thickness, y + rig.size[1], 0.5 * wall_height),
      of_y(x + rig.size[0], 0.5 * wall_thickness, 0.5 * wall_height);
  add("wall_x_low", Vec3(-x, 0, z), of_x);
  add("wall_x_high", Vec3(x, 0, z), of_x);
  add("wall_y_low", Vec3(0, -y, z), of_y);
  add("wall_y_high", Vec3(0, y, z), of_y);
}

}  // namespace

std::array<double, ShearRow::count> ShearRow::values() const {
  return {time,          shearing,     displacement, shear_strain, shear_stress,
          normal_stress, plane_stress, force_upper,  force_lower,  height_change};
}

ShearRow ShearRow::of(std::span<const double> v) {
  return {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9]};
}

ShearResults evaluate_shear(std::span<const ShearRow> rows, double yield_strain) {
  ShearResults results;
  double shear = 0, plane = 0, displacement = 0;
  std::size_t count = 0;
  bool reached = false;
  for (const ShearRow& row : rows) {
    if (row.shearing == 0) continue;
    if (row.shear_stress > results.peak_stress) {
      results.peak_stress = row.shear_stress;
      results.strain_at_peak = row.shear_strain;
    }
    results.height_change = row.height_change;
    reached = reached || row.shear_strain >= yield_strain * (1 - 1e-9);
    if (row.shear_strain < yield_strain - yield_window || row.shear_strain > yield_strain * (1 + 1e-9))
      continue;
    shear += row.shear_stress;
    plane += row.plane_stress;
    displacement += row.displacement;
    ++count;
  }
  if (!reached || count == 0) return results;
  results.yield_stress = shear / static_cast<double>(count);
  results.displacement = displacement / static_cast<double>(count);
  results.plane_stress = plane / static_cast<double>(count);
  return results;
}

DirectShear::DirectShear(const Scene& scene)
    : rig_(scene.rig.specimen),
      rows_(scene.rig.specimen.normal_stresses.size()),
      density_(coupler::placed_density(scene, rig_.material)),
      plate_mass_(density_ * area() * rig_.height) {
  for (const double stress : rig_.normal_stresses)
    modulus_.push_back(coupler::placed_modulus(scene, rig_.material, stress));
}

double DirectShear::strain_length() const {
  return rig_.strain_basis == ShearStrainBasis::length ? rig_.size[0] : rig_.height;
}

std::string DirectShear::label(std::size_t test) const {
  return fmt::format("{:g} kPa", 1e-3 * rig_.normal_stresses.at(test));
}

coupler::SpecimenRoom DirectShear::room() const {
  return {rig_.material, rig_.height, rig_.size};
}

/// The upper plate has the specimen's mass, its guides the damping that is critical for that mass on the
/// specimen's stiffness under the load: it follows the specimen without ringing.
std::vector<coupler::RigidBody> DirectShear::bodies(std::size_t test,
                                                    const coupler::Specimen& specimen) const {
  const double reach = specimen.reach;
  const FrictionLaw rough{rig_.platen_friction, rig_.platen_friction, 0};
  coupler::RigidBody above, below;
  above.name = "upper_plate";
  above.shape = coupler::HalfSpace{Vec3(0, 0, -1)};
  above.position = Vec3(0, 0, specimen.top);
  above.mass = plate_mass_;
  above.freedom = Vec3(0, 0, 1);
  const double stiffness = modulus_.at(test) * area() / rig_.height;
  above.guide_damping = 2 * std::sqrt(stiffness * plate_mass_);
  above.friction = rough;
  below.name = "lower_plate";
  below.shape = coupler::HalfSpace{Vec3(0, 0, 1)};
  below.position = Vec3(0, 0, -reach);
  below.driven = true;
  below.friction = rough;
  std::vector<coupler::RigidBody> bodies{above, below};
  add_walls(bodies, rig_, reach, 1);
  add_walls(bodies, rig_, reach, -1);
  return bodies;
}

double DirectShear::energy_scale(std::size_t test) const {
  return 1e-3 * rig_.normal_stresses.at(test) * area() * rig_.height;
}

double DirectShear::interval() const {
  return rig_.sample_travel / (rig_.speed * rig_.speed_factor);
}

std::size_t DirectShear::loading_rows() const {
  return 2 * static_cast<std::size_t>(std::max(1.0, std::ceil(rig_.load_time / interval())));
}

void DirectShear::begin(std::size_t test, const coupler::Simulation& simulation) {
  test_ = test;
  displacement_ = speed_ = 0;
  height_ = start_height_ = simulation.bodies()[upper_plate].position.z();
}

void DirectShear::drive(coupler::Simulation& simulation) {
  const auto row = static_cast<double>(rows_[test_].size() + 1);
  const double rising = 0.5 * static_cast<double>(loading_rows());
  const double load = rig_.normal_stresses[test_] * area() * std::min(1.0, row / rising);
  // Its own weight is a part of the load.
  simulation.load_body(upper_plate, Vec3(0, 0, standard_weight * plate_mass_ - load));
  if (rows_[test_].size() < loading_rows()) return;
  const double full = rig_.speed * rig_.speed_factor;
  speed_ = std::min(full, speed_ + speed_step * full);
  for (std::size_t body = 0; body < body_count; ++body)
    if (!is_upper(body)) simulation.drive_body(body, Vec3(speed_, 0, 0));
}

void DirectShear::sample(const coupler::Simulation& simulation) {
  const double dt = interval();
  std::vector<ShearRow>& rows = rows_[test_];
  ShearRow row;
  row.time = (static_cast<double>(rows.size()) + 0.5) * dt;
  row.shearing = rows.size() >= loading_rows() ? 1 : 0;
  const double displacement = simulation.bodies()[lower_plate].position.x();
  const double height = simulation.bodies()[upper_plate].position.z();
  if (row.shearing == 0) start_height_ = height;
  row.displacement = 0.5 * (displacement_ + displacement);
  row.height_change = 0.5 * (height_ + height) - start_height_;
  if (row.shearing == 0) row.height_change = 0;
  displacement_ = displacement;
  height_ = height;
  double upper = 0, lower = 0, carried = 0;
  for (std::size_t body = 0; body < body_count; ++body) {
    const Vec3 force = mean_force(simulation, body, dt);
    (is_upper(body) ? upper : lower) += force.x();
    if (is_upper(body)) carried += force.z();
  }
  row.force_upper = upper;
  row.force_lower = -lower;
  row.shear_strain = row.displacement / strain_length();
  row.shear_stress = row.force_upper / area();
  row.normal_stress = mean_force(simulation, upper_plate, dt).z() / area();
  // Of the upper half of the specimen: what plate and walls press down, and half the weight.
  row.plane_stress = carried / area() + 0.5 * standard_weight * density_ * rig_.height;
  rows.push_back(row);
}

bool DirectShear::done() const {
  return !rows_[test_].empty() && rows_[test_].back().shear_strain >= rig_.yield_strain;
}

double DirectShear::share_done() const {
  const double shearing = rig_.yield_strain * strain_length() / rig_.sample_travel,
               loading = static_cast<double>(loading_rows());
  return std::min(1.0, static_cast<double>(rows_[test_].size()) / (shearing + loading));
}

std::string DirectShear::stage() const {
  return fmt::format("{}, {}", label(test_), rows_[test_].size() < loading_rows() ? "loading" : "shearing");
}

std::vector<HistoryColumn> DirectShear::columns() const {
  return {{"test", "1"},         {"test_time", "s"},     {"shearing", "1"},       {"displacement", "m"},
          {"shear_strain", "1"}, {"shear_stress", "Pa"}, {"normal_stress", "Pa"}, {"plane_stress", "Pa"},
          {"force_upper", "N"},  {"force_lower", "N"},   {"height_change", "m"}};
}

std::vector<double> DirectShear::row() const {
  std::vector<double> row{static_cast<double>(test_)};
  const auto values = rows_[test_].empty() ? ShearRow{}.values() : rows_[test_].back().values();
  row.insert(row.end(), values.begin(), values.end());
  return row;
}

void DirectShear::add_results(std::map<std::string, Quantity>& results,
                              std::map<std::string, Quantity>& notes) const {
  std::vector<double> normal, shear, remaining_normal, remaining_shear;
  for (std::size_t test = 0; test < tests(); ++test) {
    const std::span<const ShearRow> rows = rows_[test];
    const double wanted = rig_.normal_stresses[test];
    const std::string prefix = fmt::format("normal_{:g}_kpa_", 1e-3 * wanted);
    const ShearResults r = evaluate_shear(rows, rig_.yield_strain);
    if (!(r.peak_stress > 0)) continue;
    results[prefix + "peak_stress"] = {r.peak_stress, "Pa"};
    results[prefix + "strain_at_peak"] = {r.strain_at_peak, "1"};
    results[prefix + "height_change"] = {r.height_change, "m"};
    if (r.yield_stress) {
      results[prefix + "yield_stress"] = {*r.yield_stress, "Pa"};
      results[prefix + "stress_on_plane"] = {*r.plane_stress, "Pa"};
      normal.push_back(wanted);
      shear.push_back(*r.yield_stress);
      // The halves face each other over what is left of the length.
      const double left = 1 - r.displacement / rig_.size[0];
      remaining_normal.push_back(wanted / left);
      remaining_shear.push_back(*r.yield_stress / left);
      results[prefix + "yield_stress_on_remaining_area"] = {remaining_shear.back(), "Pa"};
    }
    double inertia = 0, load_error = 0;
    for (const ShearRow& row : rows) {
      if (row.shearing == 0) continue;
      inertia = std::max(inertia, std::abs(row.force_upper - row.force_lower));
      load_error = std::max(load_error, std::abs(row.normal_stress / wanted - 1));
    }
    notes[prefix + "inertia_share"] = {inertia / (r.peak_stress * area()), "1"};
    notes[prefix + "load_error"] = {load_error, "1"};
  }
  const auto add_line = [&](const std::string& prefix, const std::optional<MohrCoulombLine>& line) {
    if (!line) return;
    results[prefix + "cohesion"] = {line->cohesion, "Pa"};
    results[prefix + "friction_angle"] = {180 / std::numbers::pi * line->friction_angle, "deg"};
    results[prefix + "line_misfit"] = {line->largest_misfit, "Pa"};
  };
  add_line("", fit_mohr_coulomb(normal, shear));
  add_line("remaining_area_", fit_mohr_coulomb(remaining_normal, remaining_shear));
}

std::map<std::string, Quantity> DirectShear::result_names() const {
  std::map<std::string, Quantity> names;
  for (const double normal : rig_.normal_stresses) {
    const std::string prefix = fmt::format("normal_{:g}_kpa_", 1e-3 * normal);
    for (const char* stress :
         {"peak_stress", "yield_stress", "stress_on_plane", "yield_stress_on_remaining_area"})
      names[prefix + stress] = {0, "Pa"};
    names[prefix + "strain_at_peak"] = {0, "1"};
    names[prefix + "height_change"] = {0, "m"};
  }
  if (rig_.normal_stresses.size() < 2) return names;
  for (const std::string prefix : {"", "remaining_area_"}) {
    names[prefix + "cohesion"] = names[prefix + "line_misfit"] = {0, "Pa"};
    names[prefix + "friction_angle"] = {0, "deg"};
  }
  return names;
}

std::vector<SpecimenCurve> DirectShear::curve_names() const {
  std::vector<SpecimenCurve> curves;
  for (const double normal : rig_.normal_stresses)
    curves.push_back({fmt::format("normal_{:g}_kpa_shear", 1e-3 * normal),
                      "1",
                      "Pa",
                      "shear strain",
                      "shear stress",
                      {},
                      {}});
  return curves;
}

std::vector<SpecimenCurve> DirectShear::curves() const {
  std::vector<SpecimenCurve> curves = curve_names();
  for (std::size_t test = 0; test < tests(); ++test)
    for (const ShearRow& row : rows_[test]) {
      if (row.shearing == 0) continue;
      curves[test].x.push_back(row.shear_strain);
      curves[test].y.push_back(row.shear_stress);
    }
  return curves;
}

void DirectShear::save(h5::Group& group) const {
  save_rows(group, rows_);
  const std::vector<double> state{displacement_, height_, start_height_, speed_};
  group.write("state", std::span<const double>(state));
}

void DirectShear::load(const h5::Group& group) {
  load_rows(group, rows_);
  const std::vector<double> state = h5::read_checked(group, "state", 4);
  displacement_ = state[0];
  height_ = state[1];
  start_height_ = state[2];
  speed_ = state[3];
}

}  // namespace tuft::rigs

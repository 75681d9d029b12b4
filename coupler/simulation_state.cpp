// What Simulation tells about itself, and its state in checkpoints.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "coupler/carpet_terms.h"
#include "coupler/simulation.h"

namespace tuft::coupler {
namespace {

std::pair<std::size_t, double> fastest(std::span<const double> vx, std::span<const double> vy,
                                       std::span<const double> vz) {
  std::pair<std::size_t, double> result{0, 0.0};
  for (std::size_t i = 0; i < vx.size(); ++i) {
    const double squared = vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i];
    if (!(squared <= result.second)) result = {i, squared};
    if (std::isnan(squared)) break;
  }
  return {result.first, std::sqrt(result.second)};
}

void write_components(h5::Group& group, const std::string& name, const Vec3Array& values) {
  group.write(name + "_x", std::span<const double>(values.x));
  group.write(name + "_y", std::span<const double>(values.y));
  group.write(name + "_z", std::span<const double>(values.z));
}

Vec3Array read_components(const h5::Group& group, const std::string& name) {
  return {group.read_doubles(name + "_x"), group.read_doubles(name + "_y"), group.read_doubles(name + "_z")};
}

double highest(const ParticleView& points, double x, double y, double reach, bool with_radius) {
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = points.radius[i];
    if (points.is_expelled(i)) continue;
    if (std::hypot(points.x[i] - x, points.y[i] - y) > reach + (with_radius ? r : 0)) continue;
    top = std::max(top, points.z[i] + points.radius_upwards(i));
  }
  return top;
}

}  // namespace

std::string Simulation::describe_fastest() const {
  const ParticleView p = parts_.infill->particles();
  const fe::NodeView n = parts_.carpet->nodes();
  const auto particle = fastest(p.vx, p.vy, p.vz);
  const auto node = fastest(n.vx, n.vy, n.vz);
  return fmt::format("fastest particle {} ({:.3g} m/s), fastest carpet node {} ({:.3g} m/s)", particle.first,
                     particle.second, node.first, node.second);
}

double Simulation::highest_infill(double x, double y, double radius) const {
  return highest(parts_.infill->particles(), x, y, radius, true);
}

double Simulation::highest_carpet(double x, double y, double radius) const {
  return highest(node_points(parts_.carpet->nodes()), x, y, radius, false);
}

double Simulation::carpet_balance() const {
  return parts_.carpet->energy().balance();
}

double Simulation::infill_balance() const {
  const InfillEnergy e = parts_.infill->energy();
  return e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping + e.expelled + e.let_go -
         e.contact_work;
}

Simulation::Residuals Simulation::residuals() const {
  Residuals r;
  r.carpet = carpet_balance_ - carpet_reference_;
  r.infill = infill_balance_ - infill_reference_;
  r.contact_and_bodies = ledger_.imbalance() - r.carpet - r.infill;
  return r;
}

EnergyTerms Simulation::energy_terms() const {
  const fe::CarpetEnergy carpet = parts_.carpet->energy();
  const InfillEnergy infill = parts_.infill->energy();
  ContactEnergy contact = particle_shell_.energy();
  contact += particle_body_.energy();
  contact += node_body_.energy();
  EnergyTerms terms = terms_of(carpet);
  terms.kinetic_infill = infill.kinetic;
  terms.kinetic_bodies = body_kinetic_;
  terms.stored_infill = infill.stored;
  terms.dissipated_infill = infill.dissipated;
  terms.contact_elastic = contact.elastic;
  terms.contact_damping = contact.damped;
  terms.contact_friction = contact.friction;
  terms.gravity_potential += infill.gravity_potential + body_potential_;
  terms.damping += infill.damping + body_damping_;
  terms.expelled = infill.expelled;
  terms.conditioning = infill.let_go;
  // Between the parts contact is no work from outside; what it has released is.
  terms.external_work = external_work_ + contact.released + parts_.carpet->grips().work;
  return terms;
}

void Simulation::save(h5::Group& group) {
  const std::vector<double> numbers{time_,
                                    start_time_,
                                    body_kinetic_,
                                    body_potential_,
                                    external_work_,
                                    momentum_error_,
                                    largest_exchange_,
                                    largest_imbalance_,
                                    carpet_reference_,
                                    infill_reference_,
                                    referenced_ ? 1.0 : 0.0,
                                    body_damping_,
                                    pending_external_,
                                    pending_damping_,
                                    plan_.window,
                                    double(plan_.windows),
                                    double(plan_.carpet_substeps),
                                    double(plan_.infill_substeps),
                                    double(plan_.carpet_subcycle),
                                    carpet_balance_,
                                    infill_balance_};
  group.write("numbers", std::span<const double>(numbers));
  group.write_scalar("bears_longer_steps", static_cast<std::uint64_t>(bears_longer_steps_));
  group.write_scalar("windows", windows_);
  group.write_scalar("sheets_hold", sheets_hold_);
  group.write_scalar("sheets_failed", static_cast<std::uint64_t>(sheets_failed_));
  group.write_scalar("searches", searches_);
  group.write_scalar("reference_valid", static_cast<std::uint64_t>(reference_.valid ? 1 : 0));
  std::vector<double> bodies;
  for (const RigidBody& b : parts_.bodies) {
    for (int axis = 0; axis < 3; ++axis) bodies.push_back(b.position[axis]);
    for (int axis = 0; axis < 3; ++axis) bodies.push_back(b.velocity[axis]);
    bodies.push_back(b.present ? 1.0 : 0.0);
    for (int axis = 0; axis < 3; ++axis) bodies.push_back(b.drive[axis]);
    for (int axis = 0; axis < 3; ++axis) bodies.push_back(b.load[axis]);
  }
  group.write("bodies", std::span<const double>(bodies));
  if (reference_.valid) {
    auto reference = group.create_group("reference");
    write_components(reference, "particles", reference_.particles);
    write_components(reference, "nodes", reference_.nodes);
    write_components(reference, "bodies", reference_.bodies);
  }
  group.write_scalar("windowed", static_cast<std::uint64_t>(windowed_ ? 1 : 0));
  if (windowed_) {
    auto window = group.create_group("window");
    write_components(window, "position", window_position_);
    write_components(window, "velocity", window_velocity_);
    write_components(window, "spin", window_spin_);
  }
  auto carpet = group.create_group("carpet");
  parts_.carpet->save(carpet);
  auto infill = group.create_group("infill");
  parts_.infill->save(infill);
  auto shell = group.create_group("particle_shell");
  particle_shell_.save(shell);
  auto body = group.create_group("particle_body");
  particle_body_.save(body);
  auto node = group.create_group("node_body");
  node_body_.save(node);
  auto ledger = group.create_group("ledger");
  ledger_.save(ledger);
}

void Simulation::load(const h5::Group& group) {
  const std::vector<double> numbers = group.read_doubles("numbers");
  time_ = numbers.at(0);
  start_time_ = numbers.at(1);
  body_kinetic_ = numbers.at(2);
  body_potential_ = numbers.at(3);
  external_work_ = numbers.at(4);
  momentum_error_ = numbers.at(5);
  largest_exchange_ = numbers.at(6);
  largest_imbalance_ = numbers.at(7);
  carpet_reference_ = numbers.at(8);
  infill_reference_ = numbers.at(9);
  referenced_ = numbers.at(10) != 0;
  body_damping_ = numbers.at(11);
  pending_external_ = numbers.at(12);
  pending_damping_ = numbers.at(13);
  const auto count = [&](std::size_t k) { return static_cast<int>(numbers.at(k)); };
  plan_ = {count(15), count(16), count(17), numbers.at(14), count(18)};
  carpet_balance_ = numbers.at(19);
  infill_balance_ = numbers.at(20);
  bears_longer_steps_ = static_cast<int>(group.read_count("bears_longer_steps"));
  windows_ = group.read_count("windows");
  sheets_hold_ = group.has("sheets_hold") ? group.read_double("sheets_hold") : -1;
  sheets_failed_ = group.has("sheets_failed") ? group.read_count("sheets_failed") : 0;
  searches_ = group.read_count("searches");
  const std::vector<double> bodies = group.read_doubles("bodies");
  constexpr std::size_t body_numbers = 13;
  if (bodies.size() != body_numbers * parts_.bodies.size())
    throw_run_error("checkpoint holds {} bodies, the scene has {}", bodies.size() / body_numbers,
                    parts_.bodies.size());
  for (std::size_t b = 0; b < parts_.bodies.size(); ++b) {
    const double* v = &bodies[body_numbers * b];
    parts_.bodies[b].position = Vec3(v[0], v[1], v[2]);
    parts_.bodies[b].velocity = Vec3(v[3], v[4], v[5]);
    parts_.bodies[b].present = v[6] != 0;
    parts_.bodies[b].drive = Vec3(v[7], v[8], v[9]);
    parts_.bodies[b].load = Vec3(v[10], v[11], v[12]);
  }
  parts_.carpet->load(group.open_group("carpet"));
  parts_.infill->load(group.open_group("infill"));
  expelled_ = parts_.infill->expelled().particles;
  particle_shell_.load(group.open_group("particle_shell"));
  eroded_ = parts_.carpet->eroded_count();
  if (eroded_ > 0) particle_shell_.leave_out(parts_.carpet->eroded());
  particle_body_.load(group.open_group("particle_body"));
  node_body_.load(group.open_group("node_body"));
  ledger_.load(group.open_group("ledger"));
  windowed_ = group.read_count("windowed") != 0;
  if (windowed_) {
    window_position_ = read_components(group.open_group("window"), "position");
    window_velocity_ = read_components(group.open_group("window"), "velocity");
    window_spin_ = read_components(group.open_group("window"), "spin");
  }
  if (group.read_count("reference_valid") == 0) return;
  const auto reference = group.open_group("reference");
  reference_ = {read_components(reference, "particles"), read_components(reference, "nodes"),
                read_components(reference, "bodies"), true};
  // The candidate lists are made again from where everything stood when they were made first, so that
  // contacts are evaluated and summed in the same order as if the run had never stopped.
  ParticleView particles = parts_.infill->particles();
  particles.x = reference_.particles.x;
  particles.y = reference_.particles.y;
  particles.z = reference_.particles.z;
  fe::NodeView nodes = parts_.carpet->nodes();
  nodes.x = reference_.nodes.x;
  nodes.y = reference_.nodes.y;
  nodes.z = reference_.nodes.z;
  std::vector<RigidBody> now = parts_.bodies;
  for (std::size_t b = 0; b < now.size(); ++b) parts_.bodies[b].position = reference_.bodies[b];
  const std::uint64_t searches = searches_;
  search(particles, nodes);
  searches_ = searches;
  parts_.bodies = std::move(now);
}

}  // namespace tuft::coupler

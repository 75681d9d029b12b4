// State of a Simulation in checkpoints.
#include <limits>
#include <string>

#include "core/checkpoint_values.h"
#include "coupler/simulation.h"

namespace tuft::coupler {
namespace {

constexpr std::size_t body_numbers = 13;
constexpr double most_steps = std::numeric_limits<int>::max();

void write_components(h5::Group& group, const std::string& name, const Vec3Array& values) {
  group.write(name + "_x", std::span<const double>(values.x));
  group.write(name + "_y", std::span<const double>(values.y));
  group.write(name + "_z", std::span<const double>(values.z));
}

/// Saves a part under a name of its own.
template <class Part>
void save_part(h5::Group& group, const char* name, Part& part) {
  h5::Group own = group.create_group(name);
  part.save(own);
}

}  // namespace

void Simulation::save_numbers(h5::Group& group) const {
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
}

void Simulation::load_numbers(const h5::Group& group) {
  const std::vector<double> n = h5::read_checked(group, "numbers", 21);
  time_ = n[0], start_time_ = n[1];
  body_kinetic_ = n[2], body_potential_ = n[3], external_work_ = n[4];
  momentum_error_ = n[5], largest_exchange_ = n[6], largest_imbalance_ = n[7];
  carpet_reference_ = n[8], infill_reference_ = n[9], referenced_ = n[10] != 0;
  body_damping_ = n[11], pending_external_ = n[12], pending_damping_ = n[13];
  h5::check_value(group, "numbers", 14, n[14], h5::not_negative);
  const auto count = [&](std::size_t k) {
    h5::check_whole(group, "numbers", k, n[k], {1, most_steps});
    return static_cast<int>(n[k]);
  };
  plan_ = {count(15), count(16), count(17), n[14], count(18)};
  carpet_balance_ = n[19], infill_balance_ = n[20];
  bears_longer_steps_ = static_cast<int>(h5::read_count(group, "bears_longer_steps", most_steps));
  windows_ = h5::read_count(group, "windows");
  // Infinite where sheets separate nothing.
  sheets_hold_ = group.has("sheets_hold")
                     ? h5::read_number(group, "sheets_hold", {h5::finite.least, h5::unbounded})
                     : -1;
  sheets_failed_ = group.has("sheets_failed") ? h5::read_count(group, "sheets_failed") : 0;
  searches_ = h5::read_count(group, "searches");
}

void Simulation::save_bodies(h5::Group& group) const {
  std::vector<double> bodies;
  for (const RigidBody& b : parts_.bodies) {
    for (int axis = 0; axis < 3; ++axis) bodies.push_back(b.position[axis]);
    for (int axis = 0; axis < 3; ++axis) bodies.push_back(b.velocity[axis]);
    bodies.push_back(b.present ? 1.0 : 0.0);
    for (int axis = 0; axis < 3; ++axis) bodies.push_back(b.drive[axis]);
    for (int axis = 0; axis < 3; ++axis) bodies.push_back(b.load[axis]);
  }
  group.write("bodies", std::span<const double>(bodies));
}

void Simulation::load_bodies(const h5::Group& group) {
  const std::vector<double> bodies = h5::read_checked(group, "bodies", body_numbers * parts_.bodies.size());
  for (std::size_t b = 0; b < parts_.bodies.size(); ++b) {
    const double* v = &bodies[body_numbers * b];
    parts_.bodies[b].position = Vec3(v[0], v[1], v[2]);
    parts_.bodies[b].velocity = Vec3(v[3], v[4], v[5]);
    parts_.bodies[b].present = v[6] != 0;
    parts_.bodies[b].drive = Vec3(v[7], v[8], v[9]);
    parts_.bodies[b].load = Vec3(v[10], v[11], v[12]);
  }
}

void Simulation::save(h5::Group& group) {
  save_numbers(group);
  save_bodies(group);
  group.write_scalar("reference_valid", static_cast<std::uint64_t>(reference_.valid ? 1 : 0));
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
  save_part(group, "carpet", *parts_.carpet);
  save_part(group, "infill", *parts_.infill);
  save_part(group, "particle_shell", particle_shell_);
  save_part(group, "particle_body", particle_body_);
  save_part(group, "node_body", node_body_);
  save_part(group, "ledger", ledger_);
}

void Simulation::load(const h5::Group& group) {
  load_numbers(group);
  load_bodies(group);
  parts_.carpet->load(group.open_group("carpet"));
  parts_.infill->load(group.open_group("infill"));
  expelled_ = parts_.infill->expelled().particles;
  particle_shell_.load(group.open_group("particle_shell"));
  eroded_ = parts_.carpet->eroded_count();
  if (eroded_ > 0) particle_shell_.leave_out(parts_.carpet->eroded());
  particle_body_.load(group.open_group("particle_body"), parts_.bodies.size());
  node_body_.load(group.open_group("node_body"), parts_.bodies.size());
  ledger_.load(group.open_group("ledger"));
  windowed_ = h5::read_flag(group, "windowed");
  if (windowed_) {
    const h5::Group window = group.open_group("window");
    const std::size_t particles = parts_.infill->particles().size();
    window_position_ = h5::read_vectors(window, "position", particles);
    window_velocity_ = h5::read_vectors(window, "velocity", particles);
    window_spin_ = h5::read_vectors(window, "spin", particles);
  }
  if (h5::read_flag(group, "reference_valid")) search_as_before(group.open_group("reference"));
}

/// The candidate lists are made again from where everything stood when they were made first, so that contacts
/// are evaluated and summed in the same order as if the run had never stopped.
void Simulation::search_as_before(const h5::Group& reference) {
  ParticleView particles = parts_.infill->particles();
  fe::NodeView nodes = parts_.carpet->nodes();
  reference_ = {h5::read_vectors(reference, "particles", particles.size()),
                h5::read_vectors(reference, "nodes", nodes.x.size()),
                h5::read_vectors(reference, "bodies", parts_.bodies.size()), true};
  particles.x = reference_.particles.x;
  particles.y = reference_.particles.y;
  particles.z = reference_.particles.z;
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

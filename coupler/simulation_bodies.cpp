// Bodies of a Simulation: put in, taken out, driven, loaded, moved.
#include <utility>

#include "core/error.h"
#include "coupler/simulation.h"

namespace tuft::coupler {

void Simulation::release_body(std::size_t index, const Vec3& position, const Vec3& velocity) {
  RigidBody& body = parts_.bodies.at(index);
  if (body.present) throw_run_error("body {} is already in the simulation", body.name);
  body.position = position;
  body.velocity = velocity;
  body.present = true;
  const double kinetic = 0.5 * body.mass * velocity.squaredNorm();
  const double potential = -body.mass * parts_.gravity.dot(position);
  body_kinetic_ += kinetic;
  body_potential_ += potential;
  external_work_ += kinetic + potential;
  reference_.valid = false;
}

void Simulation::remove_body(std::size_t index) {
  RigidBody& body = parts_.bodies.at(index);
  if (!body.is_fixed()) throw_run_error("body {} has momentum and cannot be taken away", body.name);
  const auto number = static_cast<Index>(index);
  particle_body_.let_go(number, contact_view(), parts_.bodies, release_at(time_));
  if (has_carpet())
    node_body_.let_go(number, node_points(parts_.carpet->nodes()), parts_.bodies, release_at(time_));
  body.present = false;
  body.velocity = body.drive = Vec3::Zero();
  reference_.valid = false;
}

void Simulation::drive_body(std::size_t index, const Vec3& velocity) {
  RigidBody& body = parts_.bodies.at(index);
  if (!body.driven) throw_run_error("body {} is not driven", body.name);
  body.drive = velocity;
}

void Simulation::drive_carpet(std::span<const std::size_t> nodes, const Vec3& velocity) {
  for (const std::size_t node : nodes) parts_.carpet->drive(node, velocity);
}

void Simulation::load_body(std::size_t index, const Vec3& force) {
  RigidBody& body = parts_.bodies.at(index);
  if (body.is_fixed()) throw_run_error("body {} has no mass that a load could move", body.name);
  body.load = force;
}

void Simulation::advance_bodies(Vec3& taken, double& scale) {
  const ScopedPhase phase(timers_, Phase::rig);
  body_kinetic_ = body_potential_ = 0;
  external_work_ += std::exchange(pending_external_, 0);
  body_damping_ += std::exchange(pending_damping_, 0);
  for (std::size_t b = 0; b < parts_.bodies.size(); ++b) {
    RigidBody& body = parts_.bodies[b];
    if (!body.present) continue;
    const double potential = body.is_fixed() ? 0 : -body.mass * parts_.gravity.dot(body.position);
    const BodyPush push{body_impulses_.impulse[b], body_impulses_.until_now[b]};
    const BodyAdvance advance = advance_body(body, push, parts_.gravity, plan_.window);
    body_kinetic_ += advance.kinetic;
    body_potential_ += potential;
    external_work_ += advance.external.until_now;
    pending_external_ += advance.external.whole - advance.external.until_now;
    body_damping_ += advance.damped.until_now;
    pending_damping_ += advance.damped.whole - advance.damped.until_now;
    taken += advance.impulse_taken;
    scale += body_impulses_.impulse[b].cwiseAbs().sum();
    interval_impulse_[b] += body_impulses_.measured[b];
  }
}

}  // namespace tuft::coupler

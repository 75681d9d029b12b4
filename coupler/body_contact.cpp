#include "coupler/body_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "coupler/contact_state_io.h"

namespace tuft::coupler {
namespace {

constexpr double tangential_ratio = ContactParameters{}.tangential_ratio;

SurfacePoint surface_point(const RigidBody& body, const Vec3& point, double ahead) {
  const Vec3 relative = point - body.position - ahead * body.velocity;
  return std::visit([&](const auto& shape) { return distance_to(shape, relative); }, body.shape);
}

}  // namespace

void BodyContact::search(const ParticleView& points, const std::vector<RigidBody>& bodies, double skin,
                         bool keep_overlap, std::span<const std::uint8_t> skip) {
  std::vector<PairKey> keys;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!skip.empty() && skip[i] != 0) continue;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (!bodies[b].present) continue;
      if (surface_point(bodies[b], points.position(i), 0).distance < points.radius[i] + skin)
        keys.push_back(make_key(static_cast<Index>(i), static_cast<Index>(b)));
    }
  }
  histories_ = carry_over(keys_, histories_, keys);
  keys_ = std::move(keys);
  results_.assign(keys_.size(), {});
  if (!searched_ && keep_overlap) {
    for (std::size_t g = 0; g < keys_.size(); ++g) {
      const Index i = key_point(keys_[g]);
      const double overlap =
          points.radius[i] - surface_point(bodies[key_other(keys_[g])], points.position(i), 0).distance;
      histories_[g].offset = std::sqrt(settings_.stiffness[i]) * std::max(0.0, overlap);
      // Rounding of a lattice against a wall is not an overlap.
      if (overlap > 1e-9 * points.radius[i]) ++initial_overlap_.pairs;
      initial_overlap_.largest = std::max(initial_overlap_.largest, overlap);
    }
  }
  searched_ = true;
}

BodyContact::Result BodyContact::evaluate_pair(std::size_t pair, const ParticleView& points,
                                               const std::vector<RigidBody>& bodies, double ahead, double dt,
                                               double release, double release_before) {
  Result result;
  ContactHistory& history = histories_[pair];
  const Index i = key_point(keys_[pair]);
  const RigidBody& body = bodies[key_other(keys_[pair])];
  const ContactParameters parameters{settings_.stiffness[i], settings_.damping_ratio[i], tangential_ratio,
                                     body.friction.value_or(settings_.friction[i])};
  const SurfacePoint surface = surface_point(body, points.position(i), ahead);
  const double overlap = points.radius[i] - surface.distance;
  ContactKinematics kinematics;
  const double root = std::sqrt(parameters.stiffness);
  kinematics.overlap = overlap - history.offset / root * release;
  if (!(kinematics.overlap > 0)) {
    result.contact.friction = release_spring(history);
    if (overlap <= 0) history.offset = 0;
    return result;
  }
  kinematics.normal = surface.normal;
  result.arm = -points.radius[i] * surface.normal;
  kinematics.velocity = points.velocity(i) + points.spin(i).cross(result.arm) - body.velocity;
  kinematics.closing = -kinematics.velocity.dot(kinematics.normal);
  kinematics.effective_mass = 1.0 / (1.0 / points.mass[i] + body.inverse_mass());
  result.contact = compute_contact_force(parameters, kinematics, dt, history);
  result.released = release_work(parameters.stiffness, kinematics.overlap,
                                 history.offset / root * (release_before - release), kinematics.closing * dt);
  result.touching = true;
  return result;
}

void BodyContact::evaluate(const ParticleView& points, const std::vector<RigidBody>& bodies, double ahead,
                           double dt, double release, double release_before, double weight, Vec3Array& linear,
                           Vec3Array* angular, BodyImpulses& on_bodies) {
  const std::size_t pairs = keys_.size();
#pragma omp parallel for schedule(static) if (pairs > 1024)
  for (std::size_t g = 0; g < pairs; ++g)
    results_[g] = evaluate_pair(g, points, bodies, ahead, dt, release, release_before);

  // Serial, so that the order of additions does not depend on the threads.
  energy_.elastic = 0;
  for (std::size_t g = 0; g < pairs; ++g) {
    const Result& r = results_[g];
    energy_.friction += r.contact.friction;
    if (!r.touching) continue;
    energy_.elastic += r.contact.elastic;
    energy_.damped += r.contact.damped;
    energy_.released += r.released;
    const Index i = key_point(keys_[g]);
    linear.add(i, weight * r.contact.force);
    if (angular != nullptr) angular->add(i, r.arm.cross(r.contact.force * dt));
    on_bodies.impulse[key_other(keys_[g])] -= r.contact.force * dt;
  }
}

void BodyContact::let_go(Index body, const ParticleView& points, const std::vector<RigidBody>& bodies,
                         double release) {
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    if (key_other(keys_[g]) != body) continue;
    const Index i = key_point(keys_[g]);
    ContactHistory& history = histories_[g];
    const double stiffness = settings_.stiffness[i],
                 distance =
                     surface_point(bodies[static_cast<std::size_t>(body)], points.position(i), 0).distance,
                 overlap = points.radius[i] - distance - history.offset / std::sqrt(stiffness) * release;
    if (overlap > 0) energy_.damped += 0.5 * stiffness * overlap * overlap;
    energy_.friction += release_spring(history);
  }
}

double BodyContact::largest_frequency_squared(std::span<const double> mass) const {
  double largest = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) largest = std::max(largest, settings_.stiffness[i] / mass[i]);
  return largest;
}

double BodyContact::stable_step(std::span<const double> mass) const {
  // Of each point the bodies near it; before the first search it may be any three.
  std::vector<int> near(mass.size(), searched_ ? 0 : 3);
  for (const PairKey key : keys_) ++near[static_cast<std::size_t>(key_point(key))];
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const double zeta = settings_.damping_ratio[i];
    const double stiffness = settings_.stiffness[i] * (1 + tangential_ratio * std::max(0, near[i] - 1));
    smallest = std::min(smallest, 2 * std::sqrt(mass[i] / stiffness) * (std::sqrt(1 + zeta * zeta) - zeta));
  }
  return smallest;
}

void BodyContact::save(h5::Group& group) const {
  save_pairs(group, keys_, histories_);
  save_energy(group, energy_);
  group.write_scalar("initial_overlap_pairs", static_cast<std::uint64_t>(initial_overlap_.pairs));
  group.write_scalar("initial_overlap_largest", initial_overlap_.largest);
}

void BodyContact::load(const h5::Group& group) {
  load_pairs(group, keys_, histories_);
  energy_ = load_energy(group);
  initial_overlap_.pairs = group.read_count("initial_overlap_pairs");
  initial_overlap_.largest = group.read_double("initial_overlap_largest");
  searched_ = true;
}

}  // namespace tuft::coupler

#include "coupler/body_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/checkpoint_values.h"
#include "core/parallel.h"
#include "coupler/contact_state_io.h"

namespace tuft::coupler {
namespace {

constexpr double tangential_ratio = ContactParameters{}.tangential_ratio;

/// Points that come within `skin` of a body, with it, in order. skip: of points, or empty.
std::vector<PairKey> near_pairs(const ParticleView& points, const std::vector<RigidBody>& bodies, double skin,
                                std::span<const std::uint8_t> skip) {
  constexpr std::size_t together = 1024;
  std::vector<std::vector<PairKey>> of_part((points.size() + together - 1) / together);
  parallel_for(of_part.size(), [&](std::size_t part) {
    for (std::size_t i = part * together; i < std::min(points.size(), (part + 1) * together); ++i) {
      if (!skip.empty() && skip[i] != 0) continue;
      const double near = points.largest_radius(i) + skin;
      for (std::size_t b = 0; b < bodies.size(); ++b)
        if (bodies[b].present && bodies[b].surface_from(points.position(i)).distance < near)
          of_part[part].push_back(make_key(static_cast<Index>(i), static_cast<Index>(b)));
    }
  });
  std::vector<PairKey> keys;
  for (const std::vector<PairKey>& some : of_part) keys.insert(keys.end(), some.begin(), some.end());
  return keys;
}

bool all_stiffen(const std::vector<NormalSpring>& springs) {
  return std::all_of(springs.begin(), springs.end(),
                     [](const NormalSpring& spring) { return spring.stiffening > 0; });
}

}  // namespace

BodyContact::BodyContact(BodyContactSettings settings)
    : settings_(std::move(settings)),
      all_stiffen_(all_stiffen(settings_.spring) && all_stiffen(settings_.wall_spring)) {}

void BodyContact::search(const ParticleView& points, const std::vector<RigidBody>& bodies, double skin,
                         bool keep_overlap, std::span<const std::uint8_t> skip) {
  std::vector<PairKey> keys = near_pairs(points, bodies, skin, skip);
  histories_ = carry_over(keys_, histories_, keys);
  results_ = carry_over(keys_, results_, keys);
  keys_ = std::move(keys);
  if (!searched_ && keep_overlap) {
    for (std::size_t g = 0; g < keys_.size(); ++g) {
      const Index i = key_point(keys_[g]);
      const RigidBody& body = bodies[key_other(keys_[g])];
      const double overlap = overlap_of(i, body, points);
      histories_[g].offset = std::sqrt(spring_of(i, body).stiffness) * std::max(0.0, overlap);
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
  const ContactParameters parameters{spring_of(i, body), settings_.damping_ratio[i], tangential_ratio,
                                     friction_of(i, body)};
  const SurfacePoint surface = surface_of(body, points, static_cast<std::size_t>(i), ahead);
  const double radius = points.radius_along(static_cast<std::size_t>(i), surface.normal);
  const double overlap = radius - surface.distance;
  ContactKinematics kinematics;
  const double root = std::sqrt(parameters.spring.stiffness);
  kinematics.overlap = overlap - history.offset / root * release;
  if (!(kinematics.overlap > 0)) {
    result.contact.friction = release_spring(history);
    if (overlap <= 0) history.offset = 0;
    return result;
  }
  kinematics.normal = surface.normal;
  result.arm = -radius * surface.normal;
  kinematics.velocity = points.velocity(i) + points.spin(i).cross(result.arm) - body.velocity;
  kinematics.closing = -kinematics.velocity.dot(kinematics.normal);
  kinematics.effective_mass = 1.0 / (1.0 / points.mass[i] + body.inverse_mass());
  result.contact = compute_contact_force(parameters, kinematics, dt, history);
  result.released = release_work(parameters.spring, kinematics.overlap,
                                 history.offset / root * (release_before - release), kinematics.closing * dt);
  result.touching = true;
  return result;
}

double BodyContact::overlap_of(Index point, const RigidBody& body, const ParticleView& points) const {
  const SurfacePoint surface = surface_of(body, points, static_cast<std::size_t>(point));
  return points.radius_along(static_cast<std::size_t>(point), surface.normal) - surface.distance;
}

void BodyContact::evaluate_kicked_pair(std::size_t pair, const ParticleView& points,
                                       const std::vector<RigidBody>& bodies, double dt, double release,
                                       double release_before) {
  const std::size_t entry = static_cast<std::size_t>(key_point(keys_[pair])) / points.kicks.group;
  const double length = points.kicks.length[entry];
  // At the start of a run there was none.
  const double since = points.kicks.since[entry] > 0 ? points.kicks.since[entry] : dt;
  Result& result = results_[pair];
  if (length == 0) {
    result.dt = result.weight = result.released = 0;
    result.contact.damped = result.contact.friction = 0;
    return;
  }
  // Offsets are let go evenly.
  const double before = std::min(1.0, release + (release_before - release) * since / dt);
  result = evaluate_pair(pair, points, bodies, 0, since, release, before);
  result.dt = result.weight = length;
  result.lag = points.kicks.lag[entry];
}

void BodyContact::sum_up(std::size_t pair, double dt, Vec3Array& linear, Vec3Array* angular,
                         Sums& sums) const {
  const Result& r = results_[pair];
  sums.energy.friction += r.contact.friction;
  if (!r.touching) return;
  sums.energy.elastic += r.contact.elastic;
  const auto body = static_cast<std::size_t>(key_other(keys_[pair]));
  sums.on_bodies.measured[body] -= r.contact.force * dt;
  if (r.dt == 0) return;  // not kicked
  sums.energy.damped += r.contact.damped;
  sums.energy.released += r.released;
  const Index i = key_point(keys_[pair]);
  linear.add(i, r.weight * r.contact.force);
  if (angular != nullptr) angular->add(i, r.arm.cross(r.contact.force * r.dt));
  sums.on_bodies.impulse[body] -= r.contact.force * r.dt;
  sums.on_bodies.until_now[body] -= r.contact.force * r.lag;
}

void BodyContact::evaluate(const ParticleView& points, const std::vector<RigidBody>& bodies, double ahead,
                           double dt, double release, double release_before, double weight, Vec3Array& linear,
                           Vec3Array* angular, BodyImpulses& on_bodies) {
  // Parts begin where a point does, so that no two add to the same one. They do not depend on the threads,
  // and neither does the order in which their sums are added.
  const std::size_t pairs = keys_.size(), parts = (pairs + sum_block - 1) / sum_block;
  const auto first_of = [&](std::size_t part) {
    std::size_t g = std::min(pairs, part * sum_block);
    while (g > 0 && g < pairs && key_point(keys_[g]) == key_point(keys_[g - 1])) ++g;
    return g;
  };
  part_sums_.resize(parts);
  for (Sums& sums : part_sums_) sums.energy = {}, sums.on_bodies.reset(bodies.size());
#pragma omp parallel for schedule(static) if (pairs > least_for_threads)
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t end = first_of(part + 1);
    for (std::size_t g = first_of(part); g < end; ++g) {
      if (!points.kicks.empty()) {
        evaluate_kicked_pair(g, points, bodies, dt, release, release_before);
      } else {
        results_[g] = evaluate_pair(g, points, bodies, ahead, dt, release, release_before);
        results_[g].weight = weight, results_[g].dt = dt, results_[g].lag = 0.5 * dt;
      }
      sum_up(g, dt, linear, angular, part_sums_[part]);
    }
  }
  energy_.elastic = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    const Sums& sums = part_sums_[part];
    energy_ += sums.energy;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      on_bodies.impulse[b] += sums.on_bodies.impulse[b];
      on_bodies.until_now[b] += sums.on_bodies.until_now[b];
      on_bodies.measured[b] += sums.on_bodies.measured[b];
    }
  }
}

void BodyContact::let_go(Index body, const ParticleView& points, const std::vector<RigidBody>& bodies,
                         double release) {
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    if (key_other(keys_[g]) != body) continue;
    const Index i = key_point(keys_[g]);
    ContactHistory& history = histories_[g];
    const NormalSpring& spring = spring_of(i, bodies[static_cast<std::size_t>(body)]);
    const double overlap = overlap_of(i, bodies[static_cast<std::size_t>(body)], points) -
                           history.offset / std::sqrt(spring.stiffness) * release;
    if (overlap > 0) energy_.damped += spring.energy(overlap);
    energy_.friction += release_spring(history);
  }
}

void BodyContact::replace_springs(std::vector<NormalSpring> springs, const ParticleView& points,
                                  const std::vector<RigidBody>& bodies, double release) {
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    const Index i = key_point(keys_[g]);
    const RigidBody& body = bodies[static_cast<std::size_t>(key_other(keys_[g]))];
    ContactHistory& history = histories_[g];
    const NormalSpring &old = spring_of(i, body), &now = springs[i];
    const double offset = history.offset / std::sqrt(old.stiffness);
    const double overlap = overlap_of(i, body, points) - offset * release;
    if (overlap > 0) energy_.damped += old.energy(overlap) - now.energy(overlap);
    history.offset = offset * std::sqrt(now.stiffness);
  }
  settings_.spring = std::move(springs);
  settings_.wall_spring.clear();
  all_stiffen_ = all_stiffen(settings_.spring);
}

void BodyContact::save(h5::Group& group) const {
  save_pairs(group, keys_, histories_);
  // What is not kicked holds them.
  std::vector<double> held;
  held.reserve(4 * results_.size());
  for (const Result& r : results_) {
    for (int axis = 0; axis < 3; ++axis) held.push_back(r.touching ? r.contact.force[axis] : 0.0);
    held.push_back(r.touching ? r.contact.elastic : 0.0);
  }
  group.write("held", std::span<const double>(held));
  save_energy(group, energy_);
  group.write_scalar("initial_overlap_pairs", static_cast<std::uint64_t>(initial_overlap_.pairs));
  group.write_scalar("initial_overlap_largest", initial_overlap_.largest);
  group.write_scalar("searched", static_cast<std::uint64_t>(searched_));
}

void BodyContact::load(const h5::Group& group, std::size_t bodies) {
  load_pairs(group, settings_.spring.size(), bodies, keys_, histories_);
  const std::vector<double> held = h5::read_checked(group, "held", 4 * keys_.size());
  results_.assign(keys_.size(), {});
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    Result& r = results_[g];
    r.contact.force = Vec3(held[4 * g], held[4 * g + 1], held[4 * g + 2]);
    r.contact.elastic = held[4 * g + 3];
    r.touching = r.contact.elastic > 0;
  }
  energy_ = load_energy(group);
  initial_overlap_.pairs = h5::read_count(group, "initial_overlap_pairs");
  initial_overlap_.largest = h5::read_number(group, "initial_overlap_largest");
  searched_ = h5::read_count(group, "searched") != 0;
}

}  // namespace tuft::coupler

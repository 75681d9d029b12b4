#include "coupler/body_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "coupler/contact_state_io.h"

namespace tuft::coupler {
namespace {

/// Pairs from which on other threads are called in.
constexpr std::size_t least_for_threads = 1024;

constexpr double tangential_ratio = ContactParameters{}.tangential_ratio;

SurfacePoint surface_point(const RigidBody& body, const Vec3& point, double ahead) {
  const Vec3 relative = point - body.position - ahead * body.velocity;
  return std::visit([&](const auto& shape) { return distance_to(shape, relative); }, body.shape);
}

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
        if (bodies[b].present && surface_point(bodies[b], points.position(i), 0).distance < near)
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
  keys_ = std::move(keys);
  results_.assign(keys_.size(), {});
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
  const SurfacePoint surface = surface_point(body, points.position(i), ahead);
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

double BodyContact::overlap_of(Index point, const RigidBody& body, const ParticleView& points) {
  const SurfacePoint surface = surface_point(body, points.position(point), 0);
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
}

void BodyContact::sum_up(std::size_t pair, Vec3Array& linear, Vec3Array* angular, ContactEnergy& energy,
                         Vec3* on_bodies) const {
  const Result& r = results_[pair];
  energy.friction += r.contact.friction;
  if (!r.touching) return;
  energy.elastic += r.contact.elastic;
  if (r.dt == 0) return;  // not kicked
  energy.damped += r.contact.damped;
  energy.released += r.released;
  const Index i = key_point(keys_[pair]);
  linear.add(i, r.weight * r.contact.force);
  if (angular != nullptr) angular->add(i, r.arm.cross(r.contact.force * r.dt));
  on_bodies[key_other(keys_[pair])] -= r.contact.force * r.dt;
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
  part_energy_.assign(parts, {});
  part_on_bodies_.assign(parts * bodies.size(), Vec3::Zero());
#pragma omp parallel for schedule(static) if (pairs > least_for_threads)
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t end = first_of(part + 1);
    for (std::size_t g = first_of(part); g < end; ++g) {
      if (!points.kicks.empty() && !bodies[key_other(keys_[g])].can_move()) {
        evaluate_kicked_pair(g, points, bodies, dt, release, release_before);
      } else {
        results_[g] = evaluate_pair(g, points, bodies, ahead, dt, release, release_before);
        results_[g].weight = weight, results_[g].dt = dt;
      }
      sum_up(g, linear, angular, part_energy_[part], &part_on_bodies_[part * bodies.size()]);
    }
  }
  energy_.elastic = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    energy_.elastic += part_energy_[part].elastic;
    energy_.friction += part_energy_[part].friction;
    energy_.damped += part_energy_[part].damped;
    energy_.released += part_energy_[part].released;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      on_bodies.impulse[b] += part_on_bodies_[part * bodies.size() + b];
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

double BodyContact::stiffness_apart(std::size_t point) const {
  // Nothing but the pairs says how far a spring that stiffens is pressed in.
  const auto most = [this](const NormalSpring& spring) {
    return !(spring.stiffening > 0) ? spring.stiffness : searched_ ? 0 : spring.tangent(spring.end);
  };
  const double stiffness = most(settings_.spring[point]);
  return settings_.wall_spring.empty() ? stiffness : std::max(stiffness, most(settings_.wall_spring[point]));
}

double BodyContact::coming_stiffness(PairKey key, const ParticleView& points,
                                     const std::vector<RigidBody>& bodies, double horizon) const {
  const Index i = key_point(key);
  const RigidBody& body = bodies[static_cast<std::size_t>(key_other(key))];
  const NormalSpring& spring = spring_of(i, body);
  if (!(spring.stiffening > 0)) return 0;
  const SurfacePoint surface = surface_point(body, points.position(i), 0);
  const double closing = -(points.velocity(i) - body.velocity).dot(surface.normal);
  const double overlap = points.radius_along(static_cast<std::size_t>(i), surface.normal) - surface.distance +
                         horizon * std::max(0.0, closing);
  return overlap > 0 ? spring.tangent(overlap) : 0;
}

double BodyContact::step_under(double stiffness, std::size_t point, int near, const ParticleView& points,
                               bool with_dashpots) const {
  double share = 1;
  if (with_dashpots) {
    const double zeta = settings_.damping_ratio[point];
    stiffness *= 1 + tangential_ratio * std::max(0, near - 1);
    share = std::sqrt(1 + zeta * zeta) - zeta;
  }
  if (!(stiffness > 0)) return std::numeric_limits<double>::infinity();
  return 2 * std::sqrt(points.mass[point] / stiffness) * share;
}

template <class Take>
void BodyContact::for_near_points(const ParticleView& points, const std::vector<RigidBody>& bodies,
                                  double horizon, bool with_dashpots, Take&& take) const {
  const std::size_t pairs = keys_.size();
#pragma omp parallel for schedule(static) if (pairs > least_for_threads)
  for (std::size_t first = 0; first < pairs; ++first) {  // sorted by point: each goes with its first pair
    const Index i = key_point(keys_[first]);
    if (first > 0 && key_point(keys_[first - 1]) == i) continue;
    double k = stiffness_apart(static_cast<std::size_t>(i));
    bool beside_moving = false;
    std::size_t g = first;
    for (; g < pairs && key_point(keys_[g]) == i; ++g) {
      k = std::max(k, coming_stiffness(keys_[g], points, bodies, horizon));
      beside_moving = beside_moving || bodies[static_cast<std::size_t>(key_other(keys_[g]))].can_move();
    }
    const auto point = static_cast<std::size_t>(i);
    take(first, point, step_under(k, point, static_cast<int>(g - first), points, with_dashpots),
         beside_moving);
  }
}

std::vector<double> BodyContact::stable_steps(const ParticleView& points,
                                              const std::vector<RigidBody>& bodies, double horizon,
                                              bool with_dashpots) const {
  std::vector<double> steps(points.size(), std::numeric_limits<double>::infinity());
  // Before the first search a point may be near any three bodies.
  if (!searched_ || !all_stiffen_)
    for (std::size_t i = 0; i < points.size(); ++i)
      steps[i] = step_under(stiffness_apart(i), i, searched_ ? 0 : 3, points, with_dashpots);
  for_near_points(points, bodies, horizon, with_dashpots,
                  [&](std::size_t, std::size_t i, double step, bool) { steps[i] = step; });
  return steps;
}

double BodyContact::least_stable_step(const ParticleView& points, const std::vector<RigidBody>& bodies,
                                      double horizon, bool with_dashpots) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double least = infinity;
  if (!searched_ || !all_stiffen_)
    for (std::size_t i = 0; i < points.size(); ++i)
      least = std::min(least, step_under(stiffness_apart(i), i, searched_ ? 0 : 3, points, with_dashpots));
  std::vector<double> near(keys_.size(), infinity);
  for_near_points(points, bodies, horizon, with_dashpots,
                  [&](std::size_t first, std::size_t, double step, bool) { near[first] = step; });
  for (const double step : near) least = std::min(least, step);
  return least;
}

void BodyContact::leave_near(std::vector<double>& steps) const {
  std::vector<double> near(steps.size(), std::numeric_limits<double>::infinity());
  for (const PairKey key : keys_) {
    const auto i = static_cast<std::size_t>(key_point(key));
    near[i] = steps[i];
  }
  steps = std::move(near);
}

void BodyContact::raise_rates(const ParticleView& points, const std::vector<RigidBody>& bodies,
                              double horizon, bool with_dashpots, std::vector<float>& rates) const {
  for_near_points(points, bodies, horizon, with_dashpots,
                  [&](std::size_t, std::size_t i, double step, bool beside_moving) {
                    const float rate =
                        beside_moving ? std::numeric_limits<float>::infinity() : static_cast<float>(1 / step);
                    rates[i] = std::max(rates[i], rate);
                  });
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

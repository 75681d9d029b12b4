#include "coupler/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "coupler/fastest.h"

namespace tuft::coupler {
namespace {

double largest_displacement(std::span<const double> x, std::span<const double> y, std::span<const double> z,
                            const Vec3Array& from) {
  return std::sqrt(largest_of(x.size(), [&](std::size_t i) {
    const double dx = x[i] - from.x[i], dy = y[i] - from.y[i], dz = z[i] - from.z[i];
    return dx * dx + dy * dy + dz * dz;
  }));
}

Vec3 carpet_impulse(const fe::Carpet& carpet) {
  return carpet.impulse_received() + carpet.impulse_to_clamps();
}

void copy(std::span<const double> from, std::vector<double>& to) {
  to.assign(from.begin(), from.end());
}

void zero(Vec3Array& values) {
  constexpr std::size_t share = 4096;
  const std::size_t count = values.size();
#pragma omp parallel for schedule(static) if (count > share)
  for (std::size_t part = 0; part < (count + share - 1) / share; ++part) {
    const auto first = static_cast<std::ptrdiff_t>(part * share);
    const auto length = static_cast<std::ptrdiff_t>(std::min(share, count - part * share));
    for (auto* component : {&values.x, &values.y, &values.z})
      std::fill_n(component->begin() + first, length, 0.0);
  }
}

/// Torques are for particles with spin alone.
void size_angular(const ParticleView& particles, ContactImpulses& impulses) {
  impulses.angular.assign(particles.has_spin() ? particles.size() : 0, 0.0);
}

}  // namespace

Simulation::Simulation(SimulationParts parts)
    : parts_(std::move(parts)),
      particle_shell_(parts_.carpet->mesh(), parts_.carpet->node_contact_stiffness(),
                      parts_.carpet->nodes().mass, parts_.particle_shell),
      particle_body_(parts_.particle_body),
      node_body_(parts_.node_body),
      ledger_(parts_.numerics.energy_error_limit, parts_.energy_scale),
      time_(parts_.time),
      start_time_(parts_.time) {
  const ParticleView particles = parts_.infill->particles();
  node_force_.assign(parts_.carpet->nodes().x.size(), 0.0);
  impulses_.linear.assign(particles.size(), 0.0);
  size_angular(particles, impulses_);
  body_impulses_.reset(parts_.bodies.size());
  interval_impulse_.assign(parts_.bodies.size(), Vec3::Zero());
  for (const RigidBody& body : parts_.bodies)
    if (!body.is_fixed() && body.present) body_kinetic_ += 0.5 * body.mass * body.velocity.squaredNorm();
}

void Simulation::set_damping(double carpet, double infill) {
  parts_.carpet->set_damping(carpet);
  parts_.infill->set_damping(infill);
}

void Simulation::replace_infill(std::unique_ptr<Infill> infill, std::vector<NormalSpring> body_springs) {
  const std::size_t before = parts_.infill->particles().size(), now = infill->particles().size();
  if (before != now) throw_run_error("infill of {} particles cannot take the place of {}", now, before);
  parts_.infill = std::move(infill);
  size_angular(parts_.infill->particles(), impulses_);
  particle_body_.replace_springs(std::move(body_springs), parts_.infill->particles(), parts_.bodies,
                                 release_at(time_));
  windowed_ = false;  // contact's view goes back from a little ahead to where the particles are
  reference_.valid = false;
  sheets_hold_ = -1;
}

void Simulation::advance_interval(double interval) {
  if (parts_.separated_at_fibres) show_sheets(interval);
  if (!reference_.valid) check_candidates();  // which contacts may bound the step
  interval_ = interval;
  look_at_bodies();
  plan_ = next_plan(interval);
  if (!carpet_frozen_) parts_.carpet->set_subcycle(plan_.carpet_subcycle);
  tell_contact_rates(interval);
  std::fill(interval_impulse_.begin(), interval_impulse_.end(), Vec3::Zero());
  const double end = time_ + interval;
  for (int left = plan_.windows; left > 0;) {
    time_ = end - left * plan_.window;
    const std::uint64_t searches = searches_;
    advance_window(--left == 0);
    // What a search has found may bear less.
    if (left > 0 && searches_ != searches && shorten_rest(left * plan_.window)) left = plan_.windows;
  }
  time_ = end;
  const ScopedPhase phase(timers_, Phase::ledger);
  if (!parts_.infill->energy_is_current()) return;
  carpet_balance_ = carpet_balance();
  infill_balance_ = infill_balance();
  if (!referenced_) {
    carpet_reference_ = carpet_balance_;
    infill_reference_ = infill_balance_;
    referenced_ = true;
  }
  ledger_.enter(time_, energy_terms(), [this] { return describe_fastest(); });
}

double Simulation::release_at(double time) const {
  if (!parts_.release_overlap || parts_.numerics.contact_release_time <= 0) return 0;
  return std::clamp(1 - (time - start_time_) / parts_.numerics.contact_release_time, 0.0, 1.0);
}

void Simulation::advance_window(bool last) {
  zero(impulses_.linear);
  zero(impulses_.angular);
  body_impulses_.reset(parts_.bodies.size());
  if (const std::uint64_t before = searches_;
      check_candidates(), searches_ != before && parts_.infill->has_individual_steps()) {
    look_at_bodies();
    tell_contact_rates(plan_.windows * plan_.window);
  }
  {
    const ScopedPhase phase(timers_, Phase::infill);
    parts_.infill->begin_window(plan_.window, plan_.infill_substeps, last);
  }

  const Vec3 carpet_before = carpet_impulse(*parts_.carpet);
  if (has_carpet()) step_carpet();
  const ParticleView particles = contact_view();
  {
    const ScopedPhase phase(timers_, Phase::contact);
    particle_body_.evaluate(particles, parts_.bodies, 0, plan_.window, release_at(time_),
                            release_at(time_ - plan_.window), plan_.window, impulses_.linear,
                            particles.has_spin() ? &impulses_.angular : nullptr, body_impulses_);
  }
  Vec3 extra(0, 0, 0);
  if (infill_acceleration_.squaredNorm() > 0) {
    if (parts_.infill->has_individual_steps())
      throw_run_error("extra acceleration is given in every window, but particles take steps of their own");
    const Vec3 velocity_change = infill_acceleration_ * plan_.window;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      impulses_.linear.add(i, particles.mass[i] * velocity_change);
      extra += particles.mass[i] * velocity_change;
    }
  }
  AdvanceReport report;
  {
    const ScopedPhase phase(timers_, Phase::infill);
    report = advance_infill();
  }
  if (const std::uint64_t expelled = parts_.infill->expelled().particles; expelled != expelled_) {
    expelled_ = expelled;
    reference_.valid = false;  // contact forgets them at the next search
  }
  Vec3 bodies(0, 0, 0);
  double bodies_scale = 0;
  advance_bodies(bodies, bodies_scale);
  const Vec3 carpet = carpet_frozen_ ? Vec3(-report.impulse_received + extra - bodies)
                                     : Vec3(carpet_impulse(*parts_.carpet) - carpet_before);
  check_momentum(report, carpet - extra, bodies, bodies_scale);
  ++windows_;
}

ParticleView Simulation::contact_view() const {
  ParticleView view = parts_.infill->particles();
  if (!windowed_) return view;
  view.x = window_position_.x;
  view.y = window_position_.y;
  view.z = window_position_.z;
  view.vx = window_velocity_.x;
  view.vy = window_velocity_.y;
  view.vz = window_velocity_.z;
  if (view.has_spin()) {
    view.wx = window_spin_.x;
    view.wy = window_spin_.y;
    view.wz = window_spin_.z;
  }
  return view;
}

AdvanceReport Simulation::advance_infill() {
  const int substeps = plan_.infill_substeps;
  if (substeps == 1) {
    if (windowed_) reference_.valid = false;  // contact's view of positions jumps by what it was ahead
    windowed_ = false;
    return parts_.infill->advance(plan_.window, 1, impulses_);
  }
  const ParticleView before = parts_.infill->particles();
  if (!windowed_) {
    copy(before.x, window_position_.x);
    copy(before.y, window_position_.y);
    copy(before.z, window_position_.z);
    window_velocity_.assign(before.size(), 0.0);
    reference_.valid = false;
  }
  copy(before.wx, window_spin_.x);
  copy(before.wy, window_spin_.y);
  copy(before.wz, window_spin_.z);
  AdvanceReport report = parts_.infill->advance(plan_.window, substeps, impulses_);
  const ParticleView after = parts_.infill->particles();
  const double ahead = (substeps - 1.0) / (2.0 * substeps) * plan_.window;
  const auto follow = [&](std::vector<double>& position, std::vector<double>& velocity,
                          std::span<const double> x, std::span<const double> v) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double now = x[i] + ahead * v[i];
      velocity[i] = (now - position[i]) / plan_.window;
      position[i] = now;
    }
  };
  follow(window_position_.x, window_velocity_.x, after.x, after.vx);
  follow(window_position_.y, window_velocity_.y, after.y, after.vy);
  follow(window_position_.z, window_velocity_.z, after.z, after.vz);
  // Spins have no displacement to measure. Under an even torque they rise by equal amounts: the mean of the n
  // values in the window is the old one plus (n + 1)/2n of the rise.
  const double share = (substeps + 1.0) / (2.0 * substeps);
  const auto part = [&](std::vector<double>& old, std::span<const double> now) {
    for (std::size_t i = 0; i < now.size(); ++i) old[i] += share * (now[i] - old[i]);
  };
  part(window_spin_.x, after.wx);
  part(window_spin_.y, after.wy);
  part(window_spin_.z, after.wz);
  windowed_ = true;
  return report;
}

void Simulation::step_carpet() {
  const int substeps = carpet_frozen_ ? 1 : plan_.carpet_substeps;
  const double dt = plan_.window / substeps;
  // Particles and bodies answer to the window's forces with one kick at its start. So they are looked at
  // along their velocity on both sides of that moment evenly: looked at ahead only, every spring would be
  // damped.
  const double middle = 0.5 * (substeps - 1) * dt;
  for (int s = 0; s < substeps; ++s) {
    const double ahead = s * dt - middle, now = time_ + s * dt;
    zero(node_force_);
    {
      const ScopedPhase phase(timers_, Phase::contact);
      const fe::NodeView nodes = parts_.carpet->nodes();
      const double release = release_at(now), release_before = release_at(now - dt);
      particle_shell_.evaluate(contact_view(), ahead, nodes, dt, release, release_before, node_force_,
                               impulses_);
      if (!carpet_frozen_)
        node_body_.evaluate(node_points(nodes), parts_.bodies, ahead, dt, release, release_before, 1.0,
                            node_force_, nullptr, body_impulses_);
    }
    if (carpet_frozen_) continue;
    {
      const ScopedPhase phase(timers_, Phase::carpet);
      parts_.carpet->step(dt, node_force_);
    }
    if (parts_.carpet->eroded_count() != eroded_) {
      const ScopedPhase phase(timers_, Phase::contact);
      eroded_ = parts_.carpet->eroded_count();
      particle_shell_.leave_out(parts_.carpet->eroded(), contact_view(), ahead + dt, parts_.carpet->nodes(),
                                dt, release_at(now + dt));
    }
  }
}

/// All contact is internal to carpet, infill and bodies: what the three received in one window adds up to
/// nothing. The carpet and infill report what they really took, so a lost or doubled impulse shows.
void Simulation::check_momentum(const AdvanceReport& infill, const Vec3& carpet, const Vec3& bodies,
                                double bodies_scale) {
  const double exchanged = infill.impulse_scale.sum() + carpet.cwiseAbs().sum() + bodies_scale;
  largest_exchange_ = std::max(largest_exchange_, exchanged);
  largest_imbalance_ = std::max(largest_imbalance_, (infill.impulse_received + carpet + bodies).norm());
  if (largest_exchange_ > 0) momentum_error_ = largest_imbalance_ / largest_exchange_;
}

double Simulation::moved_since_search() const {
  const ParticleView particles = parts_.infill->particles();
  const fe::NodeView nodes = parts_.carpet->nodes();
  const double of_particles =
      largest_displacement(particles.x, particles.y, particles.z, reference_.particles);
  const double of_nodes = largest_displacement(nodes.x, nodes.y, nodes.z, reference_.nodes);
  double of_bodies = 0;
  for (std::size_t b = 0; b < parts_.bodies.size(); ++b)
    of_bodies = std::max(of_bodies, (parts_.bodies[b].position - reference_.bodies[b]).norm());
  // The two largest of the three bound how much any two can have closed in on each other.
  return of_particles + of_nodes + of_bodies - std::min({of_particles, of_nodes, of_bodies});
}

void Simulation::check_candidates() {
  const ScopedPhase phase(timers_, Phase::search);
  if (reference_.valid) {
    const ParticleView p = parts_.infill->particles();
    const fe::NodeView n = parts_.carpet->nodes();
    double of_bodies = 0;
    for (const RigidBody& body : parts_.bodies) of_bodies = std::max(of_bodies, body.velocity.norm());
    const double speed = fastest(p.vx, p.vy, p.vz) + fastest(n.vx, n.vy, n.vz) + of_bodies;
    // The coming window moves everything on before the next look; twice, for what speeds up in it.
    if (moved_since_search() + 2 * speed * plan_.window < parts_.skin) return;
  }
  remember_reference();
  search(parts_.infill->particles(), parts_.carpet->nodes());
}

void Simulation::remember_reference() {
  const ParticleView p = parts_.infill->particles();
  const fe::NodeView n = parts_.carpet->nodes();
  copy(p.x, reference_.particles.x);
  copy(p.y, reference_.particles.y);
  copy(p.z, reference_.particles.z);
  copy(n.x, reference_.nodes.x);
  copy(n.y, reference_.nodes.y);
  copy(n.z, reference_.nodes.z);
  reference_.bodies.assign(parts_.bodies.size(), 0.0);
  for (std::size_t b = 0; b < parts_.bodies.size(); ++b) reference_.bodies.set(b, parts_.bodies[b].position);
  reference_.valid = true;
}

void Simulation::search(const ParticleView& particles, const fe::NodeView& nodes) {
  particle_shell_.search(particles, nodes, parts_.skin, parts_.release_overlap);
  particle_body_.search(particles, parts_.bodies, parts_.skin, parts_.release_overlap, particles.expelled);
  if (parts_.nodes_touch_bodies)
    node_body_.search(node_points(nodes), parts_.bodies, parts_.skin, parts_.release_overlap, nodes.clamped);
  ++searches_;
}

ParticleView Simulation::node_points(const fe::NodeView& nodes) const {
  ParticleView view;
  view.x = nodes.x;
  view.y = nodes.y;
  view.z = nodes.z;
  view.vx = nodes.vx;
  view.vy = nodes.vy;
  view.vz = nodes.vz;
  view.radius = parts_.node_radius;
  view.mass = nodes.mass;
  return view;
}

}  // namespace tuft::coupler

#include "coupler/particle_shell_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/checkpoint_values.h"
#include "core/parallel.h"
#include "coupler/contact_state_io.h"
#include "coupler/fastest.h"

namespace tuft::coupler {
void ParticleShellContact::Block::clear() {
  particles.clear();
  facets.clear();
  energy = {};
  softening = 0;
}

bool ParticleShellContact::on_rim(Index element, const std::array<double, 4>& weight) const {
  const auto& outer = outer_edge_[element];
  int corners_in_use = 0, last = 0;
  for (int c = 0; c < 4; ++c)
    if (weight[c] > 0) {
      ++corners_in_use;
      last = c;
    }
  if (corners_in_use == 1) return outer[last] || outer[(last + 3) % 4];
  if (corners_in_use != 2) return false;
  for (int c = 0; c < 4; ++c)
    if (weight[c] > 0 && weight[(c + 1) % 4] > 0) return outer[c];
  return false;  // on the diagonal between the two triangles of the facet
}

double ParticleShellContact::stiffness(Index particle, double radius, Index element) const {
  const double cover = std::min(1.0, 4 * radius * radius / element_area_[element]);
  return std::min(settings_.stiffness[particle], cover * element_stiffness_[element]);
}

double ParticleShellContact::contact_radius(std::size_t pair, const ParticleView& particles) const {
  return contact_radius(key_point(keys_[pair]), key_other(keys_[pair]), particles);
}

double ParticleShellContact::find_overlap(std::size_t pair, const Vec3& centre, const ParticleView& particles,
                                          const fe::NodeView& nodes, SoftOverlap& overlap) const {
  const Index p = key_point(keys_[pair]);
  const double radius = contact_radius(pair, particles);
  overlap.clear();
  double touching = 0;
  for (std::size_t s = first_element_[pair]; s < first_element_[pair + 1]; ++s) {
    const Index e = elements_[s];
    touching = radius + 0.5 * mesh_.thickness[e];
    overlap.add_facet(centre, touching, facet_corners(nodes, mesh_.quads[e]),
                      stiffness(p, particles.radius[p], e), e);
  }
  if (overlap.count > 0) {
    overlap.finish(centre);
    touching = overlap.parts[0].nearness + overlap.parts[0].overlap;
  }
  return touching;
}

void ParticleShellContact::choose_side(double touching, ContactHistory& history, SoftOverlap& overlap) const {
  // The side a particle came from is remembered: when a thin, soft strand is overrun the push stays on that
  // side. Round the rim of a strand a particle is free to change sides. So is one that leaves a fold of the
  // strand for another: the nearest point jumps then, while the distance of a particle that passes through
  // the sheet goes through zero.
  const SurfacePart& nearest = overlap.parts[0];
  const double present_side = nearest.normal.dot(nearest.face) >= 0 ? 1 : -1;
  const bool passed = present_side != history.side && history.distance < 0.25 * touching;
  if (history.side == 0 || on_rim(nearest.element, nearest.at.weight) || !passed) history.side = present_side;
  history.distance = present_side * history.side * nearest.nearness;
  if (present_side != history.side) overlap.take_as_passed();
}

ContactKinematics ParticleShellContact::kinematics_of(Index p, const Moment& now, double radius,
                                                      const SoftOverlap& overlap) const {
  const fe::NodeView& nodes = now.nodes;
  const Vec3 direction = overlap.direction();
  ContactKinematics kinematics;
  kinematics.gradient = direction.norm();
  // Pinched evenly from both sides there is no net push, and any normal serves.
  kinematics.normal =
      kinematics.gradient > 1e-9 ? Vec3(direction / kinematics.gradient) : overlap.parts[0].normal;
  Vec3 shell_velocity(0, 0, 0);
  double inverse_mass = direction.squaredNorm() / now.particles.mass[p];
  double of_shell = 0;  // what the shell's motion adds to the overlap
  for (std::size_t i = 0; i < overlap.count; ++i) {
    const SurfacePart& part = overlap.parts[i];
    const auto& quad = mesh_.quads[part.element];
    Vec3 velocity(0, 0, 0);
    double inverse_part_mass = 0;
    for (int c = 0; c < 4; ++c) {
      const double w = part.at.weight[c];
      velocity += w * Vec3(nodes.vx[quad[c]], nodes.vy[quad[c]], nodes.vz[quad[c]]);
      inverse_part_mass += w * w / node_mass_[quad[c]];
    }
    shell_velocity += part.share * velocity;
    of_shell += part.slope * part.normal.dot(velocity);
    inverse_mass += part.slope * part.slope * inverse_part_mass;
  }
  const Vec3 arm = -radius * kinematics.normal;
  kinematics.velocity = now.particles.velocity(p) + now.particles.spin(p).cross(arm) - shell_velocity;
  kinematics.closing = of_shell - direction.dot(now.particles.velocity(p));
  kinematics.effective_mass = 1.0 / inverse_mass;
  return kinematics;
}

void ParticleShellContact::evaluate_pair(std::size_t pair, const Moment& now, Block& block) {
  ContactHistory& history = histories_[pair];
  const Index p = key_point(keys_[pair]);
  const Vec3 centre = now.particles.position(p) + now.ahead * now.particles.velocity(p);
  SoftOverlap overlap;
  const double touching = find_overlap(pair, centre, now.particles, now.nodes, overlap);
  if (overlap.count == 0) {
    block.energy.friction += release_spring(history);
    history.side = 0;
    history.offset = 0;
    if (settings_.skip_pairs_apart) apart_until_[pair] = travel_.sum + overlap.gap;
    return;
  }
  choose_side(touching, history, overlap);
  const double root = overlap.parts[0].root, stiffness = root * root;
  const double depth = overlap.value - history.offset / root * now.release;
  if (!(depth > 0)) {
    block.energy.friction += release_spring(history);
    return;
  }
  const double radius = contact_radius(pair, now.particles);
  ContactKinematics kinematics = kinematics_of(p, now, radius, overlap);
  kinematics.overlap = depth;
  const ContactParameters parameters{{stiffness}, settings_.damping_ratio[p], 0.5, settings_.friction[p]};
  const ContactForce contact = compute_contact_force(parameters, kinematics, now.dt, history);
  block.energy.elastic += contact.elastic;
  block.energy.damped += contact.damped;
  block.energy.friction += contact.friction;
  block.energy.released +=
      release_work(parameters.spring, depth, history.offset / root * (now.release_before - now.release),
                   kinematics.closing * now.dt);
  block.softening += settings_.stiffness[p] / stiffness;
  block.particles.push_back({contact.force, -radius * kinematics.normal, p});
  // Each facet takes its own normal's part of the push, which is what the overlap's energy asks for.
  const Vec3 along = contact.force - contact.force.dot(kinematics.normal) * kinematics.normal;
  for (std::size_t i = 0; i < overlap.count; ++i) {
    const SurfacePart& part = overlap.parts[i];
    block.facets.push_back(
        {contact.pressed * part.slope * part.normal + part.share * along, part.at.weight, part.element});
  }
}

void ParticleShellContact::advance_travel(const Moment& now) {
  const ParticleView& particles = now.particles;
  const fe::NodeView& nodes = now.nodes;
  const double speed = fastest(particles.vx, particles.vy, particles.vz);
  // Particles move along one velocity within a window. A new window goes back over what was looked ahead with
  // the old one and takes the step with the new.
  const double moved = now.ahead > travel_.ahead
                           ? speed * (now.ahead - travel_.ahead)
                           : travel_.particles * travel_.ahead + speed * (travel_.ahead + travel_.dt);
  travel_.sum += moved + fastest(nodes.vx, nodes.vy, nodes.vz) * travel_.dt;
  travel_.ahead = now.ahead;
  travel_.dt = now.dt;
  travel_.particles = speed;
}

void ParticleShellContact::evaluate(const ParticleView& particles, double ahead, const fe::NodeView& nodes,
                                    double dt, double release, double release_before, Vec3Array& node_force,
                                    ContactImpulses& impulses) {
  const Moment now{particles, ahead, nodes, dt, release, release_before};
  advance_travel(now);
  const std::size_t pairs = keys_.size();
#pragma omp parallel for schedule(dynamic, 1) if (blocks_.size() > 1)
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    Block& block = blocks_[b];
    block.clear();
    const std::size_t end = std::min(pairs, (b + 1) * block_pairs);
    for (std::size_t g = b * block_pairs; g < end; ++g)
      if (apart_until_[g] <= travel_.sum) evaluate_pair(g, now, block);
  }

  // Serial: few pairs touch, and the order of additions must not depend on the threads.
  energy_.elastic = 0;
  energy_ += std::exchange(let_go_, {});
  touching_ = 0;
  double softening = 0;
  for (const Block& block : blocks_) {
    energy_ += block.energy;
    softening += block.softening;
    touching_ += block.particles.size();
    for (const ParticleForce& of : block.particles) {
      const Vec3 impulse = of.force * dt;
      impulses.linear.add(of.particle, impulse);
      if (impulses.angular.size() > 0) impulses.angular.add(of.particle, of.arm.cross(impulse));
    }
    for (const FacetForce& of : block.facets) {
      const auto& quad = mesh_.quads[of.element];
      for (int c = 0; c < 4; ++c) node_force.add(quad[c], -of.weight[c] * of.force);
    }
  }
  softening_ = touching_ > 0 ? softening / static_cast<double>(touching_) : 1.0;
}

void ParticleShellContact::shorten_steps(const ParticleView& particles, std::vector<double>& steps) const {
  constexpr double where_six_meet = 1.25 * 1.25;
  if (first_element_.empty()) return;           // nothing has been looked for yet
  for (std::size_t g = 0; g < keys_.size();) {  // sorted by particle
    const Index p = key_point(keys_[g]);
    double touched = 0, roots = 0, next = 0;
    for (; g < keys_.size() && key_point(keys_[g]) == p; ++g) {
      double k = 0;
      for (std::size_t s = first_element_[g]; s < first_element_[g + 1]; ++s)
        k = std::max(k, stiffness(p, particles.radius[p], elements_[s]));
      if (histories_[g].side != 0 || histories_[g].offset > 0)
        touched += k, roots += std::sqrt(k);
      else
        next = std::max(next, k);
    }
    const double k = touched + next;
    if (!(k > 0)) continue;
    // Dashpots add up, each critical for its own spring.
    const double zeta = settings_.damping_ratio[p] * (roots + std::sqrt(next)) / std::sqrt(k);
    const double share = std::sqrt(1 + zeta * zeta) - zeta;
    const double step = 2 * share * std::sqrt(particles.mass[p] / (where_six_meet * k));
    steps[p] = 1 / std::hypot(1 / steps[p], 1 / step);
  }
}

void ParticleShellContact::raise_rates(std::vector<float>& rates) const {
  for (const PairKey key : keys_)
    rates[static_cast<std::size_t>(key_point(key))] = std::numeric_limits<float>::infinity();
}

void ParticleShellContact::save(h5::Group& group) const {
  save_pairs(group, keys_, histories_);
  save_energy(group, energy_);
  h5::Group let_go = group.create_group("let_go");
  save_energy(let_go, let_go_);
  group.write_scalar("initial_overlap_pairs", static_cast<std::uint64_t>(initial_overlap_.pairs));
  group.write_scalar("initial_overlap_largest", initial_overlap_.largest);
  group.write_scalar("searched", static_cast<std::uint64_t>(searched_));
}

void ParticleShellContact::load(const h5::Group& group) {
  load_pairs(group, settings_.stiffness.size(), static_cast<std::size_t>(mesh_.surface_count), keys_,
             histories_);
  energy_ = load_energy(group);
  let_go_ = load_energy(group.open_group("let_go"));
  initial_overlap_.pairs = h5::read_count(group, "initial_overlap_pairs");
  initial_overlap_.largest = h5::read_number(group, "initial_overlap_largest");
  searched_ = h5::read_count(group, "searched") != 0;  // the next search fills in the elements
}

}  // namespace tuft::coupler

#include "coupler/particle_shell_contact.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "coupler/contact_state_io.h"

namespace tuft::coupler {
namespace {

double fastest(std::span<const double> x, std::span<const double> y, std::span<const double> z) {
  double squared = 0;
#pragma omp simd reduction(max : squared)
  for (std::size_t i = 0; i < x.size(); ++i)
    squared = std::max(squared, x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
  return std::sqrt(squared);
}

}  // namespace

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

double ParticleShellContact::find_overlap(std::size_t pair, const Vec3& centre, const ParticleView& particles,
                                          const fe::NodeView& nodes, SoftOverlap& overlap) const {
  const Index p = key_point(keys_[pair]);
  const double radius = particles.radius[p] * settings_.radius_factor;
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

ContactKinematics ParticleShellContact::kinematics_of(Index p, const Moment& now, const Vec3& arm,
                                                      const SoftOverlap& overlap,
                                                      const Vec3& direction) const {
  const fe::NodeView& nodes = now.nodes;
  Vec3 shell_velocity(0, 0, 0);
  double along = 0, inverse_shell_mass = 0;
  for (std::size_t i = 0; i < overlap.count; ++i) {
    const SurfacePart& part = overlap.parts[i];
    const auto& quad = mesh_.quads[part.element];
    Vec3 velocity(0, 0, 0);
    for (int c = 0; c < 4; ++c) {
      const double w = part.at.weight[c];
      velocity += w * Vec3(nodes.vx[quad[c]], nodes.vy[quad[c]], nodes.vz[quad[c]]);
      inverse_shell_mass += part.share * w * w / node_mass_[quad[c]];
    }
    shell_velocity += part.share * velocity;
    along += part.slope * part.normal.dot(velocity);
  }
  ContactKinematics kinematics;
  kinematics.gradient = direction.norm();
  kinematics.normal = direction / kinematics.gradient;
  const Vec3 of_particle = now.particles.velocity(p) + now.particles.spin(p).cross(arm);
  const Vec3 slip = of_particle - shell_velocity;
  // Along the normal, the rate of the overlap itself: what each facet takes of the push times its own motion.
  const double parting = of_particle.dot(kinematics.normal) - along / kinematics.gradient;
  kinematics.velocity = slip + (parting - slip.dot(kinematics.normal)) * kinematics.normal;
  kinematics.effective_mass = 1.0 / (1.0 / now.particles.mass[p] + inverse_shell_mass);
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
    apart_until_[pair] = travel_.sum + overlap.gap;
    return;
  }
  choose_side(touching, history, overlap);
  const Vec3 direction = overlap.direction();
  const double depth = overlap.value - history.offset * now.release;
  if (!(depth > 0) || !(direction.squaredNorm() > 1e-12)) {
    block.energy.friction += release_spring(history);
    return;
  }
  const double radius = now.particles.radius[p] * settings_.radius_factor;
  const Vec3 arm = -radius * direction.normalized();
  ContactKinematics kinematics = kinematics_of(p, now, arm, overlap, direction);
  kinematics.overlap = depth;
  const ContactParameters parameters{overlap.parts[0].root * overlap.parts[0].root,
                                     settings_.damping_ratio[p], 0.5, settings_.friction[p]};
  const ContactForce contact = compute_contact_force(parameters, kinematics, now.dt, history);
  block.energy.elastic += contact.elastic;
  block.energy.damped += contact.damped;
  block.energy.friction += contact.friction;
  block.energy.released +=
      release_work(parameters.stiffness, depth, history.offset * (now.release_before - now.release));
  block.softening += settings_.stiffness[p] / parameters.stiffness;
  block.particles.push_back({contact.force, arm, p});
  // Each facet takes its own normal's part of the push, which is what the overlap's energy asks for.
  const double push = contact.force.dot(kinematics.normal);
  const Vec3 along = contact.force - push * kinematics.normal;
  for (std::size_t i = 0; i < overlap.count; ++i) {
    const SurfacePart& part = overlap.parts[i];
    block.facets.push_back({push / kinematics.gradient * part.slope * part.normal + part.share * along,
                            part.at.weight, part.element});
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
  touching_ = 0;
  double softening = 0;
  Vec3 given(0, 0, 0);
  for (const Block& block : blocks_) {
    energy_ += block.energy;
    softening += block.softening;
    touching_ += block.particles.size();
    for (const ParticleForce& of : block.particles) {
      const Vec3 impulse = of.force * dt;
      impulses.linear.add(of.particle, impulse);
      impulses.angular.add(of.particle, of.arm.cross(impulse));
      given += impulse;
    }
    for (const FacetForce& of : block.facets) {
      const auto& quad = mesh_.quads[of.element];
      for (int c = 0; c < 4; ++c) node_force.add(quad[c], -of.weight[c] * of.force);
    }
  }
  impulse_given_ += given;
  softening_ = touching_ > 0 ? softening / static_cast<double>(touching_) : 1.0;
}

void ParticleShellContact::save(h5::Group& group) const {
  save_pairs(group, keys_, histories_);
  save_energy(group, energy_);
  group.write_scalar("initial_overlap_pairs", static_cast<std::uint64_t>(initial_overlap_.pairs));
  group.write_scalar("initial_overlap_largest", initial_overlap_.largest);
}

void ParticleShellContact::load(const h5::Group& group) {
  load_pairs(group, keys_, histories_);
  energy_ = load_energy(group);
  initial_overlap_.pairs = group.read_count("initial_overlap_pairs");
  initial_overlap_.largest = group.read_double("initial_overlap_largest");
  searched_ = true;  // the next search fills in the elements and keeps these histories
}

}  // namespace tuft::coupler

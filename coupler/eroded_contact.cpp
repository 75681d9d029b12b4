// What contact does when elements of the shells fail.
#include <algorithm>

#include "coupler/particle_shell_contact.h"

namespace tuft::coupler {

double ParticleShellContact::stored_normal(std::size_t pair, const Moment& now) const {
  const Index p = key_point(keys_[pair]);
  SoftOverlap overlap;
  const Vec3 centre = now.particles.position(p) + now.ahead * now.particles.velocity(p);
  const double touching = find_overlap(pair, centre, now.particles, now.nodes, overlap);
  if (overlap.count == 0) return 0;
  ContactHistory history = histories_[pair];  // a copy: what the side rule learns is for the next evaluation
  choose_side(touching, history, overlap);
  const double root = overlap.parts[0].root;
  const double depth = overlap.value - history.offset / root * now.release;
  if (!(depth > 0)) return 0;
  const double radius = contact_radius(pair, now.particles);
  const double depth_before = depth - kinematics_of(p, now, radius, overlap).closing * now.dt;
  return 0.5 * root * root * depth * std::max(0.0, depth_before);
}

void ParticleShellContact::leave_out(std::span<const std::uint8_t> eroded) {
  eroded_.assign(eroded.begin(), eroded.end());
  outer_edge_ = find_outer_edges(mesh_, eroded_);
}

void ParticleShellContact::leave_out(std::span<const std::uint8_t> eroded, const ParticleView& particles,
                                     double ahead, const fe::NodeView& nodes, double dt, double release) {
  const Moment now{particles, ahead, nodes, dt, release, release};
  std::vector<double> lost(keys_.size(), 0.0);
  std::vector<std::uint8_t> hit(keys_.size(), 0);
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    for (std::size_t s = first_element_[g]; s < first_element_[g + 1]; ++s)
      hit[g] = hit[g] || eroded[elements_[s]] != 0;
    if (hit[g]) lost[g] = stored_normal(g, now);
  }
  std::size_t elements = 0, begin = 0;
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    const std::size_t end = first_element_[g + 1];
    first_element_[g] = elements;
    for (std::size_t s = begin; s < end; ++s)
      if (!eroded[elements_[s]]) elements_[elements++] = elements_[s];
    begin = end;
  }
  first_element_.back() = elements;
  elements_.resize(elements);
  leave_out(eroded);  // the side rule asks for the rims as they are now
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    if (!hit[g]) continue;
    apart_until_[g] = 0;
    let_go_.damped += lost[g] - stored_normal(g, now);
    if (first_element_[g] == first_element_[g + 1]) let_go_.friction += release_spring(histories_[g]);
  }
  drop_empty_pairs();
}

/// As a search would have it: a run that goes on from a checkpoint has the same pairs in the same blocks.
void ParticleShellContact::drop_empty_pairs() {
  std::size_t kept = 0;
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    if (first_element_[g] == first_element_[g + 1]) continue;
    keys_[kept] = keys_[g];
    histories_[kept] = histories_[g];
    apart_until_[kept] = apart_until_[g];
    first_element_[kept] = first_element_[g];
    ++kept;
  }
  first_element_[kept] = first_element_.back();
  keys_.resize(kept);
  histories_.resize(kept);
  apart_until_.resize(kept);
  first_element_.resize(kept + 1);
  blocks_.resize((kept + block_pairs - 1) / block_pairs);
}

}  // namespace tuft::coupler

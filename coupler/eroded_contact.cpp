// What contact does when elements of the shells fail.
#include "coupler/particle_shell_contact.h"

namespace tuft::coupler {

double ParticleShellContact::stored_normal(std::size_t pair, const ParticleView& particles,
                                           const fe::NodeView& nodes, double release) const {
  SoftOverlap overlap;
  find_overlap(pair, particles.position(key_point(keys_[pair])), particles, nodes, overlap);
  if (overlap.count == 0) return 0;
  const ContactHistory& history = histories_[pair];
  const double root = overlap.parts[0].root;
  const double depth = overlap.value - history.offset / root * release;
  return depth > 0 ? 0.5 * root * root * depth * depth : 0;
}

void ParticleShellContact::leave_out(std::span<const std::uint8_t> eroded) {
  eroded_.assign(eroded.begin(), eroded.end());
  outer_edge_ = find_outer_edges(mesh_, eroded_);
}

void ParticleShellContact::leave_out(std::span<const std::uint8_t> eroded, const ParticleView& particles,
                                     const fe::NodeView& nodes, double release) {
  std::vector<std::size_t> first{0};
  std::vector<Index> kept;
  std::vector<double> lost(keys_.size(), 0.0);
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    bool hit = false;
    for (std::size_t s = first_element_[g]; s < first_element_[g + 1]; ++s) {
      const Index e = elements_[s];
      const bool gone = eroded[e] != 0;
      hit = hit || gone;
      if (!gone) kept.push_back(e);
    }
    first.push_back(kept.size());
    if (hit) lost[g] = stored_normal(g, particles, nodes, release);
  }
  const std::vector<std::size_t> before = std::move(first_element_);
  first_element_ = std::move(first);
  elements_ = std::move(kept);
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    const std::size_t count = first_element_[g + 1] - first_element_[g];
    if (count == before[g + 1] - before[g]) continue;
    apart_until_[g] = 0;
    energy_.damped += lost[g] - stored_normal(g, particles, nodes, release);
    if (count == 0) energy_.friction += release_spring(histories_[g]);
  }
  leave_out(eroded);
}

}  // namespace tuft::coupler

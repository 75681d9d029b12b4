/// Forces of contact where everything stands now, for whoever wants to look at them: evaluated on a copy, so
/// that nothing of the simulation changes.
#include <algorithm>
#include <optional>

#include "coupler/simulation.h"

namespace tuft::coupler {

void ParticleShellContact::list_forces(const ParticleView& particles, const fe::NodeView& nodes, double dt,
                                       double release, double release_before, ContactNetwork& network) const {
  if (first_element_.empty()) return;  // nothing has been looked for yet
  ParticleShellContact copy(*this);
  const Moment now{particles, 0, nodes, dt, release, release_before};
  Block block;
  SoftOverlap overlap;
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    block.clear();
    copy.evaluate_pair(g, now, block);
    if (block.particles.empty()) continue;
    const ParticleForce& of = block.particles.front();
    copy.find_overlap(g, particles.position(of.particle), particles, nodes, overlap);
    const Index surface = key_other(keys_[g]);
    const bool backing = surface == fe::ShellMesh::backing_surface;
    network.add(backing ? ContactKind::backing : ContactKind::fibre, of.particle, surface, of.arm,
                -of.arm.normalized(), of.force, overlap.value);
  }
}

void BodyContact::list_forces(const ParticleView& points, const std::vector<RigidBody>& bodies, double dt,
                              double release, double release_before, ContactNetwork& network) const {
  BodyContact copy(*this);
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    const Result result = copy.evaluate_pair(g, points, bodies, 0, dt, release, release_before);
    if (!result.touching) continue;
    const Index i = key_point(keys_[g]), body = key_other(keys_[g]);
    network.add(ContactKind::body, i, body, result.arm, -result.arm.normalized(), result.contact.force,
                overlap_of(i, bodies[static_cast<std::size_t>(body)], points));
  }
}

ContactNetwork Simulation::boundary_contacts() const {
  ContactNetwork shells, network;
  ParticleView particles = contact_view();
  particles.kicks = {};
  const double window = plan_.window, release = release_at(time_), before = release_at(time_ - window);
  // Where the coming window would look for pairs anew, copies do: at the start of a run, and where what is
  // known of pairs belongs to another moment.
  std::optional<ParticleShellContact> shell_pairs;
  std::optional<BodyContact> body_pairs;
  if (!reference_.valid) {
    const ParticleView standing = parts_.infill->particles();
    shell_pairs.emplace(particle_shell_);
    shell_pairs->search(standing, parts_.carpet->nodes(), parts_.skin, parts_.release_overlap);
    body_pairs.emplace(particle_body_);
    body_pairs->search(standing, parts_.bodies, parts_.skin, parts_.release_overlap, standing.expelled);
  }
  const ParticleShellContact& of_shells = shell_pairs ? *shell_pairs : particle_shell_;
  const BodyContact& of_bodies = body_pairs ? *body_pairs : particle_body_;
  if (has_carpet())
    of_shells.list_forces(particles, parts_.carpet->nodes(), window / std::max(1, plan_.carpet_substeps),
                          release, before, shells);
  // Sorted by particle; kinds apart.
  for (const ContactKind kind : {ContactKind::backing, ContactKind::fibre})
    for (std::size_t c = 0; c < shells.size(); ++c)
      if (shells.kind[c] == kind)
        network.add(kind, shells.particle[c], shells.other[c], shells.branch[c],
                    -shells.branch[c].normalized(), shells.force(c), shells.overlap[c]);
  of_bodies.list_forces(particles, parts_.bodies, window, release, before, network);
  return network;
}

}  // namespace tuft::coupler

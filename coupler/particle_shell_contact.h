#pragma once
/// Contact of infill particles with the carpet's shells. A particle makes one contact with each surface (the
/// backing, each strand), shared by all triangles of it that it overlaps (soft_overlap.h), and the memory of
/// a contact (slip, side) follows it from element to element.
#include <array>
#include <span>
#include <vector>

#include "core/infill.h"
#include "coupler/contact_pairs.h"
#include "coupler/soft_overlap.h"
#include "fe_carpet/carpet.h"

namespace tuft::coupler {

struct ParticleShellSettings {
  std::vector<double> stiffness;      ///< N/m, per particle, from its material
  std::vector<double> damping_ratio;  ///< per particle
  std::vector<FrictionLaw> friction;  ///< per particle, against fibre and backing
  /// Contact radius for strands over the particle's radius. The backing bounds the infill from below: what
  /// lies on it touches with its whole radius, the one downwards.
  double strand_radius_factor = 1;
  /// Largest penalty as a share of the shell's own contact stiffness (fe::Carpet::node_contact_stiffness),
  /// for a particle that covers a whole element; one that covers less, (2r)^2 of the element's area, gets as
  /// much less. However densely both faces are covered, the sum over a node's contacts then stays under 4.2
  /// times the share (4.2: two triangles traded for each other, soft_overlap.h), and its omega^2 dt^2 under
  /// s^2 (4 + 4.2 share) at step safety s: under 4 up to s = 0.81 (docs/theory/contact.md).
  double shell_share = 0.5;
  /// Leave out pairs until the largest speeds could have closed their gap. Changes no result, only the time.
  bool skip_pairs_apart = true;
};

[[nodiscard]] inline std::array<Vec3, 4> facet_corners(const fe::NodeView& nodes,
                                                       const std::array<Index, 4>& quad) {
  std::array<Vec3, 4> corner;
  for (int c = 0; c < 4; ++c) corner[c] = Vec3(nodes.x[quad[c]], nodes.y[quad[c]], nodes.z[quad[c]]);
  return corner;
}

/// Edges c to c+1 of each element that no second element of the same surface shares. eroded: elements that
/// are no longer there, or empty.
[[nodiscard]] std::vector<std::array<bool, 4>> find_outer_edges(const fe::ShellMesh& mesh,
                                                                std::span<const std::uint8_t> eroded);

/// Positions and velocities of the shell's nodes are read, forces on them added.
class ParticleShellContact {
 public:
  ParticleShellContact(const fe::ShellMesh& mesh, std::span<const double> node_stiffness,
                       std::span<const double> node_mass, ParticleShellSettings settings);

  /// Finds all pairs closer than touching + skin. On the first call overlaps are recorded as offsets when
  /// `keep_overlap`. Deterministic order.
  void search(const ParticleView& particles, const fe::NodeView& nodes, double skin, bool keep_overlap);

  /// One substep: infill seen at x + ahead v. Adds forces on nodes (N) to `node_force` and, on the particles,
  /// impulses over dt to `impulses`. release: share of the initial offsets still kept, release_before: at the
  /// last substep.
  void evaluate(const ParticleView& particles, double ahead, const fe::NodeView& nodes, double dt,
                double release, double release_before, Vec3Array& node_force, ContactImpulses& impulses);

  /// Takes elements out that failed (one value an element of the mesh): what touched them touches what is
  /// left. `particles`, `ahead`, `nodes` and `release` are what the next evaluation will see; the energy of
  /// springs that it will not find any more is booked there as lost, in damping and friction. dt: of the step
  /// that has led here.
  void leave_out(std::span<const std::uint8_t> eroded, const ParticleView& particles, double ahead,
                 const fe::NodeView& nodes, double dt, double release);
  /// The same without any pairs yet, after load.
  void leave_out(std::span<const std::uint8_t> eroded);

  /// Adds the forces that an evaluation over `dt` would find now, without making it: a contact a particle and
  /// surface, its branch from the particle's centre to the point of contact (contact_forces.cpp).
  void list_forces(const ParticleView& particles, const fe::NodeView& nodes, double dt, double release,
                   double release_before, ContactNetwork& network) const;

  [[nodiscard]] const ContactEnergy& energy() const { return energy_; }
  [[nodiscard]] const InitialOverlap& initial_overlap() const { return initial_overlap_; }
  [[nodiscard]] std::size_t pair_count() const { return keys_.size(); }
  /// Shortens `steps` (s, one a particle) to what they bear together with their contacts with shells:
  /// 1/step^2 is the sum of both. A contact's step is (2/omega)(sqrt(1 + zeta^2) - zeta), as dashpots act
  /// with the velocity half a step before, with omega^2 = 1.56 k/m, k the sum over the surfaces that a
  /// particle touched when last looked at, and the stiffest of those that it may touch next, and zeta of
  /// their dashpots together. 1.56 = 1.25^2 is for flat sheets, where six triangles meet (soft_overlap.h); in
  /// a hollow whose sides meet at 64 degrees it is 2.3, between two faces of one sheet up to 8.
  void shorten_steps(const ParticleView& particles, std::vector<double>& steps) const;
  /// Makes the rates (one a particle) of those near a shell infinite: they have to be kicked in every window.
  void raise_rates(std::vector<float>& rates) const;
  [[nodiscard]] std::size_t touching() const { return touching_; }
  /// Mean over touching pairs of material penalty over penalty used, >= 1: how much softer the bound made
  /// contact.
  [[nodiscard]] double softening() const { return softening_; }

  void save(h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  /// One substep as all its pairs see it.
  struct Moment {
    const ParticleView& particles;
    double ahead;
    const fe::NodeView& nodes;
    double dt, release, release_before;
  };
  /// What a touching pair does to its particle, and one of its facets to the shell's nodes.
  struct ParticleForce {
    Vec3 force, arm;
    Index particle;
  };
  struct FacetForce {
    Vec3 force;  ///< N, on the particle; the nodes get the opposite, by weight
    std::array<double, 4> weight;
    Index element;
  };
  /// Results of a fixed range of pairs, so that their order does not depend on the threads. Capacity is kept.
  struct Block {
    std::vector<ParticleForce> particles;
    std::vector<FacetForce> facets;
    ContactEnergy energy;
    double softening = 0;
    void clear();
  };
  static constexpr std::size_t block_pairs = 256;

  void evaluate_pair(std::size_t pair, const Moment& now, Block& block);
  /// How deep the particle is in the surface; returns the distance at which it touches, m.
  [[nodiscard]] double contact_radius(Index particle, Index surface, const ParticleView& particles) const {
    const auto p = static_cast<std::size_t>(particle);
    return surface == fe::ShellMesh::backing_surface ? particles.radius_upwards(p)
                                                     : particles.radius[p] * settings_.strand_radius_factor;
  }
  /// m, of a pair's particle for its surface.
  [[nodiscard]] double contact_radius(std::size_t pair, const ParticleView& particles) const;
  double find_overlap(std::size_t pair, const Vec3& centre, const ParticleView& particles,
                      const fe::NodeView& nodes, SoftOverlap& overlap) const;
  /// The side rule: which side of the surface the particle is on, and the overlap from there.
  void choose_side(double touching, ContactHistory& history, SoftOverlap& overlap) const;
  /// Motion of particle and shell at the contact point, and the mass that resists.
  [[nodiscard]] ContactKinematics kinematics_of(Index particle, const Moment& now, double radius,
                                                const SoftOverlap& overlap) const;
  [[nodiscard]] double stiffness(Index particle, double radius, Index element) const;
  /// Energy of a pair's normal spring less the work k D (D - D_before)/2 that its force would have done at
  /// this end of the step, J: what is lost when the force is not there any more.
  [[nodiscard]] double stored_normal(std::size_t pair, const Moment& now) const;
  void drop_empty_pairs();
  /// Farthest that any particle and any node can have closed in on each other since the last call, added up.
  void advance_travel(const Moment& now);
  void record_initial_overlap(const ParticleView& particles, const fe::NodeView& nodes);

  /// Whether the nearest point of an element lies on the rim of its surface: there a particle may pass from
  /// one side to the other, over the face it may not.
  [[nodiscard]] bool on_rim(Index element, const std::array<double, 4>& weight) const;

  const fe::ShellMesh& mesh_;
  std::vector<double> element_stiffness_;  ///< N/m, bound per element
  std::vector<double> element_area_;       ///< m^2, as built
  std::vector<std::array<bool, 4>>
      outer_edge_;  ///< per element: edge c to c+1 belongs to this element of its surface alone
  std::vector<std::uint8_t> eroded_;  ///< per element, or empty
  std::vector<double> node_mass_;
  ParticleShellSettings settings_;

  std::vector<PairKey> keys_;
  std::vector<ContactHistory> histories_;
  std::vector<std::size_t> first_element_;  ///< CSR, keys_.size() + 1
  std::vector<Index> elements_;
  std::vector<double> apart_until_;  ///< m, per pair: value of travel_ before which it cannot touch
  std::vector<Block> blocks_;

  struct Travel {
    double sum = 0;                           ///< m, since the last search
    double ahead = 0, dt = 0, particles = 0;  ///< of the last call: s, s, m/s
  } travel_;

  ContactEnergy energy_;
  ContactEnergy let_go_;  ///< by shells that failed since the last evaluation
  InitialOverlap initial_overlap_;
  bool searched_ = false;
  std::size_t touching_ = 0;
  double softening_ = 1;
};

}  // namespace tuft::coupler

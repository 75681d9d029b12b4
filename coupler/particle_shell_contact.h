#pragma once
/// Contact of infill particles with the carpet's shells. A particle touches each surface (the backing, each
/// strand) at its nearest point only, so that neighbouring elements of one strand do not push twice, and the
/// memory of a contact (slip, side) follows it from element to element.
#include <array>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "core/infill.h"
#include "coupler/contact_pairs.h"
#include "fe_carpet/carpet.h"

namespace tuft::coupler {

struct ParticleShellSettings {
  std::vector<double> stiffness;      ///< N/m, per particle, from its material
  std::vector<double> damping_ratio;  ///< per particle
  std::vector<FrictionLaw> friction;  ///< per particle, against fibre and backing
  double radius_factor = 1;           ///< contact radius for shells over the particle's radius
  /// Largest penalty as a share of the shell's own contact stiffness (fe::Carpet::node_contact_stiffness),
  /// for a particle that covers a whole element; one that covers less, (2r)^2 of the element's area, gets as
  /// much less. However densely both faces are covered, the sum over a node's contacts then stays under the
  /// share, and its omega^2 dt^2 under s^2 (4 + share) at step safety s (docs/theory/contact.md).
  double shell_share = 0.5;
};

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

  [[nodiscard]] const ContactEnergy& energy() const { return energy_; }
  [[nodiscard]] const InitialOverlap& initial_overlap() const { return initial_overlap_; }
  [[nodiscard]] std::size_t pair_count() const { return keys_.size(); }
  [[nodiscard]] std::size_t touching() const { return touching_; }
  /// Mean over touching pairs of material penalty over penalty used, >= 1: how much softer the bound made
  /// contact.
  [[nodiscard]] double softening() const { return softening_; }
  /// Sum of impulses given to particles since the start, N s, and of their absolute values.
  [[nodiscard]] Vec3 impulse_given() const { return impulse_given_; }

  void save(h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  /// A facet's part in a contact.
  struct Part {
    FacetPoint at;
    Vec3 normal{0, 0, 1};  ///< towards the particle
    double nearness = 0;   ///< m
    double share = 0;      ///< of the contact, sum 1
    Index element = -1;
  };
  static constexpr std::size_t most_parts = 4;
  using Parts = std::array<Part, most_parts>;
  struct Result {
    ContactForce contact;
    Vec3 arm{0, 0, 0};
    Vec3 normal{0, 0, 1};
    double gradient = 1;
    double released = 0;
    double softening = 1;
    Parts parts{};
    std::size_t part_count = 0;  ///< 0: apart
  };
  /// The nearest facets of a pair, nearest first, with shares; returns how many, and the soft minimum of
  /// their distances.
  std::size_t find_parts(std::size_t pair, const Vec3& centre, double radius, const fe::NodeView& nodes,
                         Parts& parts, double& soft_distance) const;
  Result evaluate_pair(std::size_t pair, const ParticleView& particles, double ahead,
                       const fe::NodeView& nodes, double dt, double release, double release_before);

  /// Whether the nearest point of an element lies on the rim of its surface: there a particle may pass from
  /// one side to the other, over the face it may not.
  [[nodiscard]] bool on_rim(Index element, const std::array<double, 4>& weight) const;

  const fe::ShellMesh& mesh_;
  std::vector<double> element_stiffness_;  ///< N/m, bound per element
  std::vector<double> element_area_;       ///< m^2, as built
  std::vector<std::array<bool, 4>>
      outer_edge_;  ///< per element: edge c to c+1 belongs to this element of its surface alone
  std::vector<double> node_mass_;
  ParticleShellSettings settings_;

  std::vector<PairKey> keys_;
  std::vector<ContactHistory> histories_;
  std::vector<std::size_t> first_element_;  ///< CSR, keys_.size() + 1
  std::vector<Index> elements_;
  std::vector<Result> results_;

  ContactEnergy energy_;
  InitialOverlap initial_overlap_;
  bool searched_ = false;
  std::size_t touching_ = 0;
  double softening_ = 1;
  Vec3 impulse_given_{0, 0, 0};
};

}  // namespace tuft::coupler

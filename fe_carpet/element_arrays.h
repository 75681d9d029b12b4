#pragma once
/// State of the elements in structures of arrays, batch by batch of `lanes` elements that the element loop
/// takes at once.
#include <array>
#include <variant>
#include <vector>

#include "fe_carpet/carpet.h"
#include "core/lanes.h"
#include "fe_carpet/orthotropic.h"
#include "fe_carpet/viscoelastic.h"

namespace tuft::fe {

/// Corner forces and moments of a batch: 4 corners x 6 components x lanes.
inline constexpr std::size_t corner_values = 6 * lanes;
inline constexpr std::size_t batch_values = 4 * corner_values;

/// Batches are summed up in blocks of fixed size, so that sums do not depend on the thread count.
inline constexpr std::size_t batches_per_block = 8;

/// Orthotropic stiffnesses in the axes of each element of a family as built; in-plane shear turns the
/// material's directions in the element by half its angle, which is neglected.
struct OrthotropicTable {
  static constexpr std::size_t values = 15;
  PackedDoubles stiffness;  ///< [batch of the family][value][lane], values in OrthotropicLaw's order
  IsotropicLaw stiffer;     ///< for bounds
  static constexpr std::size_t plane_rows() { return OrthotropicLaw<double>::plane_rows(); }
  static constexpr std::size_t shear_rows() { return OrthotropicLaw<double>::shear_rows(); }
};

/// What a section's elements have in common.
using SectionLaw = std::variant<IsotropicLaw, ViscoelasticLaw, OrthotropicTable>;

struct ElementArrays;
struct NodeMotion;
struct ElementFamily;

/// Strain increments over the last step (length last_step, s), stress update, corner forces and works of some
/// batches of a family.
using ElementFunction = void (*)(ElementArrays&, const ElementFamily&, const NodeMotion&, double last_step,
                                 std::size_t first_batch, std::size_t last_batch, std::size_t block);

/// The elements of one material: one law, one element formulation.
struct ElementFamily {
  ShellSection section;
  SectionLaw law;
  ElementFunction update = nullptr;
  std::size_t rows = 0;       ///< values of state per element
  double failure_strain = 0;  ///< > 0: elements fail, and the last failure_rows() rows follow their strain
  std::size_t failure_points = 0;  ///< points in the plane that are followed
  [[nodiscard]] std::size_t failure_rows() const { return failure_points > 0 ? 2 + 6 * failure_points : 0; }
  std::size_t first_batch = 0, batch_count = 0;
  std::size_t first_state = 0;  ///< in ElementArrays::state, of the first batch
};

/// A block of batches of one family.
struct ElementBlock {
  std::size_t family, first_batch, last_batch;
};

/// The last batch of a family is padded with copies of thickness zero, which yield zero forces and energies
/// and that no node gathers.
struct ElementArrays {
  std::vector<ElementFamily> family;  ///< per material of the mesh
  std::vector<ElementBlock> block;
  std::size_t element_count = 0, batch_count = 0;
  std::vector<Index> element;              ///< per slot (batch x lanes + lane): element, -1 for padding
  std::vector<Index> slot;                 ///< per element
  std::array<std::vector<Index>, 4> node;  ///< per slot
  std::vector<Index> batch_family;
  PackedDoubles thickness, mass, inertia_ratio;  ///< per slot: m; kg, 0 for padding; m^2
  PackedDoubles true_mass;  ///< kg per slot before mass scaling; empty when none was added
  PackedDoubles state;      ///< [batch][row][lane], rows of the family
  PackedDoubles forces;     ///< [batch][corner][component][lane], internal forces N and moments N m
  std::vector<double> strain_work, hourglass_work;  ///< J per block, since the start
  std::vector<double> uprightness;                  ///< per block, the smallest of the last update
  /// Where something can fail, otherwise empty: per block, whether the last update failed an element; per
  /// slot, whether it was this one, and half of the work of its forces over the step, J.
  std::vector<std::uint8_t> failing, failed;
  PackedDoubles last_half_work;
  std::vector<std::uint8_t> eroded;  ///< per element of the mesh: taken out
  std::size_t eroded_count = 0;

  [[nodiscard]] std::size_t state_of_batch(std::size_t batch) const {
    const ElementFamily& f = family[static_cast<std::size_t>(batch_family[batch])];
    return f.first_state + (batch - f.first_batch) * f.rows * lanes;
  }
};

/// Node coordinates and velocities as the element loop reads them.
struct NodeMotion {
  Vec3Array position;          ///< m, at t
  Vec3Array velocity;          ///< m/s, half a step before
  Vec3Array angular_velocity;  ///< rad/s, half a step before
};

/// Lays out the batches and computes mass and inertia from the mesh's reference positions. Nothing is checked
/// here.
[[nodiscard]] ElementArrays make_element_arrays(const ShellMesh& mesh,
                                                const std::vector<ShellMaterial>& materials,
                                                const CarpetOptions& options);

[[nodiscard]] inline bool can_fail(const ElementArrays& elements) {
  for (const ElementFamily& family : elements.family)
    if (family.failure_points > 0) return true;
  return false;
}

/// Chooses the update function and the number of rows for a family's section and law.
void choose_element_function(ElementFamily& family);

/// First element of the marked families that is not upright at the present positions (shell_frame.h), or -1.
/// Only when asked: slow.
[[nodiscard]] Index find_inverted_element(const ElementArrays& elements, const NodeMotion& nodes,
                                          double last_step, std::span<const std::uint8_t> of_family);

/// Largest frequency bound squared (1/s^2) of the elements of a batch at the present positions; per lane, 0
/// for padding.
[[nodiscard]] Pack batch_frequency_squared(const ElementArrays& elements, const Vec3Array& position,
                                           std::size_t batch);

}  // namespace tuft::fe

#pragma once
/// State of the elements in structures of arrays, batch by batch of `lanes` elements that the element loop
/// takes at once.
#include <array>
#include <vector>

#include "fe_carpet/carpet.h"
#include "fe_carpet/lanes.h"
#include "fe_carpet/plane_stress.h"

namespace tuft::fe {

/// Values of state per element: five hourglass forces, then either the eight resultants (one "point": exact
/// for the elastic law) or two transverse shear stresses and three in-plane stresses per Gauss point.
inline constexpr std::size_t hourglass_values = 5;
[[nodiscard]] constexpr std::size_t state_values(int thickness_points) {
  return hourglass_values + (thickness_points == 1 ? 8U : 2U + 3U * static_cast<unsigned>(thickness_points));
}

/// Corner forces and moments of a batch: 4 corners x 6 components x lanes.
inline constexpr std::size_t corner_values = 6 * lanes;
inline constexpr std::size_t batch_values = 4 * corner_values;

/// Batches are summed up in blocks of fixed size, so that sums do not depend on the thread count.
inline constexpr std::size_t batches_per_block = 8;

/// Elements of one material fill a batch; the last batch of a material is padded with copies of thickness
/// zero, which yield zero forces and energies and that no node gathers.
struct ElementArrays {
  int thickness_points = 3;
  std::size_t element_count = 0, batch_count = 0, block_count = 0;
  std::vector<Index> element;              ///< per slot (batch x lanes + lane): element, -1 for padding
  std::vector<Index> slot;                 ///< per element
  std::array<std::vector<Index>, 4> node;  ///< per slot
  std::vector<Index> batch_material;
  std::vector<PlaneStressLaw> law;               ///< per material
  PackedDoubles thickness, mass, inertia_ratio;  ///< per slot: m; kg, 0 for padding; m^2
  PackedDoubles state;                           ///< [batch][state_values][lane]
  PackedDoubles forces;  ///< [batch][corner][component][lane], internal forces N and moments N m
  std::vector<double> strain_work, hourglass_work;  ///< J per block, since the start
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

/// Strain increments over the last step (length last_step, s), stress update, corner forces and works of all
/// batches of a block. `block` functions of different blocks may run at the same time.
using ElementBlockFunction = void (*)(ElementArrays&, const NodeMotion&, double last_step, std::size_t block);
[[nodiscard]] ElementBlockFunction element_block_function(int thickness_points);

/// Largest frequency bound squared (1/s^2) of the elements of a batch at the present positions; per lane, 0
/// for padding.
[[nodiscard]] Pack batch_frequency_squared(const ElementArrays& elements, const Vec3Array& position,
                                           std::size_t batch);

}  // namespace tuft::fe

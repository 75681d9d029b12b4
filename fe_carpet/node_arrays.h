#pragma once
/// State of the nodes and the loop that moves them: forces gathered from the elements' corners in a fixed
/// order, central differences, and the sums that the energy ledger needs.
#include <array>
#include <vector>

#include "fe_carpet/element_arrays.h"

namespace tuft::fe {

/// Nodes are summed up in blocks of fixed size, so that sums do not depend on the thread count.
inline constexpr std::size_t nodes_per_block = 128;

/// Sums over a block of nodes. `last` values are of the last step alone: works at the moment of a force
/// evaluation count half of it, as the kinetic energy does.
struct NodeSums {
  double kinetic = 0;  ///< J, mean of the values half a step before and after the last force evaluation
  double external_work = 0, last_external_work = 0;               ///< J; total includes last
  double damping_work = 0, last_damping_work = 0;                 ///< J dissipated
  std::array<double, 3> impulse_received{}, impulse_to_clamps{};  ///< N s
  double largest_speed_squared = 0;                               ///< m^2/s^2
};

struct NodeArrays {
  NodeMotion motion;
  std::vector<double> mass, inertia;  ///< kg, kg m^2
  std::vector<double> free;           ///< 1, or 0 for clamped nodes
  /// With mass scaling only, otherwise empty: kg without what was added, and by component (x, y, z) `free`
  /// times true mass over mass. Gravity pulls on the true mass and moves all of it.
  std::vector<double> true_mass;
  std::array<std::vector<double>, 3> weight;
  std::vector<double> inverse_mass, inverse_inertia;  ///< 0 for clamped nodes
  /// For meshes with constraints on single components: free, inverse mass or inertia by component (x, y, z,
  /// then the rotations); otherwise empty, and the three above serve all.
  std::array<std::vector<double>, 6> component_free, component_inverse;
  std::vector<std::uint8_t> clamped;
  std::vector<Index> first_corner;   ///< per node and one more: range in corner_offset
  std::vector<Index> corner_offset;  ///< first value of a corner in ElementArrays::forces
  std::vector<NodeSums> sums;        ///< per block
  [[nodiscard]] std::size_t size() const { return mass.size(); }
  [[nodiscard]] const double* free_of(std::size_t c) const {
    return component_free[c].empty() ? free.data() : component_free[c].data();
  }
  [[nodiscard]] const double* weight_of(std::size_t c) const {
    return weight[c].empty() ? free_of(c) : weight[c].data();
  }
  [[nodiscard]] const double* true_mass_of() const {
    return true_mass.empty() ? mass.data() : true_mass.data();
  }
  [[nodiscard]] const double* inverse_of(std::size_t c) const {
    if (!component_inverse[c].empty()) return component_inverse[c].data();
    return c < 3 ? inverse_mass.data() : inverse_inertia.data();
  }
};

[[nodiscard]] NodeArrays make_node_arrays(const ShellMesh& mesh, const ElementArrays& elements);

struct NodeStep {
  double length;   ///< s
  double damping;  ///< 1/s
  Vec3 gravity;    ///< m/s^2
  /// Share of the kick that is taken off before it: 1/2 makes nodes at rest start from rest at the moment of
  /// the forces, not half a step before, which would make the fastest modes swing further than they stood.
  /// Otherwise 0.
  double taken_off = 0;
  /// Corners to gather instead of all: as in NodeArrays, of some elements.
  const Index *first_corner = nullptr, *corner_offset = nullptr;
};

/// Velocities to t + dt/2 under internal, external (force, N, and moment, N m, or null, per node) and damping
/// forces, then positions to t + dt. Different blocks may run at the same time.
void update_node_block(NodeArrays& nodes, const ElementArrays& elements, const Vec3Array& force,
                       const Vec3Array* moment, const NodeStep& step, std::size_t block);

}  // namespace tuft::fe

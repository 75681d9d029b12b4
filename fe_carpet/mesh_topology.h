#pragma once
/// What follows from how the quads of a carpet hang together.
#include "fe_carpet/carpet.h"

namespace tuft::fe {

/// Sets surface and surface_count from material (0 backing, anything else fibre): strands are the connected
/// parts of the fibre quads, where nodes that are the backing's connect nothing.
void number_surfaces(ShellMesh& mesh);

/// Clamps the nodes on sides of exactly one backing quad, and no others: the edge, and the rims of holes.
void clamp_backing_edge(ShellMesh& mesh);

/// Per node: 1 where a backing quad has it.
[[nodiscard]] std::vector<std::uint8_t> nodes_of_backing(const ShellMesh& mesh);

/// The backing alone, its nodes in the same order.
[[nodiscard]] ShellMesh without_fibres(const ShellMesh& mesh);

/// What a carpet amounts to.
struct MeshSummary {
  std::size_t strands = 0;
  std::size_t tufts = 0;  ///< groups of strands that share nodes of the backing
  std::size_t backing_elements = 0, fibre_elements = 0, nodes = 0, clamped_nodes = 0;
  double backing_mass = 0, fibre_mass = 0;  ///< kg
};

/// materials[i] is the material with index i of the mesh. Mass is area x thickness x density.
[[nodiscard]] MeshSummary summarise(const ShellMesh& mesh, std::span<const ShellMaterial> materials);

}  // namespace tuft::fe

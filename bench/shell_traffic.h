#pragma once
/// Bytes that a step of the shells moves, counted from the layout of its arrays: what crosses the bus when
/// nothing stays in a cache from the element loop to the node loop, nor from one step to the next.
#include "fe_carpet/element_arrays.h"

namespace tuft::bench {

/// Reads and writes once each; a whole line that is only written is read before (write allocate).
inline double bytes_per_element_step(const fe::ShellMesh& mesh, const ShellMaterial& material,
                                     const ShellSection& section) {
  fe::CarpetOptions options;
  options.section = section;
  const fe::ElementArrays elements = fe::make_element_arrays(mesh, {material}, options);
  constexpr double value = sizeof(double), index = sizeof(Index);
  const auto rows = static_cast<double>(elements.family.front().rows);
  const double corner_forces = 4 * 6 * value;
  // Element loop: corners, state and thickness read and written, forces written; node loop: forces read.
  const double of_element =
      4 * index + 2 * value * (rows + 1) + 2 * corner_forces + corner_forces + 4 * index;
  // Position, velocity and spin read by the elements, read and written by the nodes; masses, their inverses,
  // the mark of what is free, and the load.
  const double of_node = 9 * value + 2 * 9 * value + 4 * value + value + 3 * value + index;
  return of_element +
         of_node * static_cast<double>(mesh.nodes.size()) / static_cast<double>(mesh.quads.size());
}

}  // namespace tuft::bench

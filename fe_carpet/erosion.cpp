#include "fe_carpet/erosion.h"

#include <algorithm>

#include "fe_carpet/element_arrays.h"

namespace tuft::fe {

void empty_slot(ElementArrays& elements, std::size_t slot, Index first_spare_node) {
  const std::size_t batch = slot / lanes, lane = slot % lanes;
  for (std::size_t corner = 0; corner < 4; ++corner) {
    elements.node[corner][slot] = first_spare_node + static_cast<Index>(corner);
    double* force = &elements.forces[batch * batch_values + corner * corner_values + lane];
    for (std::size_t component = 0; component < 6; ++component) force[component * lanes] = 0;
  }
  elements.element[slot] = -1;
  elements.thickness[slot] = elements.mass[slot] = 0;
  elements.inertia_ratio[slot] = 1;
  double* state = &elements.state[elements.state_of_batch(batch) + lane];
  const std::size_t rows = elements.family[static_cast<std::size_t>(elements.batch_family[batch])].rows;
  for (std::size_t row = 0; row < rows; ++row) state[row * lanes] = 0;
}

Vec3Array positions_with_spares(const ShellMesh& mesh, const ElementArrays& elements) {
  Vec3Array positions = mesh.nodes;
  if (can_fail(elements))
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)})
      positions.push_back(corner);
  return positions;
}

ErodedWork erode_marked(ElementArrays& elements, Index first_spare_node) {
  ErodedWork taken;
  for (std::size_t b = 0; b < elements.block.size(); ++b) {
    if (!elements.failing[b]) continue;
    elements.failing[b] = 0;
    const ElementBlock& block = elements.block[b];
    const ElementFamily& family = elements.family[block.family];
    for (std::size_t slot = block.first_batch * lanes; slot < block.last_batch * lanes; ++slot) {
      if (!elements.failed[slot]) continue;
      elements.failed[slot] = 0;
      const std::size_t batch = slot / lanes;
      const double* followed = &elements.state[elements.state_of_batch(batch) +
                                               (family.rows - family.failure_rows()) * lanes + slot % lanes];
      const double strain = followed[0], hourglass = followed[lanes];
      elements.strain_work[b] -= strain;
      elements.hourglass_work[b] -= hourglass;
      taken.strain += strain - elements.last_half_work[slot];
      taken.hourglass += hourglass;
      elements.eroded[static_cast<std::size_t>(elements.element[slot])] = 1;
      ++elements.eroded_count;
      empty_slot(elements, slot, first_spare_node);
    }
  }
  return taken;
}

}  // namespace tuft::fe

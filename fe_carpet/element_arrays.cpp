#include "fe_carpet/element_arrays.h"

#include "fe_carpet/stable_step.h"

namespace tuft::fe {
namespace {

Triple<double> corner_position(const ShellMesh& mesh, std::size_t element, std::size_t corner) {
  const auto n = static_cast<std::size_t>(mesh.quads[element][corner]);
  return {mesh.nodes.x[n], mesh.nodes.y[n], mesh.nodes.z[n]};
}

double reference_area(const ShellMesh& mesh, std::size_t e) {
  return shell_geometry(diagonal_form(corner_position(mesh, e, 0), corner_position(mesh, e, 1),
                                      corner_position(mesh, e, 2), corner_position(mesh, e, 3)))
      .area;
}

/// Slots in batches of one material, elements of a material in the order of the mesh.
void fill_slots(const ShellMesh& mesh, Index material_count, ElementArrays& arrays) {
  std::vector<std::vector<Index>> of_material(static_cast<std::size_t>(material_count));
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    of_material[static_cast<std::size_t>(mesh.material[e])].push_back(static_cast<Index>(e));
  arrays.slot.resize(mesh.quads.size());
  for (std::size_t m = 0; m < of_material.size(); ++m)
    for (std::size_t first = 0; first < of_material[m].size(); first += lanes) {
      arrays.batch_material.push_back(static_cast<Index>(m));
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const bool padding = first + lane >= of_material[m].size();
        const Index e = of_material[m][padding ? first : first + lane];
        if (!padding) arrays.slot[static_cast<std::size_t>(e)] = static_cast<Index>(arrays.element.size());
        for (std::size_t corner = 0; corner < 4; ++corner)
          arrays.node[corner].push_back(mesh.quads[static_cast<std::size_t>(e)][corner]);
        arrays.element.push_back(padding ? -1 : e);
      }
    }
}

}  // namespace

ElementArrays make_element_arrays(const ShellMesh& mesh, const std::vector<ShellMaterial>& materials,
                                  const CarpetOptions& options) {
  ElementArrays arrays;
  arrays.thickness_points = options.thickness_points;
  arrays.element_count = mesh.quads.size();
  for (const ShellMaterial& material : materials)
    arrays.law.push_back(plane_stress_law(material, options.hourglass_coefficient));
  fill_slots(mesh, static_cast<Index>(materials.size()), arrays);

  const std::size_t slots = arrays.element.size();
  arrays.batch_count = slots / lanes;
  arrays.block_count = (arrays.batch_count + batches_per_block - 1) / batches_per_block;
  arrays.thickness.assign(slots, 0.0);
  arrays.mass.assign(slots, 0.0);
  arrays.inertia_ratio.assign(slots, 1.0);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    const auto slot = static_cast<std::size_t>(arrays.slot[e]);
    const double area = reference_area(mesh, e), thickness = mesh.thickness[e];
    arrays.thickness[slot] = thickness;
    arrays.mass[slot] = materials[static_cast<std::size_t>(mesh.material[e])].density * thickness * area;
    arrays.inertia_ratio[slot] = rotary_inertia_ratio(area, thickness);
  }
  arrays.state.assign(arrays.batch_count * state_values(options.thickness_points) * lanes, 0.0);
  arrays.forces.assign(arrays.batch_count * batch_values, 0.0);
  arrays.strain_work.assign(arrays.block_count, 0.0);
  arrays.hourglass_work.assign(arrays.block_count, 0.0);
  return arrays;
}

}  // namespace tuft::fe

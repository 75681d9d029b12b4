#include "fe_carpet/element_arrays.h"

#include "core/error.h"
#include "fe_carpet/erosion.h"
#include "fe_carpet/stable_step.h"

namespace tuft::fe {
namespace {

Triple<double> corner_position(const ShellMesh& mesh, std::size_t element, std::size_t corner) {
  const auto n = static_cast<std::size_t>(mesh.quads[element][corner]);
  return {mesh.nodes.x[n], mesh.nodes.y[n], mesh.nodes.z[n]};
}

ShellFrame<double> reference_frame(const ShellMesh& mesh, std::size_t e) {
  return shell_frame(corner_modes(corner_position(mesh, e, 0), corner_position(mesh, e, 1),
                                  corner_position(mesh, e, 2), corner_position(mesh, e, 3)));
}

SectionLaw make_law(const ShellMaterial& material) {
  if (material.orthotropic()) return OrthotropicTable{{}, stiffer_isotropic_law(material)};
  if (material.relaxation.empty()) return instantaneous_law(material);
  return viscoelastic_law(material);
}

/// Slots in batches of one family, elements of a family in the order of the mesh.
void fill_slots(const ShellMesh& mesh, ElementArrays& arrays) {
  std::vector<std::vector<Index>> of_family(arrays.family.size());
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    of_family[static_cast<std::size_t>(mesh.material[e])].push_back(static_cast<Index>(e));
  arrays.slot.resize(mesh.quads.size());
  std::size_t state = 0;
  for (std::size_t m = 0; m < of_family.size(); ++m) {
    ElementFamily& family = arrays.family[m];
    family.first_batch = arrays.batch_family.size();
    family.batch_count = (of_family[m].size() + lanes - 1) / lanes;
    family.first_state = state;
    state += family.batch_count * family.rows * lanes;
    for (std::size_t b = 0; b < family.batch_count; ++b) {
      arrays.batch_family.push_back(static_cast<Index>(m));
      const std::size_t first = b * lanes;
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const bool padding = first + lane >= of_family[m].size();
        const Index e = of_family[m][padding ? first : first + lane];
        if (!padding) arrays.slot[static_cast<std::size_t>(e)] = static_cast<Index>(arrays.element.size());
        for (std::size_t corner = 0; corner < 4; ++corner)
          arrays.node[corner].push_back(mesh.quads[static_cast<std::size_t>(e)][corner]);
        arrays.element.push_back(padding ? -1 : e);
      }
    }
    for (std::size_t b = 0; b < family.batch_count; b += batches_per_block)
      arrays.block.push_back({m, family.first_batch + b,
                              family.first_batch + std::min(family.batch_count, b + batches_per_block)});
  }
  arrays.batch_count = arrays.batch_family.size();
  arrays.state.assign(state, 0.0);
}

/// Padding has the stiffness of no material, zero, and a compliance that nothing divides by zero for.
void fill_orthotropic(const ShellMesh& mesh, const std::vector<ShellMaterial>& materials,
                      ElementArrays& arrays) {
  for (std::size_t m = 0; m < arrays.family.size(); ++m) {
    ElementFamily& family = arrays.family[m];
    auto* table = std::get_if<OrthotropicTable>(&family.law);
    if (!table) continue;
    const Triple<double> along{materials[m].along[0], materials[m].along[1], materials[m].along[2]};
    table->stiffness.assign(family.batch_count * OrthotropicTable::values * lanes, 0.0);
    for (std::size_t b = 0; b < family.batch_count; ++b)
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const Index e = arrays.element[(family.first_batch + b) * lanes + lane];
        const auto put = [&](const std::array<double, OrthotropicTable::values>& values) {
          for (std::size_t v = 0; v < values.size(); ++v)
            table->stiffness[(b * values.size() + v) * lanes + lane] = values[v];
        };
        if (e < 0) {
          put({0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1});
          continue;
        }
        const LocalAxes<double> axes = reference_frame(mesh, static_cast<std::size_t>(e)).axes;
        const double out = dot(axes.e3, along);
        if (!(out * out < 0.99 * dot(along, along)))
          throw_input_error(
              "shell material {}: its direction along stands upright on element {}; give one in the plane of "
              "its "
              "shells",
              m, e);
        const OrthotropicLaw<double> law =
            orthotropic_law(materials[m], std::atan2(dot(axes.e2, along), dot(axes.e1, along)));
        put({law.q11, law.q12, law.q22, law.q16, law.q26, law.q66, law.transverse_shear, law.shear,
             law.thinning, law.s11, law.s12, law.s22, law.s16, law.s26, law.s66});
      }
  }
}

}  // namespace

ElementArrays make_element_arrays(const ShellMesh& mesh, const std::vector<ShellMaterial>& materials,
                                  const CarpetOptions& options) {
  ElementArrays arrays;
  arrays.element_count = mesh.quads.size();
  for (std::size_t m = 0; m < materials.size(); ++m) {
    ElementFamily family;
    family.section = m < options.sections.size() ? options.sections[m] : options.section;
    family.law = make_law(materials[m]);
    family.failure_strain = materials[m].failure_strain;
    choose_element_function(family);
    arrays.family.push_back(std::move(family));
  }
  fill_slots(mesh, arrays);
  fill_orthotropic(mesh, materials, arrays);

  const std::size_t slots = arrays.element.size();
  arrays.thickness.assign(slots, 0.0);
  arrays.mass.assign(slots, 0.0);
  arrays.inertia_ratio.assign(slots, 1.0);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    const auto slot = static_cast<std::size_t>(arrays.slot[e]);
    const double area = reference_frame(mesh, e).area, thickness = mesh.thickness[e];
    arrays.thickness[slot] = thickness;
    arrays.mass[slot] = materials[static_cast<std::size_t>(mesh.material[e])].density * thickness * area;
    arrays.inertia_ratio[slot] = rotary_inertia_ratio(area, thickness);
  }
  arrays.forces.assign(arrays.batch_count * batch_values, 0.0);
  arrays.strain_work.assign(arrays.block.size(), 0.0);
  arrays.hourglass_work.assign(arrays.block.size(), 0.0);
  arrays.uprightness.assign(arrays.block.size(), 1.0);
  if (can_fail(arrays)) {
    arrays.failing.assign(arrays.block.size(), 0);
    arrays.failed.assign(slots, 0);
    arrays.last_half_work.assign(slots, 0.0);
    arrays.eroded.assign(arrays.element_count, 0);
    // Padding copies an element that may go and leave its nodes anywhere.
    for (std::size_t slot = 0; slot < slots; ++slot)
      if (arrays.element[slot] < 0) empty_slot(arrays, slot, static_cast<Index>(mesh.nodes.size()));
  }
  return arrays;
}

}  // namespace tuft::fe

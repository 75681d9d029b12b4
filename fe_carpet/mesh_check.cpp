#include <cmath>
#include <string>

#include "core/error.h"
#include "fe_carpet/carpet.h"
#include "fe_carpet/quad_shape.h"

namespace tuft::fe {
namespace {

void check_sizes(const ShellMesh& mesh) {
  const std::size_t elements = mesh.quads.size();
  if (elements == 0) throw_input_error("carpet mesh: it has no elements");
  if (mesh.thickness.size() != elements || mesh.material.size() != elements ||
      mesh.surface.size() != elements)
    throw_input_error(
        "carpet mesh: {} elements, but {} thicknesses, {} materials and {} surfaces; give one of each per "
        "element",
        elements, mesh.thickness.size(), mesh.material.size(), mesh.surface.size());
  if (mesh.nodes.y.size() != mesh.nodes.size() || mesh.nodes.z.size() != mesh.nodes.size() ||
      mesh.clamped.size() != mesh.nodes.size())
    throw_input_error(
        "carpet mesh: {} x, {} y, {} z coordinates and {} clamp marks; give one of each per node",
        mesh.nodes.x.size(), mesh.nodes.y.size(), mesh.nodes.z.size(), mesh.clamped.size());
}

void check_constraints(const ShellMesh& mesh) {
  if (!mesh.constraints.empty() && mesh.constraints.size() != mesh.nodes.size())
    throw_input_error("carpet mesh: {} constraints for {} nodes; give one per node, or none",
                      mesh.constraints.size(), mesh.nodes.size());
}

void check_indices(const ShellMesh& mesh, std::size_t e) {
  const auto& quad = mesh.quads[e];
  for (std::size_t i = 0; i < 4; ++i) {
    if (quad[i] < 0 || static_cast<std::size_t>(quad[i]) >= mesh.nodes.size())
      throw_input_error("carpet mesh: element {} names node {}, but nodes are numbered 0 to {}", e, quad[i],
                        mesh.nodes.size() - 1);
    for (std::size_t j = 0; j < i; ++j)
      if (quad[i] == quad[j])
        throw_input_error("carpet mesh: element {} names node {} twice; triangles are not supported", e,
                          quad[i]);
  }
  if (mesh.material[e] < 0) throw_input_error("carpet mesh: element {} has material {}", e, mesh.material[e]);
  if (mesh.surface[e] < 0 || mesh.surface[e] >= mesh.surface_count)
    throw_input_error("carpet mesh: element {} belongs to surface {}, but surfaces are numbered 0 to {}", e,
                      mesh.surface[e], mesh.surface_count - 1);
  if (!(mesh.thickness[e] > 0) || !std::isfinite(mesh.thickness[e]))
    throw_input_error("carpet mesh: element {} has thickness {} m; it must be positive", e,
                      mesh.thickness[e]);
}

void check_shape(const ShellMesh& mesh, std::size_t e) {
  std::array<Vec3, 4> corner;
  for (std::size_t i = 0; i < 4; ++i) {
    corner[i] = mesh.nodes[static_cast<std::size_t>(mesh.quads[e][i])];
    if (!corner[i].allFinite())
      throw_input_error("carpet mesh: node {} of element {} is at ({}, {}, {})", mesh.quads[e][i], e,
                        corner[i].x(), corner[i].y(), corner[i].z());
  }
  const QuadFault fault = find_quad_fault(corner);
  if (fault.kind == QuadFault::Kind::coincident_corners)
    throw_input_error("carpet mesh: element {}: nodes {} and {} coincide ({} m apart); merge or move them", e,
                      mesh.quads[e][fault.first], mesh.quads[e][fault.second], fault.distance);
  if (fault.kind == QuadFault::Kind::not_convex)
    throw_input_error(
        "carpet mesh: element {} is degenerate, concave or folded at node {}; every corner must be under "
        "180 degrees",
        e, mesh.quads[e][fault.first]);
}

}  // namespace

void check_mesh(const ShellMesh& mesh) {
  check_sizes(mesh);
  check_constraints(mesh);
  std::vector<std::uint8_t> used(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    check_indices(mesh, e);
    check_shape(mesh, e);
    for (const Index node : mesh.quads[e]) used[static_cast<std::size_t>(node)] = 1;
  }
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i])
      throw_input_error("carpet mesh: node {} belongs to no element and so has no mass; remove it", i);
}

}  // namespace tuft::fe

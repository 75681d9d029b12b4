/// Formats to work on: Gmsh 4.1 ("Gmsh file formats" in its reference manual) and LS-DYNA keywords (Keyword
/// User's Manual, volumes I and II).
#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include "core/error.h"
#include "fe_carpet/mesh_export.h"

namespace tuft::fe {
namespace {

constexpr std::array<const char*, 2> part_names{"backing", "fibre"};  // by material

template <class... Args>
void append(std::string& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

std::size_t part_of(const ShellMesh& mesh, std::size_t e) {
  return mesh.material[e] == 0 ? 0 : 1;
}

bool has_part(const ShellMesh& mesh, std::size_t part) {
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    if (part_of(mesh, e) == part) return true;
  return false;
}

/// The part's one thickness, or nothing when its elements differ.
std::optional<double> common_thickness(const ShellMesh& mesh, std::size_t part) {
  std::optional<double> common;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (part_of(mesh, e) != part) continue;
    if (common && *common != mesh.thickness[e]) return std::nullopt;
    common = mesh.thickness[e];
  }
  return common;
}

/// As many digits as the field of a card holds.
std::string in_field(double value, int width) {
  for (int digits = width; digits > 1; --digits) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    if (static_cast<int>(text.size()) <= width) return fmt::format("{:>{}}", text, width);
  }
  return fmt::format("{:{}.0e}", value, width);
}

void print_elements(std::string& text, const ShellMesh& mesh, bool with_thickness, double unit) {
  text += with_thickness ? "*ELEMENT_SHELL_THICKNESS\n" : "*ELEMENT_SHELL\n";
  text += "$#   eid     pid      n1      n2      n3      n4\n";
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    append(text, "{:8}{:8}", e + 1, part_of(mesh, e) + 1);
    for (const Index node : mesh.quads[e]) append(text, "{:8}", node + 1);
    text += '\n';
    if (!with_thickness) continue;
    for (int corner = 0; corner < 4; ++corner) append(text, " {}", in_field(mesh.thickness[e] / unit, 15));
    text += '\n';
  }
}

void print_parts(std::string& text, const ShellMesh& mesh, std::span<const ShellMaterial> materials,
                 double unit) {
  // Pa = kg/(m s^2) in kg, ms and the unit of length.
  const double pressure = unit * 1e-6, density = unit * unit * unit;
  for (std::size_t part = 0; part < part_names.size(); ++part) {
    if (!has_part(mesh, part)) continue;
    const std::size_t id = part + 1;
    append(text, "*PART\n{}\n$#     pid     secid       mid\n{:10}{:10}{:10}\n", part_names[part], id, id,
           id);
    append(text, "*SECTION_SHELL\n$#   secid    elform      shrf       nip\n{:10}{:10}{:>10}{:10}\n", id, 2,
           "0.833333", 3);
    const std::string thickness = in_field(common_thickness(mesh, part).value_or(0) / unit, 10);
    append(text, "$#      t1        t2        t3        t4\n{0}{0}{0}{0}\n", thickness);
    if (part >= materials.size()) continue;
    const ShellMaterial& material = materials[part];
    append(text, "*MAT_ELASTIC\n$#     mid        ro         e        pr\n{:10}{}{}{}\n", id,
           in_field(material.density * density, 10), in_field(material.young_modulus * pressure, 10),
           in_field(material.poisson_ratio, 10));
  }
}

void print_clamps(std::string& text, const ShellMesh& mesh) {
  std::string nodes;
  std::size_t count = 0;
  for (std::size_t n = 0; n < mesh.clamped.size(); ++n) {
    if (mesh.clamped[n] == 0) continue;
    append(nodes, "{:10}", n + 1);
    if (++count % 8 == 0) nodes += '\n';
  }
  if (count == 0) return;
  if (count % 8 != 0) nodes += '\n';
  text += "*SET_NODE_LIST_TITLE\nclamped edge of the backing\n$#     sid\n         1\n" + nodes;
  text +=
      "*BOUNDARY_SPC_SET\n$#    nsid       cid      dofx      dofy      dofz     dofrx     dofry     dofrz\n";
  append(text, "{:10}{:10}{:10}{:10}{:10}{:10}{:10}{:10}\n", 1, 0, 1, 1, 1, 1, 1, 1);
}

/// Low and high corner of the elements of a part, in the file's unit.
std::array<Vec3, 2> bounds(const ShellMesh& mesh, std::size_t part, double unit) {
  std::optional<std::array<Vec3, 2>> box;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (part_of(mesh, e) != part) continue;
    for (const Index node : mesh.quads[e]) {
      const Vec3 p = mesh.nodes[static_cast<std::size_t>(node)] / unit;
      if (!box) box = {p, p};
      (*box)[0] = (*box)[0].cwiseMin(p);
      (*box)[1] = (*box)[1].cwiseMax(p);
    }
  }
  return *box;
}

void print_gmsh_nodes(std::string& text, const ShellMesh& mesh, std::size_t entity, double unit) {
  const std::size_t count = mesh.nodes.size();
  append(text, "$Nodes\n1 {0} 1 {0}\n2 {1} 0 {0}\n", count, entity);
  for (std::size_t n = 0; n < count; ++n) append(text, "{}\n", n + 1);
  for (std::size_t n = 0; n < count; ++n)
    append(text, "{} {} {}\n", mesh.nodes.x[n] / unit, mesh.nodes.y[n] / unit, mesh.nodes.z[n] / unit);
  text += "$EndNodes\n";
}

/// Blocks of elements that follow one another in the same part, so that their order is kept.
void print_gmsh_elements(std::string& text, const ShellMesh& mesh) {
  std::string blocks;
  std::size_t count = 0;
  for (std::size_t e = 0; e < mesh.quads.size();) {
    std::size_t end = e;
    while (end < mesh.quads.size() && part_of(mesh, end) == part_of(mesh, e)) ++end;
    constexpr int quad = 3;
    append(blocks, "2 {} {} {}\n", part_of(mesh, e) + 1, quad, end - e);
    ++count;
    for (; e < end; ++e) {
      append(blocks, "{}", e + 1);
      for (const Index node : mesh.quads[e]) append(blocks, " {}", node + 1);
      blocks += '\n';
    }
  }
  append(text, "$Elements\n{0} {1} 1 {1}\n", count, mesh.quads.size());
  text += blocks + "$EndElements\n";
}

}  // namespace

std::string gmsh_text(const ShellMesh& mesh, const MeshExportOptions& options) {
  std::string text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  append(text, "$Comments\ntuft carpet, lengths in {}\n$EndComments\n", options.unit_name);
  std::vector<std::size_t> parts;
  for (std::size_t part = 0; part < part_names.size(); ++part)
    if (has_part(mesh, part)) parts.push_back(part);
  append(text, "$PhysicalNames\n{}\n", parts.size());
  for (const std::size_t part : parts) append(text, "2 {} \"{}\"\n", part + 1, part_names[part]);
  append(text, "$EndPhysicalNames\n$Entities\n0 0 {} 0\n", parts.size());
  for (const std::size_t part : parts) {
    const auto [low, high] = bounds(mesh, part, options.unit);
    append(text, "{0} {1} {2} {3} {4} {5} {6} 1 {0} 0\n", part + 1, low.x(), low.y(), low.z(), high.x(),
           high.y(), high.z());
  }
  text += "$EndEntities\n";
  print_gmsh_nodes(text, mesh, parts.empty() ? 1 : parts.front() + 1, options.unit);
  print_gmsh_elements(text, mesh);
  append(text, "$ElementData\n1\n\"thickness\"\n1\n0\n3\n0\n1\n{}\n", mesh.quads.size());
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    append(text, "{} {}\n", e + 1, mesh.thickness[e] / options.unit);
  text += "$EndElementData\n";
  return text;
}

std::string keyword_text(const ShellMesh& mesh, std::span<const ShellMaterial> materials,
                         const MeshExportOptions& options) {
  std::string text = "*KEYWORD\n";
  append(text, "$ tuft carpet; units: {}, ms, kg\n*TITLE\ntuft carpet\n", options.unit_name);
  print_parts(text, mesh, materials, options.unit);
  bool differ = false;
  for (std::size_t part = 0; part < part_names.size(); ++part)
    differ = differ || (has_part(mesh, part) && !common_thickness(mesh, part));
  text += "*NODE\n$#   nid               x               y               z\n";
  // 15 of the 16 columns, so that fields stay apart for readers that split at blanks.
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    append(text, "{:8} {} {} {}\n", n + 1, in_field(mesh.nodes.x[n] / options.unit, 15),
           in_field(mesh.nodes.y[n] / options.unit, 15), in_field(mesh.nodes.z[n] / options.unit, 15));
  print_elements(text, mesh, differ, options.unit);
  print_clamps(text, mesh);
  text += "*END\n";
  return text;
}

}  // namespace tuft::fe

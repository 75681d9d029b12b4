/// Formats to look at: legacy VTK 3.0 and VTU 0.1, ASCII, after "VTK File Formats".
#include "fe_carpet/mesh_export.h"

#include <iterator>

#include "core/error.h"
#include "fe_carpet/mesh_file.h"

namespace tuft::fe {
namespace {

constexpr int vtk_quad = 9;  // VTK_QUAD

template <class... Args>
void append(std::string& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

void print_points(std::string& text, const ShellMesh& mesh, double unit) {
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    append(text, "{} {} {}\n", mesh.nodes.x[n] / unit, mesh.nodes.y[n] / unit, mesh.nodes.z[n] / unit);
}

template <class Value>
void print_lines(std::string& text, const std::vector<Value>& values) {
  for (const Value value : values) append(text, "{}\n", value);
}

std::vector<double> in_unit(std::vector<double> lengths, double unit) {
  for (double& length : lengths) length /= unit;
  return lengths;
}

template <class Value>
void print_data_array(std::string& text, const char* type, const char* name,
                      const std::vector<Value>& values) {
  append(text, "<DataArray type=\"{}\" Name=\"{}\" format=\"ascii\">\n", type, name);
  print_lines(text, values);
  text += "</DataArray>\n";
}

}  // namespace

std::string vtk_text(const ShellMesh& mesh, const MeshExportOptions& options) {
  std::string text = "# vtk DataFile Version 3.0\n";
  append(text, "tuft carpet, lengths in {}\nASCII\nDATASET UNSTRUCTURED_GRID\n", options.unit_name);
  append(text, "POINTS {} double\n", mesh.nodes.size());
  print_points(text, mesh, options.unit);
  append(text, "CELLS {} {}\n", mesh.quads.size(), 5 * mesh.quads.size());
  for (const auto& quad : mesh.quads) append(text, "4 {}\n", fmt::join(quad, " "));
  append(text, "CELL_TYPES {}\n", mesh.quads.size());
  print_lines(text, std::vector<int>(mesh.quads.size(), vtk_quad));
  append(text, "CELL_DATA {}\nSCALARS surface int 1\nLOOKUP_TABLE default\n", mesh.quads.size());
  print_lines(text, mesh.surface);
  text += "SCALARS material int 1\nLOOKUP_TABLE default\n";
  print_lines(text, mesh.material);
  text += "SCALARS thickness double 1\nLOOKUP_TABLE default\n";
  print_lines(text, in_unit(mesh.thickness, options.unit));
  append(text, "POINT_DATA {}\nSCALARS clamped int 1\nLOOKUP_TABLE default\n", mesh.nodes.size());
  print_lines(text, std::vector<int>(mesh.clamped.begin(), mesh.clamped.end()));
  return text;
}

std::string vtu_text(const ShellMesh& mesh, const MeshExportOptions& options) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n";
  append(text, "<!-- tuft carpet, lengths in {} -->\n<UnstructuredGrid>\n", options.unit_name);
  append(text, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", mesh.nodes.size(), mesh.quads.size());
  text += "<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  print_points(text, mesh, options.unit);
  text +=
      "</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n";
  for (const auto& quad : mesh.quads) append(text, "{}\n", fmt::join(quad, " "));
  text += "</DataArray>\n";
  std::vector<std::size_t> ends(mesh.quads.size());
  for (std::size_t e = 0; e < ends.size(); ++e) ends[e] = 4 * (e + 1);
  print_data_array(text, "Int64", "offsets", ends);
  print_data_array(text, "UInt8", "types", std::vector<int>(mesh.quads.size(), vtk_quad));
  text += "</Cells>\n<CellData>\n";
  print_data_array(text, "Int32", "surface", mesh.surface);
  print_data_array(text, "Int32", "material", mesh.material);
  print_data_array(text, "Float64", "thickness", in_unit(mesh.thickness, options.unit));
  text += "</CellData>\n<PointData>\n";
  print_data_array(text, "UInt8", "clamped", std::vector<int>(mesh.clamped.begin(), mesh.clamped.end()));
  text += "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return text;
}

std::string export_mesh_text(const ShellMesh& mesh, std::span<const ShellMaterial> materials,
                             const std::string& ending, const MeshExportOptions& options) {
  const std::string format = in_lower_case(ending);
  if (format == ".vtk") return vtk_text(mesh, options);
  if (format == ".vtu") return vtu_text(mesh, options);
  if (format == ".msh") return gmsh_text(mesh, options);
  if (format == ".k" || format == ".key" || format == ".dyn") return keyword_text(mesh, materials, options);
  throw_input_error("a mesh cannot be written as '{}'; end the name in .vtk, .vtu, .msh, .k, .key or .dyn",
                    printable(ending));
}

}  // namespace tuft::fe

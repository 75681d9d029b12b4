#pragma once
/// Carpets for other programs: legacy VTK and VTU to look at, Gmsh and LS-DYNA to work on. What is written as
/// .msh and .k comes back by import_mesh, to the digits printed.
#include <span>
#include <string>

#include "core/scene.h"
#include "fe_carpet/carpet.h"

namespace tuft::fe {

struct MeshExportOptions {
  double unit = 1e-3;            ///< m, length of the file's unit; > 0
  std::string unit_name = "mm";  ///< said in the file where the format has room
};

/// The file's text; the ending decides the format: ".vtk", ".vtu", ".msh" (Gmsh 4.1), ".k", ".key", ".dyn".
/// materials[i] is the material with index i of the mesh; LS-DYNA gets them as *MAT_ELASTIC in kg, ms and the
/// file's unit of length. Throws InputError for another ending.
[[nodiscard]] std::string export_mesh_text(const ShellMesh& mesh, std::span<const ShellMaterial> materials,
                                           const std::string& ending, const MeshExportOptions& options);

/// The formats one by one.
[[nodiscard]] std::string vtk_text(const ShellMesh& mesh, const MeshExportOptions& options);
[[nodiscard]] std::string vtu_text(const ShellMesh& mesh, const MeshExportOptions& options);
[[nodiscard]] std::string gmsh_text(const ShellMesh& mesh, const MeshExportOptions& options);
[[nodiscard]] std::string keyword_text(const ShellMesh& mesh, std::span<const ShellMaterial> materials,
                                       const MeshExportOptions& options);

}  // namespace tuft::fe

#pragma once
/// Carpet meshes made elsewhere: Gmsh `.msh` and LS-DYNA keyword files. What is understood and what is not:
/// docs/carpet_meshes.md.
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene.h"
#include "fe_carpet/carpet.h"

namespace tuft::fe {

struct MeshImportOptions {
  double unit = 1e-3;  ///< m, length of the file's unit; > 0
  double shift_z = 0;  ///< m, added to every node's height
  UndecidedParts undecided_parts = UndecidedParts::refuse;
  double backing_thickness = 0;  ///< m, where the file gives none; 0: the file must
  double strand_thickness = 0;   ///< m, the same for fibres
};

struct ImportedMesh {
  /// Nodes and elements in the order of their numbers in the file; material 0 is the backing, 1 the fibre;
  /// surfaces 1..n the strands, in the order of their first elements. Clamped are the nodes on free edges of
  /// the backing.
  ShellMesh mesh;
  std::vector<std::int64_t> node_ids;  ///< numbers in the file, one per node of the mesh
  std::vector<std::string> notes;      ///< for the user: what was left out
};

/// Reads a mesh; the ending of the name decides the format: .msh, or .k, .key, .dyn. Throws InputError naming
/// file and line for whatever cannot be used.
[[nodiscard]] ImportedMesh import_mesh(const std::filesystem::path& file, const MeshImportOptions& options);
/// The same from text; `name` stands for the file.
[[nodiscard]] ImportedMesh import_mesh_text(std::string_view text, const std::string& name,
                                            const MeshImportOptions& options);

/// The carpet of a scene whose design names a mesh file (design.mesh.file not empty). Also throws InputError
/// when the file is not the one that the scene was resolved with, or its backing does not fill the patch of
/// `size` centred on the origin between z = 0 and design.backing_thickness, or a strand leaves the patch.
/// `with_fibres` false: the backing alone.
[[nodiscard]] ImportedMesh import_carpet(const CarpetDesign& design, std::array<double, 2> size,
                                         bool with_fibres);

}  // namespace tuft::fe

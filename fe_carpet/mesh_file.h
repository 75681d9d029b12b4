#pragma once
/// A mesh as its file tells it, before it becomes a carpet: what the readers of all formats fill in and
/// mesh_import.cpp makes sense of. Lengths are in the file's own unit.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/vector.h"

namespace tuft::fe {

using FileId = std::int64_t;  ///< number of a node, element or part in the file

struct FileNode {
  FileId id = 0;
  std::size_t line = 0;
  Vec3 position{0, 0, 0};
};

struct FileQuad {
  FileId id = 0;
  std::size_t line = 0;
  std::array<FileId, 4> nodes{};
  std::size_t part = 0;               ///< index into FileMesh::parts
  std::optional<double> thickness{};  ///< its own, where the file gives one
};

struct FilePart {
  std::string label;                  ///< for messages: "part 3", "physical surface 2"
  std::string name;                   ///< its title in the file; decides backing or fibre by its words
  std::optional<double> thickness{};  ///< of all its elements
};

struct FileMesh {
  std::string file;
  std::vector<FileNode> nodes;
  std::vector<FileQuad> quads;
  std::vector<FilePart> parts;
  std::vector<std::string> notes;  ///< for the user: what was left out
};

/// Gmsh `.msh`, ASCII, format 4.1 or 2.2 (Gmsh reference manual, "Gmsh file formats"). Throws InputError.
[[nodiscard]] FileMesh read_gmsh_mesh(std::string_view text, const std::string& file);
/// LS-DYNA keyword file (LS-DYNA Keyword User's Manual, volume I). Throws InputError.
[[nodiscard]] FileMesh read_keyword_mesh(std::string_view text, const std::string& file);

/// One line for the user: file:line, what, the value as found (shortened; left out when empty), what to do.
[[noreturn]] void fail_in_mesh_file(const std::string& file, std::size_t line, std::string_view problem,
                                    std::string_view value, std::string_view advice);

/// The whole of `text` as a number; nothing when it is none, does not fit, or is not finite.
[[nodiscard]] std::optional<FileId> whole_number(std::string_view text);
/// Also with the exponent letters of Fortran: 1.0d-3.
[[nodiscard]] std::optional<double> real_number(std::string_view text);

[[nodiscard]] std::string in_lower_case(std::string_view text);
/// A user's text fit for a one-line message: shortened, nothing unprintable.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace tuft::fe

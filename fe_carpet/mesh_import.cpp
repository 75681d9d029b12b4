#include "fe_carpet/mesh_import.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/scene_files.h"
#include "core/scene_reader.h"
#include "core/units.h"
#include "fe_carpet/mesh_file.h"
#include "fe_carpet/mesh_topology.h"
#include "fe_carpet/quad_shape.h"

namespace tuft::fe {
namespace {

constexpr double farthest = 1000;  // m: beyond it the unit is wrong
constexpr Index backing_material = 0, fibre_material = 1;

enum class PartKind { unused, left_out, backing, fibre };

/// Backing or fibre by the words of a name; nothing when it says neither or both.
std::optional<PartKind> kind_of_name(std::string_view name) {
  const std::string words = in_lower_case(name);
  const auto says = [&](std::string_view word) { return words.find(word) != std::string::npos; };
  const bool backing = says("backing");
  const bool fibre = says("fibre") || says("fiber") || says("strand");
  if (backing == fibre) return std::nullopt;
  return backing ? PartKind::backing : PartKind::fibre;
}

/// Makes a carpet of what a file holds.
class Assembly {
 public:
  Assembly(FileMesh file, const MeshImportOptions& options) : file_(std::move(file)), options_(options) {
    sort_by_id(file_.nodes, "node");
    sort_by_id(file_.quads, "element");
    kinds_.assign(file_.parts.size(), PartKind::unused);
    index_.assign(file_.nodes.size(), -1);
  }

  ImportedMesh assemble() {
    for (const FileQuad& quad : file_.quads) add_nodes(quad);
    number_nodes();
    for (const FileQuad& quad : file_.quads) add_quad(quad);
    note_what_is_left_out();
    ShellMesh& mesh = result_.mesh;
    if (std::find(mesh.material.begin(), mesh.material.end(), backing_material) == mesh.material.end())
      throw_input_error(
          "{}: no shell of it is backing ({}); name the backing's part \"backing\", or set "
          "mesh_undecided_parts = \"backing\"",
          file_.file, parts_in_words());
    number_surfaces(mesh);
    clamp_backing_edge(mesh);
    check_roots();
    check_mesh(mesh);
    result_.notes = std::move(file_.notes);
    return std::move(result_);
  }

 private:
  template <class Item>
  void sort_by_id(std::vector<Item>& items, std::string_view what) const {
    std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.id < b.id; });
    for (std::size_t i = 1; i < items.size(); ++i)
      if (items[i].id == items[i - 1].id)
        fail(items[i].line,
             fmt::format("{} {} is there already, in line {}", what, items[i].id, items[i - 1].line),
             "give every one a number of its own");
  }

  [[noreturn]] void fail(std::size_t line, std::string_view problem, std::string_view advice) const {
    fail_in_mesh_file(file_.file, line, problem, "", advice);
  }

  PartKind kind_of(const FileQuad& quad) {
    PartKind& kind = kinds_[quad.part];
    if (kind != PartKind::unused) return kind;
    const FilePart& part = file_.parts[quad.part];
    if (const auto named = kind_of_name(part.name)) return kind = *named;
    switch (options_.undecided_parts) {
      case UndecidedParts::leave_out:
        return kind = PartKind::left_out;
      case UndecidedParts::backing:
        return kind = PartKind::backing;
      case UndecidedParts::fibre:
        return kind = PartKind::fibre;
      case UndecidedParts::refuse:
        break;
    }
    fail(quad.line,
         fmt::format("element {} is of {}, whose name \"{}\" does not say whether it is backing or fibre",
                     quad.id, part.label, printable(part.name)),
         "put \"backing\", \"fibre\" or \"strand\" in the name, or set mesh_undecided_parts");
  }

  [[nodiscard]] std::size_t find_node(const FileQuad& quad, FileId id) const {
    const auto found = std::lower_bound(file_.nodes.begin(), file_.nodes.end(), id,
                                        [](const FileNode& node, FileId wanted) { return node.id < wanted; });
    if (found == file_.nodes.end() || found->id != id)
      fail(quad.line, fmt::format("element {} names node {}, which the file does not have", quad.id, id),
           "add the node or correct the element");
    return static_cast<std::size_t>(found - file_.nodes.begin());
  }

  void add_nodes(const FileQuad& quad) {
    if (kind_of(quad) == PartKind::left_out) return;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (quad.nodes[i] == quad.nodes[j])
          fail(quad.line,
               i == 3 && j == 2 ? fmt::format("element {} is a triangle: its nodes 3 and 4 are both {}",
                                              quad.id, quad.nodes[i])
                                : fmt::format("element {} names node {} twice", quad.id, quad.nodes[i]),
               "only shells of four different nodes are known; mesh the part with quads");
    for (const FileId id : quad.nodes) index_[find_node(quad, id)] = 0;  // used
  }

  void number_nodes() {
    Index count = 0;
    for (std::size_t n = 0; n < file_.nodes.size(); ++n) {
      if (index_[n] < 0) continue;
      index_[n] = count++;
      const FileNode& node = file_.nodes[n];
      const Vec3 position = options_.unit * node.position + Vec3(0, 0, options_.shift_z);
      if (!(position.cwiseAbs().maxCoeff() <= farthest))
        fail(node.line,
             fmt::format("node {} is at ({}, {}, {}) m, more than a kilometre away", node.id, position.x(),
                         position.y(), position.z()),
             "correct it or mesh_unit");
      result_.mesh.nodes.push_back(position);
      result_.node_ids.push_back(node.id);
    }
  }

  void add_quad(const FileQuad& quad) {
    const PartKind kind = kind_of(quad);
    if (kind == PartKind::left_out) {
      ++left_out_;
      return;
    }
    ShellMesh& mesh = result_.mesh;
    std::array<Index, 4> nodes;
    std::array<Vec3, 4> corner;
    for (std::size_t i = 0; i < 4; ++i) {
      nodes[i] = index_[find_node(quad, quad.nodes[i])];
      corner[i] = mesh.nodes[static_cast<std::size_t>(nodes[i])];
    }
    const QuadFault fault = find_quad_fault(corner);
    if (fault.kind == QuadFault::Kind::coincident_corners)
      fail(quad.line,
           fmt::format("element {}: its nodes {} and {} are {} m apart: a side or diagonal of no length",
                       quad.id, quad.nodes[fault.first], quad.nodes[fault.second], fault.distance),
           "merge or move them");
    if (fault.kind == QuadFault::Kind::not_convex)
      fail(quad.line,
           fmt::format("element {} is degenerate, concave or folded at its node {}", quad.id,
                       quad.nodes[fault.first]),
           "every corner must be under 180 degrees; move its nodes or put them in order");
    mesh.quads.push_back(nodes);
    mesh.thickness.push_back(thickness_of(quad, kind));
    mesh.material.push_back(kind == PartKind::backing ? backing_material : fibre_material);
    lines_.push_back(quad.line);
  }

  [[nodiscard]] double thickness_of(const FileQuad& quad, PartKind kind) const {
    const FilePart& part = file_.parts[quad.part];
    const std::optional<double> given = quad.thickness ? quad.thickness : part.thickness;
    const double thickness = given                       ? *given * options_.unit
                             : kind == PartKind::backing ? options_.backing_thickness
                                                         : options_.strand_thickness;
    if (!given && thickness == 0)
      fail(quad.line, fmt::format("element {} of {} has no thickness", quad.id, part.label),
           "give it in the file or in the design");
    if (!(thickness > 0 && thickness <= farthest))
      fail(quad.line, fmt::format("element {} of {} is {} m thick", quad.id, part.label, thickness),
           "a thickness must be positive; correct it or mesh_unit");
    return thickness;
  }

  /// A strand that shares no node with the backing would fall out of the carpet.
  void check_roots() const {
    const ShellMesh& mesh = result_.mesh;
    const std::vector<std::uint8_t> shared = nodes_of_backing(mesh);
    std::vector<std::uint8_t> rooted(static_cast<std::size_t>(mesh.surface_count), 0);
    for (std::size_t e = 0; e < mesh.quads.size(); ++e)
      for (const Index node : mesh.quads[e])
        if (shared[static_cast<std::size_t>(node)]) rooted[static_cast<std::size_t>(mesh.surface[e])] = 1;
    for (std::size_t e = 0; e < mesh.quads.size(); ++e)
      if (!rooted[static_cast<std::size_t>(mesh.surface[e])])
        fail(lines_[e], "the strand that begins with this element shares no node with the backing",
             "merge its root nodes with the backing's: only shared nodes hold a strand");
  }

  void note_what_is_left_out() {
    if (left_out_ > 0)
      file_.notes.push_back(fmt::format(
          "{}: {} shells of parts that are neither backing nor fibre are left out", file_.file, left_out_));
    if (const std::size_t unused = file_.nodes.size() - result_.node_ids.size(); unused > 0)
      file_.notes.push_back(fmt::format("{}: {} nodes that no shell has are left out", file_.file, unused));
  }

  [[nodiscard]] std::string parts_in_words() const {
    std::string words;
    for (const FilePart& part : file_.parts)
      if (words.size() < 200)
        words += fmt::format("{}{} \"{}\"", words.empty() ? "" : ", ", part.label, printable(part.name));
    return words.empty() ? "it has no shells" : words;
  }

  FileMesh file_;
  const MeshImportOptions& options_;
  std::vector<PartKind> kinds_;     // per part
  std::vector<Index> index_;        // per node of the file: in the mesh, or -1
  std::vector<std::size_t> lines_;  // per element of the mesh
  std::size_t left_out_ = 0;
  ImportedMesh result_;
};

std::string in_mm(double metres) {
  return fmt::format("{:.6g}", 1e3 * metres);
}

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void add(double low_value, double high_value) {
    low = std::min(low, low_value);
    high = std::max(high, high_value);
  }
};

/// The tray and the infill take the patch for granted: the backing fills it, and the infill lies on its face.
void check_patch(const ImportedMesh& imported, const CarpetDesign& design, std::array<double, 2> size) {
  const ShellMesh& mesh = imported.mesh;
  const std::string& file = design.mesh.file;
  constexpr double size_tolerance = 1e-3, thickness_tolerance = 0.1;  // relative
  Extent x, y, height;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (mesh.surface[e] != ShellMesh::backing_surface) continue;
    for (const Index node : mesh.quads[e]) {
      const Vec3 p = mesh.nodes[static_cast<std::size_t>(node)];
      x.add(p.x(), p.x());
      y.add(p.y(), p.y());
      height.add(p.z() - mesh.thickness[e] / 2, p.z() + mesh.thickness[e] / 2);
    }
  }
  const auto fills = [&](const Extent& extent, double length) {
    return std::abs(extent.low + length / 2) <= size_tolerance * length &&
           std::abs(extent.high - length / 2) <= size_tolerance * length;
  };
  if (!fills(x, size[0]) || !fills(y, size[1]))
    throw_input_error(
        "{}: its backing reaches from ({}, {}) to ({}, {}) mm, but the patch of turf.size, centred on the "
        "origin, "
        "from ({}, {}) to ({}, {}) mm; make turf.size that of the mesh, centre the mesh, or correct "
        "turf.carpet.mesh_unit (\"{}\")",
        file, in_mm(x.low), in_mm(y.low), in_mm(x.high), in_mm(y.high), in_mm(-size[0] / 2),
        in_mm(-size[1] / 2), in_mm(size[0] / 2), in_mm(size[1] / 2), design.mesh.unit);
  const double tolerance = thickness_tolerance * design.backing_thickness;
  if (std::abs(height.low) > tolerance || std::abs(height.high - design.backing_thickness) > tolerance)
    throw_input_error(
        "{}: its backing reaches from z = {} to {} mm with its thickness, but it must lie on the tray's "
        "floor z = 0 "
        "and end at turf.carpet.backing_thickness, {} mm, where the infill begins; set "
        "turf.carpet.mesh_shift_z "
        "or turf.carpet.backing_thickness",
        file, in_mm(height.low), in_mm(height.high), in_mm(design.backing_thickness));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3 p = mesh.nodes[n];
    if (std::abs(p.x()) <= (0.5 + size_tolerance) * size[0] &&
        std::abs(p.y()) <= (0.5 + size_tolerance) * size[1] && p.z() >= 0)
      continue;
    throw_input_error(
        "{}: node {} at ({}, {}, {}) mm is outside the tray; bend its strand back or enlarge the patch", file,
        imported.node_ids[n], in_mm(p.x()), in_mm(p.y()), in_mm(p.z()));
  }
}

}  // namespace

ImportedMesh import_mesh_text(std::string_view text, const std::string& name,
                              const MeshImportOptions& options) {
  const std::string ending = in_lower_case(std::filesystem::path(name).extension().string());
  if (ending == ".msh") return Assembly(read_gmsh_mesh(text, name), options).assemble();
  if (ending == ".k" || ending == ".key" || ending == ".dyn")
    return Assembly(read_keyword_mesh(text, name), options).assemble();
  throw_input_error(
      "{}: a mesh file ends in .msh (Gmsh) or .k, .key or .dyn (LS-DYNA), not in '{}'; save it as one", name,
      printable(ending));
}

ImportedMesh import_mesh(const std::filesystem::path& file, const MeshImportOptions& options) {
  return import_mesh_text(read_text_file(file), file.string(), options);
}

ImportedMesh import_carpet(const CarpetDesign& design, std::array<double, 2> size, bool with_fibres) {
  const CarpetMeshFile& source = design.mesh;
  const std::string text = read_text_file(source.file);
  if (const std::string content = content_hash(text); !source.content.empty() && content != source.content)
    throw_input_error(
        "{}: its content ({}) is not what the scene was resolved with (mesh_content = \"{}\"); bring the old "
        "file "
        "back, or start a new run",
        source.file, content, printable(source.content));
  const double unit = unit_factor(source.unit, "m");
  ImportedMesh imported = import_mesh_text(
      text, source.file,
      {unit, source.shift_z, source.undecided_parts, design.backing_thickness, design.strand_thickness});
  check_patch(imported, design, size);
  imported.notes.insert(imported.notes.begin(),
                        fmt::format("carpet from {}, lengths taken as {}", source.file, source.unit));
  if (!with_fibres) imported.mesh = without_fibres(imported.mesh);
  return imported;
}

}  // namespace tuft::fe

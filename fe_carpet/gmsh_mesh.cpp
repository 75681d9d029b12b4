/// Gmsh's ASCII formats 4.1 and 2.2, after the section "Gmsh file formats" of its reference manual.
#include <algorithm>
#include <limits>
#include <map>

#include "fe_carpet/mesh_file.h"

namespace tuft::fe {
namespace {

constexpr FileId surface_dimension = 2;

/// The words of a text one after another, each with its line.
class Words {
 public:
  Words(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  [[nodiscard]] bool at_end() {
    skip_blanks();
    return position_ == text_.size();
  }
  [[nodiscard]] std::size_t line() const { return line_; }

  std::string_view word(std::string_view wanted) {
    if (at_end()) fail(fmt_cut_short(wanted), "", "save or copy it again");
    const std::size_t start = position_;
    while (position_ < text_.size() && !is_blank(text_[position_])) ++position_;
    return text_.substr(start, position_ - start);
  }
  FileId whole(std::string_view wanted) {
    const std::string_view found = word(wanted);
    const auto value = whole_number(found);
    if (!value) fail_value(wanted, "a whole number", found);
    return *value;
  }
  /// A count is at most the text's length, so that a wrong one cannot ask for endless work.
  FileId count(std::string_view wanted) {
    const std::string_view found = word(wanted);
    const auto value = whole_number(found);
    if (!value || *value < 0 || static_cast<std::size_t>(*value) > text_.size())
      fail_value(wanted, "a count", found);
    return *value;
  }
  FileId id(std::string_view wanted) {
    const std::string_view found = word(wanted);
    const auto value = whole_number(found);
    if (!value || *value < 1) fail_value(wanted, "a number from 1 on", found);
    return *value;
  }
  double real(std::string_view wanted) {
    const std::string_view found = word(wanted);
    const auto value = real_number(found);
    if (!value) fail_value(wanted, "a finite number", found);
    return *value;
  }
  std::string quoted(std::string_view wanted) {
    if (at_end()) fail(fmt_cut_short(wanted), "", "save or copy it again");
    if (text_[position_] != '"') return std::string(word(wanted));
    const std::size_t end = text_.find_first_of("\"\n", position_ + 1);
    if (end == std::string_view::npos || text_[end] == '\n')
      fail(std::string(wanted) + " has no closing quote", "", "close it on the same line");
    const std::string_view found = text_.substr(position_ + 1, end - position_ - 1);
    position_ = end + 1;
    return std::string(found);
  }
  void expect(std::string_view wanted) {
    const std::string_view found = word(wanted);
    if (found != wanted)
      fail(std::string(wanted) + " is needed here", found,
           "the section holds more or less than its count says");
  }
  void skip(FileId words, std::string_view wanted) {
    for (FileId i = 0; i < words; ++i) (void)word(wanted);
  }
  void skip_to(std::string_view mark) {
    while (word(mark) != mark) {
    }
  }
  [[noreturn]] void fail(std::string_view problem, std::string_view value, std::string_view advice) const {
    fail_in_mesh_file(file_, line_, problem, value, advice);
  }

 private:
  static bool is_blank(char letter) {
    return letter == ' ' || letter == '\n' || letter == '\r' || letter == '\t';
  }
  void skip_blanks() {
    for (; position_ < text_.size() && is_blank(text_[position_]); ++position_)
      line_ += text_[position_] == '\n';
  }
  static std::string fmt_cut_short(std::string_view wanted) {
    return "the file ends where " + std::string(wanted) + " is needed: it is cut short";
  }
  [[noreturn]] void fail_value(std::string_view wanted, std::string_view kind, std::string_view found) const {
    fail(std::string(wanted) + " must be " + std::string(kind), found, "correct it or save the mesh again");
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t position_ = 0, line_ = 1;
};

struct ElementType {
  FileId number;
  FileId nodes;
  std::string_view name;
  bool boundary;  ///< a point or line, which a shell mesh may hold besides its shells
};
constexpr FileId quad_type = 3;
constexpr ElementType element_types[] = {{15, 1, "point", true},
                                         {1, 2, "line", true},
                                         {8, 3, "line of second order", true},
                                         {26, 4, "line of third order", true},
                                         {27, 5, "line of fourth order", true},
                                         {28, 6, "line of fifth order", true},
                                         {2, 3, "triangle", false},
                                         {9, 6, "triangle of second order", false},
                                         {quad_type, 4, "quad", false},
                                         {10, 9, "quad of second order", false},
                                         {16, 8, "quad of second order", false},
                                         {4, 4, "tetrahedron", false},
                                         {5, 8, "hexahedron", false},
                                         {6, 6, "prism", false},
                                         {7, 5, "pyramid", false}};

/// A negative group is the same one, the surface turned over.
FileId without_sign(FileId group) {
  return group < 0 && group > std::numeric_limits<FileId>::min() ? -group : group;
}

class GmshReader {
 public:
  GmshReader(std::string_view text, const std::string& file) : words_(text, file) { mesh_.file = file; }

  FileMesh read() {
    read_format();
    bool nodes = false, elements = false;
    while (!words_.at_end()) {
      const std::string section(words_.word("a section"));
      if (section == "$Nodes" && !nodes) {
        nodes = true;
        modern_ ? read_nodes_41() : read_nodes_22();
      } else if (section == "$Elements" && !elements) {
        elements = true;
        modern_ ? read_elements_41() : read_elements_22();
      } else if (section == "$PhysicalNames") {
        read_physical_names();
      } else if (section == "$Entities" && modern_) {
        read_entities();
      } else if (section == "$ElementData") {
        read_element_data();
      } else if (section == "$PartitionedEntities") {
        words_.fail("the mesh is partitioned", "", "save it in one piece (Mesh.SaveAll without partitions)");
      } else if (section.size() > 1 && section[0] == '$' && section != "$Nodes" && section != "$Elements") {
        words_.skip_to("$End" + section.substr(1));
        continue;
      } else {
        words_.fail("a section such as $Nodes is needed here, each once", section, "save the mesh again");
      }
      words_.expect("$End" + section.substr(1));
    }
    if (!nodes || !elements)
      words_.fail(nodes ? "the file ends without $Elements" : "the file ends without $Nodes", "",
                  "it is cut short: save or copy it again");
    give_thicknesses();
    return std::move(mesh_);
  }

 private:
  void read_format() {
    if (words_.at_end() || words_.word("$MeshFormat") != "$MeshFormat")
      words_.fail("a Gmsh mesh begins with $MeshFormat", "", "save it from Gmsh as .msh");
    const std::string version(words_.word("the format's version"));
    if (version != "4.1" && version != "2.2")
      words_.fail("formats 4.1 and 2.2 are known, not this one", version,
                  "set Mesh.MshFileVersion = 4.1 and save again");
    modern_ = version == "4.1";
    if (words_.whole("the file's type") != 0)
      words_.fail("the mesh is binary", "", "set Mesh.Binary = 0 and save again");
    (void)words_.whole("the size of a number");
    words_.expect("$EndMeshFormat");
  }

  void read_physical_names() {
    const FileId count = words_.count("the count of physical names");
    for (FileId i = 0; i < count; ++i) {
      const FileId dimension = words_.whole("a physical group's dimension");
      const FileId tag = words_.whole("a physical group's tag");
      std::string name = words_.quoted("a physical group's name");
      if (dimension == surface_dimension) physical_names_[tag] = std::move(name);
    }
  }

  void read_entities() {
    FileId counts[4];
    for (FileId& count : counts) count = words_.count("a count of entities");
    for (FileId dimension = 0; dimension < 4; ++dimension)
      for (FileId i = 0; i < counts[dimension]; ++i) {
        const FileId tag = words_.whole("an entity's tag");
        words_.skip(dimension == 0 ? 3 : 6, "an entity's bounds");
        const FileId groups = words_.count("an entity's count of physical groups");
        for (FileId k = 0; k < groups; ++k) {
          const FileId group = words_.whole("an entity's physical group");
          if (dimension == surface_dimension) entity_groups_[tag].push_back(without_sign(group));
        }
        if (dimension > 0) words_.skip(words_.count("an entity's count of bounds"), "an entity's bound");
      }
  }

  Vec3 read_position() {
    const double x = words_.real("a node's x"), y = words_.real("a node's y");
    return {x, y, words_.real("a node's z")};
  }

  void read_nodes_22() {
    const FileId count = words_.count("the count of nodes");
    for (FileId i = 0; i < count; ++i) {
      FileNode node;
      node.id = words_.id("a node's tag");
      node.line = words_.line();
      node.position = read_position();
      mesh_.nodes.push_back(node);
    }
  }

  void read_nodes_41() {
    const FileId blocks = words_.count("the count of node blocks");
    const FileId total = words_.count("the count of nodes");
    words_.skip(2, "the range of node tags");
    for (FileId block = 0; block < blocks; ++block) {
      const FileId dimension = words_.whole("a node block's dimension");
      (void)words_.whole("a node block's entity");
      const FileId parameters = words_.whole("whether a node block is parametric") != 0 ? dimension : 0;
      const FileId count = words_.count("the count of nodes in a block");
      const std::size_t first = mesh_.nodes.size();
      for (FileId i = 0; i < count; ++i) {
        FileNode node;
        node.id = words_.id("a node's tag");
        node.line = words_.line();
        mesh_.nodes.push_back(node);
      }
      for (std::size_t n = first; n < mesh_.nodes.size(); ++n) {
        mesh_.nodes[n].position = read_position();
        words_.skip(std::clamp<FileId>(parameters, 0, 3), "a node's parameter");
      }
    }
    if (static_cast<std::size_t>(total) != mesh_.nodes.size())
      words_.fail("the blocks of $Nodes hold another number of nodes than its first line says",
                  std::to_string(total), "save the mesh again");
  }

  void read_elements_22() {
    const FileId count = words_.count("the count of elements");
    for (FileId i = 0; i < count; ++i) {
      const FileId id = words_.id("an element's tag");
      const FileId type = words_.whole("an element's type");
      const FileId tags = words_.count("an element's count of tags");
      FileId group = 0, entity = 0;
      for (FileId k = 0; k < tags; ++k) {
        const FileId tag = words_.whole("a tag of an element");
        if (k == 0) group = without_sign(tag);
        if (k == 1) entity = tag;
      }
      const std::vector<FileId> groups = group == 0 ? std::vector<FileId>{} : std::vector<FileId>{group};
      read_element(id, type, [&] { return part(groups, entity); });
    }
  }

  void read_elements_41() {
    const FileId blocks = words_.count("the count of element blocks");
    const FileId total = words_.count("the count of elements");
    words_.skip(2, "the range of element tags");
    FileId found = 0;
    for (FileId block = 0; block < blocks; ++block) {
      (void)words_.whole("an element block's dimension");
      const FileId entity = words_.whole("an element block's entity");
      const FileId type = words_.whole("an element block's type");
      const FileId count = words_.count("the count of elements in a block");
      found += count;
      for (FileId i = 0; i < count; ++i) {
        const FileId id = words_.id("an element's tag");
        read_element(id, type, [&] { return part(entity_groups_[entity], entity); });
      }
    }
    if (found != total)
      words_.fail("the blocks of $Elements hold another number of elements than its first line says",
                  std::to_string(total), "save the mesh again");
  }

  template <class FindPart>
  void read_element(FileId id, FileId type, const FindPart& find_part) {
    const auto* known = std::find_if(std::begin(element_types), std::end(element_types),
                                     [type](const ElementType& one) { return one.number == type; });
    if (known == std::end(element_types) || (!known->boundary && type != quad_type))
      words_.fail(
          "element " + std::to_string(id) + " is of type " + std::to_string(type) +
              (known == std::end(element_types) ? "" : ", a " + std::string(known->name)),
          "",
          "only quads of four nodes (type 3) are known, with points and lines as their boundary; recombine "
          "(Mesh.RecombineAll = 1) at first order");
    if (known->boundary) {
      words_.skip(known->nodes, "an element's node");
      return;
    }
    FileQuad quad;
    quad.id = id;
    quad.line = words_.line();
    for (FileId& node : quad.nodes) node = words_.whole("an element's node");
    quad.part = find_part();
    mesh_.quads.push_back(quad);
  }

  /// One part for each set of physical groups, and for each surface that is in none.
  std::size_t part(const std::vector<FileId>& groups, FileId entity) {
    const auto [found, is_new] =
        parts_.try_emplace({groups, groups.empty() ? entity : 0}, mesh_.parts.size());
    if (!is_new) return found->second;
    FilePart fresh;
    fresh.label = groups.empty() ? "surface " + std::to_string(entity) + " (in no physical group)"
                                 : "physical surface " + std::to_string(groups.front());
    for (const FileId group : groups)
      if (const auto name = physical_names_.find(group); name != physical_names_.end())
        fresh.name += (fresh.name.empty() ? "" : ", ") + name->second;
    mesh_.parts.push_back(std::move(fresh));
    return found->second;
  }

  /// A view named "thickness" gives each element its own.
  void read_element_data() {
    const FileId texts = words_.count("the count of texts of a view");
    std::string name;
    for (FileId i = 0; i < texts; ++i) {
      std::string text = words_.quoted("a text of a view");
      if (i == 0) name = std::move(text);
    }
    words_.skip(words_.count("the count of numbers of a view"), "a number of a view");
    const FileId integers = words_.count("the count of whole numbers of a view");
    FileId components = 1, count = 0;
    for (FileId i = 0; i < integers; ++i) {
      const FileId value = words_.whole("a whole number of a view");
      if (i == 1) components = value;
      if (i == 2) count = value;
    }
    const bool is_thickness = name == "thickness";
    if (is_thickness && components != 1)
      words_.fail("a view of thicknesses has one number an element", std::to_string(components),
                  "save it as scalars");
    if (components < 0 || components > 9 || count < 0)
      words_.fail("a view has 1, 3 or 9 numbers for each of its elements", std::to_string(components),
                  "save it again");
    for (FileId i = 0; i < count; ++i) {
      const FileId id = words_.id("an element's tag");
      if (is_thickness)
        thicknesses_[id] = words_.real("an element's thickness");
      else
        words_.skip(components, "a number of a view");
    }
    if (!is_thickness)
      mesh_.notes.push_back(mesh_.file + ": the view \"" + printable(name) + "\" is left out");
  }

  void give_thicknesses() {
    for (FileQuad& quad : mesh_.quads)
      if (const auto found = thicknesses_.find(quad.id); found != thicknesses_.end())
        quad.thickness = found->second;
  }

  Words words_;
  FileMesh mesh_;
  bool modern_ = true;                                   // 4.1, not 2.2
  std::map<FileId, std::string> physical_names_;         // of surfaces, by tag
  std::map<FileId, std::vector<FileId>> entity_groups_;  // of surfaces: their physical groups
  std::map<std::pair<std::vector<FileId>, FileId>, std::size_t> parts_;
  std::map<FileId, double> thicknesses_;
};

}  // namespace

FileMesh read_gmsh_mesh(std::string_view text, const std::string& file) {
  return GmshReader(text, file).read();
}

}  // namespace tuft::fe

#include "core/scene_reader.h"

#include <functional>

#include "core/error.h"
#include "core/nearest_name.h"
#include "core/scene_check.h"
#include "core/scene_files.h"
#include "core/scene_layout.h"
#include "core/scene_overrides.h"
#include "core/scene_schema.h"
#include "core/toml_reader.h"
#include "core/units.h"

namespace tuft {
namespace {

using schema::Document;
using schema::KeyVisitor;
using schema::TomlReader;

std::string path_of_material(const std::string& name) {
  return fmt::format("{}.{}", materials_key, name);
}

/// Reads one scene: its own text, and the files it names as they come up.
class SceneAssembly {
 public:
  SceneAssembly(const std::string& text, const std::string& name, const Overrides& overrides)
      : folders_(std::filesystem::path(name).parent_path()), toml_(schema::parse_toml(text, name)) {
    scene_.file = name;
    document_ = document_for(name);
    document_.overridden = apply_overrides(toml_, overrides);
  }

  Scene assemble() {
    // Which keys there are depends on the rig; whether its type is one is said when its key is read.
    if (const auto type = toml_["rig"]["type"].value<std::string>()) scene_.rig.type = *type;
    TomlReader::read(document_, toml_, "", "", true, [this](KeyVisitor& keys) {
      dynamic_cast<TomlReader&>(keys).know(materials_key);
      schema::describe_scene(keys, scene_, [this](KeyVisitor& inside, CarpetDesign& carpet) {
        read_carpet(dynamic_cast<TomlReader&>(inside), carpet);
      });
    });
    read_unused_materials();
    if (scene_.info.name.empty()) scene_.info.name = std::filesystem::path(scene_.file).stem().string();
    complete_scene(scene_, places_);
    return std::move(scene_);
  }

 private:
  Document document_for(const std::string& file) {
    Document document;
    document.file = file;
    document.places = &places_;
    document.find_material = [this](const std::string& name, const Place& place) {
      return material(name, place);
    };
    return document;
  }

  [[noreturn]] void fail_unknown_file(std::string_view kind, const std::string& name,
                                      const Place& place) const {
    const auto known = folders_.names(kind);
    const auto nearest = nearest_name(name, known);
    throw_bad_key(place.where, place.key, place.value,
                  nearest ? fmt::format("no such file in {}/; did you mean \"{}\"?", kind, *nearest)
                          : fmt::format("no such file in {}/; there are {}", kind, fmt::join(known, ", ")));
  }

  /// The design's file first, then what the scene itself says of the carpet.
  void read_carpet(TomlReader& inside, CarpetDesign& carpet) {
    std::string origin;
    inside.text({origin_key, ""}, origin);
    const bool complete = inside.has(origin_key);
    const std::string& design = scene_.turf.design;
    if (complete && origin != design)
      places_.fail(fmt::format("turf.carpet.{}", origin_key),
                   "must be the same as turf.design; leave it out");
    if (!complete && !design.empty()) {
      read_design(design, carpet);
      inside.accept_incomplete();
    }
    schema::describe_carpet(inside, carpet);
    complete_mesh_file(carpet.mesh, complete);
  }

  /// Finds the mesh file and notes what it holds. A resolved scene has both already, and stays readable when
  /// the file is gone: only a run needs it then.
  void complete_mesh_file(CarpetMeshFile& mesh, bool complete) const {
    if (mesh.file.empty()) {
      for (const char* key : {"turf.carpet.mesh_unit", "turf.carpet.mesh_shift_z",
                              "turf.carpet.mesh_undecided_parts", "turf.carpet.mesh_content"})
        if (!complete && places_.has(key))
          places_.fail(key, "says how to read a mesh file, but turf.carpet.mesh names none; leave it out");
      return;
    }
    try {
      if (!(unit_factor(mesh.unit, "m") > 0)) throw_input_error("must be positive; write for example \"mm\"");
    } catch (const InputError& error) {
      places_.fail("turf.carpet.mesh_unit", error.what());
    }
    const auto file = folders_.find("meshes", mesh.file);
    if (file)
      mesh.file = std::filesystem::absolute(*file).lexically_normal().string();
    else if (!complete)
      places_.fail("turf.carpet.mesh", "no such file; it is looked for beside the scene and in meshes/");
    if (file && mesh.content.empty()) mesh.content = content_hash(read_text_file(*file));
  }

  void read_design(const std::string& design, CarpetDesign& carpet) {
    const auto file = folders_.find("turfs", design);
    if (!file) fail_unknown_file("turfs", design, places_.find("turf.design"));
    Document document = document_for(file->string());
    Places unused;  // the scene's own places count
    document.places = &unused;
    const toml::table table = schema::parse_toml(read_text_file(*file), document.file);
    TomlReader::read(document, table, "", "", true, [&carpet](KeyVisitor& keys) {
      keys.table(schema::required("carpet", ""),
                 [&carpet](KeyVisitor& inside) { schema::describe_carpet(inside, carpet); });
    });
  }

  /// Index of a material, read when it is first named: from its file, then from the scene's own table of that
  /// name.
  Index material(const std::string& name, const Place& place) {
    for (std::size_t i = 0; i < scene_.materials.size(); ++i)
      if (scene_.materials[i].name == name) return static_cast<Index>(i);
    const auto index = scene_.materials.size();
    scene_.materials.emplace_back().name = name;  // now, since materials may name each other
    Material material;
    material.name = name;
    const toml::table* own = toml_[materials_key][name].as_table();
    const bool complete = own != nullptr && own->contains(origin_key);
    const auto file = complete ? std::nullopt : folders_.find("materials", name);
    if (!file && own == nullptr) fail_unknown_file("materials", name, place);
    if (file) read_material_file(*file, name, material);
    if (own != nullptr) read_own_material(*own, name, !file.has_value(), material);
    if (material.name != name)
      places_.fail(path_of_material(name) + ".material.name",
                   fmt::format("must be \"{}\", as the file or table is called", name));
    complete_material(material, static_cast<Index>(index), path_of_material(name), places_);
    scene_.materials[index] = std::move(material);
    return static_cast<Index>(index);
  }

  void read_material_file(const std::filesystem::path& file, const std::string& name, Material& material) {
    Document document = document_for(file.string());
    const toml::table table = schema::parse_toml(read_text_file(file), document.file);
    material.file = document.file;
    TomlReader::read(document, table, "", path_of_material(name), true,
                     [&material](KeyVisitor& keys) { schema::describe_material(keys, material); });
  }

  void read_own_material(const toml::table& own, const std::string& name, bool complete, Material& material) {
    Document document = document_for(scene_.file);
    document.overridden = document_.overridden;
    if (material.file.empty()) material.file = scene_.file;
    TomlReader::read(document, own, path_of_material(name), path_of_material(name), complete,
                     [&material](KeyVisitor& keys) {
                       keys.text({origin_key, ""}, material.file);
                       schema::describe_material(keys, material);
                     });
  }

  /// Tables [materials.NAME] that no layer came to are checked all the same.
  void read_unused_materials() {
    const toml::node* node = toml_.get(materials_key);
    if (node == nullptr) return;
    const std::string key(materials_key);
    if (!node->is_table())
      throw_bad_key(document_.where(node, key), key, schema::value_text(*node),
                    "tables [materials.NAME] are needed");
    for (const auto& [name, table] : *node->as_table()) {
      const std::string path = path_of_material(std::string(name.str()));
      if (!table.is_table())
        throw_bad_key(document_.where(&table, path), path, schema::value_text(table), "a table is needed");
      (void)material(std::string(name.str()), {document_.where(&table, path), path, ""});
    }
  }

  Scene scene_;
  Places places_;
  InputFolders folders_;
  toml::table toml_;
  Document document_;
};

}  // namespace

Scene read_scene(const std::filesystem::path& file, const Overrides& overrides) {
  return SceneAssembly(read_text_file(file), file.string(), overrides).assemble();
}

Scene read_scene_text(const std::string& text, const std::string& name, const Overrides& overrides) {
  return SceneAssembly(text, name, overrides).assemble();
}

}  // namespace tuft

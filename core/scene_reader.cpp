#include "core/scene_reader.h"

#include <functional>

#include "core/error.h"
#include "core/material_reader.h"
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

/// Reads one scene: its own text, and the files it names as they come up.
class SceneAssembly {
 public:
  SceneAssembly(const std::string& text, const std::string& name, const Overrides& overrides,
                const MaterialTexts& texts = {})
      : toml_(schema::parse_toml(text, name)), materials_(name, toml_, places_, scene_.materials) {
    scene_.file = name;
    document_ = materials_.document_for(name);
    document_.overridden = apply_overrides(toml_, overrides);
    materials_.set_overridden(document_.overridden);
    materials_.set_texts(texts);
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
    materials_.read_unused();
    if (scene_.info.name.empty()) scene_.info.name = std::filesystem::path(scene_.file).stem().string();
    complete_scene(scene_, places_);
    return std::move(scene_);
  }

 private:
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
    const auto file = materials_.folders().find("meshes", mesh.file);
    if (file)
      mesh.file = std::filesystem::absolute(*file).lexically_normal().string();
    else if (!complete)
      places_.fail("turf.carpet.mesh", "no such file; it is looked for beside the scene and in meshes/");
    if (file && mesh.content.empty()) mesh.content = content_hash(read_text_file(*file));
  }

  void read_design(const std::string& design, CarpetDesign& carpet) {
    const auto file = materials_.folders().find("turfs", design);
    if (!file) fail_unknown_file(materials_.folders(), "turfs", design, places_.find("turf.design"));
    Document document = materials_.document_for(file->string());
    Places unused;  // the scene's own places count
    document.places = &unused;
    const toml::table table = schema::parse_toml(read_text_file(*file), document.file);
    TomlReader::read(document, table, "", "", true, [&carpet](KeyVisitor& keys) {
      keys.table(schema::required("carpet", ""),
                 [&carpet](KeyVisitor& inside) { schema::describe_carpet(inside, carpet); });
    });
  }

  Scene scene_;
  Places places_;
  toml::table toml_;
  MaterialReader materials_;
  Document document_;
};

}  // namespace

Scene read_scene(const std::filesystem::path& file, const Overrides& overrides, const MaterialTexts& texts) {
  return SceneAssembly(read_text_file(file), file.string(), overrides, texts).assemble();
}

Scene read_scene_text(const std::string& text, const std::string& name, const Overrides& overrides) {
  return SceneAssembly(text, name, overrides).assemble();
}

}  // namespace tuft

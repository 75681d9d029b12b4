#include "core/material_reader.h"

#include "core/error.h"
#include "core/nearest_name.h"
#include "core/scene_check.h"
#include "core/scene_layout.h"

namespace tuft {
namespace {

using schema::Document;
using schema::KeyVisitor;
using schema::TomlReader;

std::string path_of_material(const std::string& name) {
  return fmt::format("{}.{}", materials_key, name);
}

}  // namespace

void fail_unknown_file(const InputFolders& folders, std::string_view kind, const std::string& name,
                       const Place& place) {
  const auto known = folders.names(kind);
  const auto nearest = nearest_name(name, known);
  throw_bad_key(place.where, place.key, place.value,
                nearest ? fmt::format("no such file in {}/; did you mean \"{}\"?", kind, *nearest)
                        : fmt::format("no such file in {}/; there are {}", kind, fmt::join(known, ", ")));
}

Document MaterialReader::document_for(const std::string& file) {
  Document document;
  document.file = file;
  document.places = &places_;
  document.find_material = [this](const std::string& name, const Place& place) {
    return material(name, place);
  };
  return document;
}

Index MaterialReader::material(const std::string& name, const Place& place) {
  for (std::size_t i = 0; i < materials_.size(); ++i)
    if (materials_[i].name == name) return static_cast<Index>(i);
  const auto index = materials_.size();
  materials_.emplace_back().name = name;  // now, since materials may name each other
  Material material;
  material.name = name;
  const toml::table* own = input_[materials_key][name].as_table();
  const bool complete = own != nullptr && own->contains(origin_key);
  const auto text = texts_.find(name);
  if (text != texts_.end() && complete)
    places_.fail(path_of_material(name),
                 "is given whole in this file, so no other can be tried in its place; "
                 "give a scene or test that names the material");
  const auto file = complete || text != texts_.end() ? std::nullopt : folders_.find("materials", name);
  if (!file && text == texts_.end() && own == nullptr) fail_unknown_file(folders_, "materials", name, place);
  if (text != texts_.end()) read_file(text->second.file, text->second.text, name, material);
  if (file) read_file(file->string(), read_text_file(*file), name, material);
  if (own != nullptr) read_own(*own, name, !file && text == texts_.end(), material);
  if (material.name != name)
    places_.fail(path_of_material(name) + ".material.name",
                 fmt::format("must be \"{}\", as the file or table is called", name));
  complete_material(material, static_cast<Index>(index), path_of_material(name), places_);
  materials_[index] = std::move(material);
  return static_cast<Index>(index);
}

void MaterialReader::read_file(const std::string& file, const std::string& text, const std::string& name,
                               Material& material) {
  Document document = document_for(file);
  const toml::table table = schema::parse_toml(text, file);
  material.file = document.file;
  TomlReader::read(document, table, "", path_of_material(name), true,
                   [&material](KeyVisitor& keys) { schema::describe_material(keys, material); });
}

void MaterialReader::read_own(const toml::table& own, const std::string& name, bool complete,
                              Material& material) {
  Document document = document_for(file_);
  document.overridden = overridden_;
  if (material.file.empty()) material.file = file_;
  TomlReader::read(document, own, path_of_material(name), path_of_material(name), complete,
                   [&material](KeyVisitor& keys) {
                     keys.text({origin_key, ""}, material.file);
                     schema::describe_material(keys, material);
                   });
}

void MaterialReader::read_unused() {
  const toml::node* node = input_.get(materials_key);
  if (node == nullptr) return;
  Document document = document_for(file_);
  document.overridden = overridden_;
  const std::string key(materials_key);
  if (!node->is_table())
    throw_bad_key(document.where(node, key), key, schema::value_text(*node),
                  "tables [materials.NAME] are needed");
  for (const auto& [name, table] : *node->as_table()) {
    const std::string path = path_of_material(std::string(name.str()));
    if (!table.is_table())
      throw_bad_key(document.where(&table, path), path, schema::value_text(table), "a table is needed");
    (void)material(std::string(name.str()), {document.where(&table, path), path, ""});
  }
}

}  // namespace tuft

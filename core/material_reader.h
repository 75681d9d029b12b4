#pragma once
/// Materials that an input names: each from its file, then from the input's own table of that name.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene_files.h"
#include "core/toml_reader.h"

namespace tuft {

/// Messages about a file in a folder of inputs that is not there.
[[noreturn]] void fail_unknown_file(const InputFolders& folders, std::string_view kind,
                                    const std::string& name, const Place& place);

/// Reads materials of one document as they are first named. What it refers to must outlive it.
class MaterialReader {
 public:
  MaterialReader(std::string file, const toml::table& input, Places& places, std::vector<Material>& materials)
      : file_(std::move(file)),
        folders_(std::filesystem::path(file_).parent_path()),
        input_(input),
        places_(places),
        materials_(materials) {}

  /// Keys that --set gave, for messages.
  void set_overridden(std::vector<std::string> keys) { overridden_ = std::move(keys); }
  /// Texts that stand in for files of materials.
  void set_texts(const MaterialTexts& texts) { texts_ = texts; }
  /// A document of the same input, or of a file that it names.
  [[nodiscard]] schema::Document document_for(const std::string& file);
  /// Index of a material, read when it is first named.
  Index material(const std::string& name, const Place& place);
  /// Tables [materials.NAME] that nothing came to are checked all the same.
  void read_unused();
  [[nodiscard]] const InputFolders& folders() const { return folders_; }

 private:
  void read_file(const std::string& file, const std::string& text, const std::string& name,
                 Material& material);
  void read_own(const toml::table& own, const std::string& name, bool complete, Material& material);

  std::string file_;
  InputFolders folders_;
  const toml::table& input_;
  Places& places_;
  std::vector<Material>& materials_;
  std::vector<std::string> overridden_;
  MaterialTexts texts_;
};

}  // namespace tuft

#pragma once
/// Finding and reading the files that a scene names.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tuft {

/// A text that stands in for the file of a material: what a calibration tries.
struct MaterialText {
  std::string file;  ///< for messages
  std::string text;
};
using MaterialTexts = std::map<std::string, MaterialText>;  ///< by name of the material

/// Whole text of a file. Throws InputError with the system's words.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// Folders in which turfs/ and materials/ are looked for: the scene's own and the program's inputs.
class InputFolders {
 public:
  explicit InputFolders(const std::filesystem::path& scene_folder);
  /// `name` or `name`.toml, beside the scene or in a folder `kind` ("turfs", "materials").
  [[nodiscard]] std::optional<std::filesystem::path> find(std::string_view kind,
                                                          const std::string& name) const;
  /// Names that `find` would find in the folders `kind`, sorted.
  [[nodiscard]] std::vector<std::string> names(std::string_view kind) const;

 private:
  std::vector<std::filesystem::path> folders_;
};

}  // namespace tuft

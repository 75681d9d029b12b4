#include "core/scene_files.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

#include "core/error.h"

namespace tuft {

namespace fs = std::filesystem;

std::string read_text_file(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw_input_error("{}: is a folder; a file is needed", file.string());
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.is_open() || stream.bad())
    throw_input_error("{}: cannot be read ({})", file.string(), std::strerror(errno != 0 ? errno : EIO));
  return text;
}

InputFolders::InputFolders(const fs::path& scene_folder) {
  folders_.push_back(scene_folder.empty() ? fs::path(".") : scene_folder);
  folders_.emplace_back(TUFT_INPUTS_DIR);
}

std::optional<fs::path> InputFolders::find(std::string_view kind, const std::string& name) const {
  for (const fs::path& folder : folders_) {
    for (const fs::path& candidate :
         {folder / kind / (name + ".toml"), folder / kind / name, folder / name, folder / (name + ".toml")}) {
      std::error_code ignored;
      // A scene may bear the name of its design; a file named without its ending is looked for in its own
      // folder first.
      if (fs::is_regular_file(candidate, ignored)) return candidate;
    }
  }
  return std::nullopt;
}

std::vector<std::string> InputFolders::names(std::string_view kind) const {
  std::vector<std::string> found;
  for (const fs::path& folder : folders_) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder / kind, error))
      if (entry.path().extension() == ".toml") found.push_back(entry.path().stem().string());
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace tuft

#include "rigs/run_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>

#include "core/error.h"
#include "core/hdf5_file.h"
#include "core/scene_reader.h"

namespace tuft::rigs {
namespace {

constexpr std::array<std::string_view, 3> marks_of_a_run{"summary.json", "run.h5", "checkpoint.h5"};

std::filesystem::path nearest_existing(std::filesystem::path path) {
  std::error_code ignored;
  while (!path.empty() && !std::filesystem::exists(path, ignored)) {
    if (path == path.parent_path()) break;
    path = path.parent_path();
  }
  return path.empty() ? std::filesystem::path(".") : path;
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw_input_error("{}: a run is at work in this folder; wait for its end, or choose another",
                    folder.string());
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::size_t recorded_rows(const std::filesystem::path& folder) {
  try {
    return h5::File::open(folder / "run.h5").root().open_group("history").read_doubles("time").size();
  } catch (const RunError&) {
    return 0;
  }
}

void check_run_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  const std::filesystem::path existing = nearest_existing(folder);
  if (!std::filesystem::is_directory(existing, ignored)) {
    throw_input_error("{}: cannot be the output folder: '{}' is not a folder; choose another --out",
                      folder.string(), existing.string());
  }
  if (::access(existing.c_str(), W_OK | X_OK) != 0) {
    throw_input_error("{}: cannot be the output folder: '{}' is not writable ({}); choose another --out",
                      folder.string(), existing.string(), std::strerror(errno));
  }
  for (const std::string_view mark : marks_of_a_run) {
    if (std::filesystem::exists(folder / mark, ignored)) {
      throw_input_error("{}: already holds a run ({}); choose another --out or remove it", folder.string(),
                        mark);
    }
  }
}

void prepare_run_folder(const std::filesystem::path& folder, const Scene& scene) {
  check_run_folder(folder);
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) {
    throw_input_error("{}: cannot be created: {}; choose another --out", folder.string(), failure.message());
  }
  // Some file systems (/proc, read-only mounts) let root pass every check but the write itself.
  std::ofstream file(folder / "scene.toml");
  if (!file) {
    throw_input_error("{}: not writable: {}; choose another --out", folder.string(), std::strerror(errno));
  }
  file.close();
  write_text_file(folder / "scene.toml", write_scene(scene));
}

Scene read_run_scene(const std::filesystem::path& folder, const Overrides& overrides) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw_input_error("{}: not the folder of a run: there is no such folder", folder.string());
  }
  if (!std::filesystem::exists(folder / "scene.toml", ignored)) {
    throw_input_error(
        "{}: not the folder of a run: it holds no scene.toml; give a folder that `tuft run` wrote",
        folder.string());
  }
  return read_scene(folder / "scene.toml", overrides);
}

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) throw_run_error("{}: cannot be written: {}", path.string(), std::strerror(errno));
}

}  // namespace tuft::rigs

#pragma once
/// The folder of one run: made, checked and described before anything is computed.
#include <filesystem>
#include <string>

#include "core/scene_reader.h"

namespace tuft::rigs {

/// Throws InputError, with what to do, unless a run may write here: the path is a folder that holds no run
/// yet and can be written, or can be created. Nothing is left behind.
void check_run_folder(const std::filesystem::path& folder);

/// Keeps other runs out of a folder for as long as it lives, also those of other processes. Throws InputError
/// where one is at work in it. (File systems that know no locks are taken as they are.)
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// Rows of history that a run has recorded; 0 where its run.h5 is not there or cannot be read.
[[nodiscard]] std::size_t recorded_rows(const std::filesystem::path& folder);

/// Checks the folder, creates it and writes `scene.toml`, the scene as resolved.
void prepare_run_folder(const std::filesystem::path& folder, const Scene& scene);

/// The scene of an existing run, from its `scene.toml`, with keys changed as `overrides` say. Throws
/// InputError when there is none, or an override is not allowed.
[[nodiscard]] Scene read_run_scene(const std::filesystem::path& folder, const Overrides& overrides = {});

/// Writes a text file. Throws RunError naming the file and the reason when it cannot be written whole.
void write_text_file(const std::filesystem::path& path, const std::string& text);

}  // namespace tuft::rigs

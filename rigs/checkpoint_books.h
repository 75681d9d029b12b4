#pragma once
/// What every checkpoint of a component or specimen rig holds beside the physics: format, scene, time spent,
/// rows recorded.
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "core/hdf5_file.h"
#include "core/scene.h"
#include "rigs/run_state.h"

namespace tuft::rigs {

/// Kind and format of a checkpoint: a scalar of this name holds the number.
struct CheckpointFormat {
  const char* name;
  std::uint64_t number;
};

struct CheckpointBooks {
  std::map<std::string, std::uint64_t> recorded;  ///< rows in run.h5
  SpentSoFar spent;                               ///< before this run of the program
};

/// Writes the file atomically; `write_rest` adds the state.
void write_books(const std::filesystem::path& path, const Scene& scene, const CheckpointFormat& format,
                 const CheckpointBooks& books, const std::function<void(h5::Group&)>& write_rest);
/// Throws InputError for a file that is missing, damaged, of another format or of another scene.
[[nodiscard]] CheckpointBooks read_books(const std::filesystem::path& path, const Scene& scene,
                                         const CheckpointFormat& format,
                                         const std::function<void(const h5::Group&)>& read_rest);

}  // namespace tuft::rigs

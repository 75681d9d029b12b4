#pragma once
/// The turf of inputs/clegg_small.toml, coarsened further so that a drop takes seconds.
#include <filesystem>
#include <string>

#include "core/scene_reader.h"
#include "rigs/run.h"
#include "tests/unit/core/scratch_folder.h"

namespace tuft::rigs {

inline Scene coarse_scene(const Overrides& more = {}) {
  Overrides overrides{{"turf.size", "[\"64 mm\", \"64 mm\"]"},
                      {"infill.sph.pitch", "5.5 mm"},
                      {"turf.carpet.strands_per_tuft", "3"},
                      {"turf.carpet.element_length", "8 mm"},
                      {"turf.carpet.backing_element", "9 mm"},
                      {"scene.duration", "20 ms"},
                      {"output.frames", "2 ms"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return read_scene("inputs/clegg_small.toml", overrides);
}

/// Where this program's tests run, removed when it ends.
inline const std::filesystem::path& scratch_root() {
  static const test::ScratchFolder folder;
  return folder.path();
}

inline std::filesystem::path scratch_folder(const std::string& name) {
  return scratch_root() / name;
}

/// A folder of its own, emptied.
inline std::filesystem::path fresh_folder(const std::string& name) {
  std::filesystem::path folder = scratch_folder(name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

inline RunRequest request_of(const std::string& name, const Overrides& overrides) {
  RunRequest request;
  request.scene = coarse_scene(overrides);
  request.folder = fresh_folder(name);
  return request;
}

inline double note(const RunSummary& summary, const std::string& name) {
  return summary.notes.at(name).value;
}

}  // namespace tuft::rigs

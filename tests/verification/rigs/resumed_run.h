#pragma once
/// A run stopped at checkpoints and gone on with must end in the bits of one that was left alone.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "core/hdf5_file.h"
#include "rigs/run.h"
#include "rigs/run_folder.h"

namespace tuft::rigs::test {

inline RunRequest request_in(const std::filesystem::path& folder, const Scene& scene) {
  std::filesystem::remove_all(folder);
  RunRequest request;
  request.scene = scene;
  request.folder = folder;
  prepare_run_folder(folder, scene);
  return request;
}

/// Stops at every `checkpoints`-th checkpoint. `column`: a history that must be the same in each row.
/// Returns how often it was stopped.
inline int expect_resumed_bits(const Scene& scene, int checkpoints, const std::string& column) {
  // Tests of one name and other parameters run side by side.
  const auto root = std::filesystem::temp_directory_path() / ("tuft_resumed_" + std::to_string(::getpid()));
  const RunRequest whole = request_in(root / "whole", scene);
  RunRequest parts = request_in(root / "parts", scene);
  const RunSummary once = run(whole);
  EXPECT_EQ(once.status, "completed") << once.error;
  EXPECT_LT(once.momentum_error, 1e-12);
  parts.stop_after_checkpoints = checkpoints;
  int stops = 0;
  RunSummary again = run(parts);
  while (again.status == "stopped" && ++stops < 100) {
    parts.resume = true;
    parts.scene = read_run_scene(parts.folder);
    again = run(parts);
  }
  EXPECT_EQ(again.status, "completed") << again.error;
  EXPECT_EQ(again.steps, once.steps);
  EXPECT_EQ(again.energy_error, once.energy_error);
  EXPECT_EQ(again.results.size(), once.results.size());
  for (const auto& [name, quantity] : once.results)
    EXPECT_EQ(again.results.at(name).value, quantity.value) << name;
  const auto history = [&](const std::filesystem::path& folder) {
    return h5::File::open(folder / "run.h5").root().open_group("history").read_doubles(column);
  };
  EXPECT_FALSE(history(whole.folder).empty());
  EXPECT_EQ(history(parts.folder), history(whole.folder));
  std::filesystem::remove_all(root);
  return stops;
}

}  // namespace tuft::rigs::test

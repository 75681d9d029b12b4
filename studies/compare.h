#pragma once
/// The same scene with both descriptions of infill, one after the other.
#include <atomic>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/scene.h"
#include "rigs/run.h"

namespace tuft::studies {

struct CompareRequest {
  std::vector<Scene> scenes;     ///< one an approach, each read and checked with its own
  std::filesystem::path folder;  ///< each run gets folder/<approach>
  const std::atomic<bool>* stop = nullptr;
  /// Called before each run starts: to attach progress and a log to it. May be empty.
  std::function<void(rigs::RunRequest&)> before_run;
  std::function<void(const rigs::RunSummary&)> after_run;  ///< called when each has ended; may be empty
};

struct ComparedRun {
  std::filesystem::path folder;
  rigs::RunSummary summary;
};

/// Folder of a scene's run below the comparison's.
[[nodiscard]] std::filesystem::path member_folder(const std::filesystem::path& folder, Approach approach);

/// Runs them in order, with all cores each: timings of one are not disturbed by the other. A run that fails
/// does not keep the next from being run; a stop does. Throws InputError before anything is computed when a
/// folder cannot be used.
[[nodiscard]] std::vector<ComparedRun> compare(const CompareRequest& request);

}  // namespace tuft::studies

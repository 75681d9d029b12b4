#pragma once
/// Figures of a whole coupled run, from the summaries of real drops.
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "bench/figure.h"

namespace tuft::bench {

struct DropRequest {
  std::filesystem::path program;  ///< the built `tuft`
  std::filesystem::path scene;
  std::filesystem::path folder;  ///< for the runs' folders; exists
  int repetitions = 1;           ///< the fastest counts, >= 1
};

/// Share of the coupled steps' wall time that is contact (search and forces), exchange with the infill's host
/// and waiting for it beyond its own steps. Steps are all phases but setup, packing and checkpoints.
[[nodiscard]] double coupling_share(const nlohmann::json& cost);

/// Runs the scene with both infills, on one and two threads. Throws std::runtime_error when a run does not
/// complete.
[[nodiscard]] Figures figures_of_drops(const DropRequest& request);

}  // namespace tuft::bench

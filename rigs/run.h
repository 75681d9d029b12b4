#pragma once
/// One run of a scene, from an empty folder or from a checkpoint, to its summary.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/scene.h"

namespace tuft::rigs {

struct Progress {
  std::string stage;         ///< "packing", "settling", "drop"
  double time = 0;           ///< s, since the release of the rig (negative while settling)
  double end_time = 0;       ///< s
  std::uint64_t window = 0;  ///< coupling windows so far
  double energy_error = 0;   ///< relative, largest so far
  double wall = 0;           ///< s since the program began this run
  double eta = 0;            ///< s, estimated wall time left; negative: not known yet
};

struct Quantity {
  double value = 0;
  std::string unit;
};

/// What summary.json holds.
struct RunSummary {
  std::string status;  ///< "completed", "stopped", "failed"
  std::string error;   ///< empty unless failed
  std::string scene_name, rig, approach, version;
  std::map<std::string, Quantity> results;  ///< empty until the rig has measured them
  double energy_error = 0;                  ///< relative, largest over the run
  double momentum_error = 0;                ///< relative, largest imbalance over all exchanges
  double simulated_time = 0;                ///< s since release
  std::uint64_t steps = 0;                  ///< coupling windows
  double wall_s = 0;
  std::map<std::string, double> cost;  ///< phase -> s
  std::uint64_t particles = 0, shells = 0;
  double particle_steps_per_s = 0, element_steps_per_s = 0;  ///< over the time spent in those phases
  std::uint64_t peak_memory_bytes = 0;                       ///< of this program and its host
  std::vector<EffectDecision> effects;
  std::vector<std::string> remarks;  ///< in words: what the user should know of what the run rests on
  std::map<std::string, Quantity>
      notes;  ///< further measures: steps of each part, initial overlap, compliance...
};

struct RunRequest {
  Scene scene;
  std::filesystem::path folder;  ///< exists and is ours to write
  bool resume = false;
  int stop_after_checkpoints =
      0;  ///< > 0: stop as by Ctrl-C after that many checkpoints (tests, long queues)
  std::function<void(const Progress&)> on_progress;   ///< called at most ten times a second
  std::function<void(const std::string&)> on_remark;  ///< each of RunSummary::remarks, as soon as it is known
  const std::atomic<bool>* stop = nullptr;            ///< set by Ctrl-C: checkpoint and stop
};

/// Runs to the end, to a stop or to a failure; always leaves summary.json, run.h5 and run.xdmf readable.
/// Failures of the run end up in the summary (status "failed"), not as exceptions; InputError is thrown. A
/// resumed run that fails before it goes on has measured nothing: if the folder has a summary, it stays as
/// it is, and the RunError is thrown.
[[nodiscard]] RunSummary run(const RunRequest& request);

/// summary.json, written atomically / read back. Throws InputError for a folder without one.
void write_summary(const std::filesystem::path& folder, const RunSummary& summary);
[[nodiscard]] RunSummary read_summary(const std::filesystem::path& folder);
[[nodiscard]] std::string summary_json(const RunSummary& summary);

/// What can be known before running.
struct RunPlan {
  std::uint64_t particles = 0, shells = 0, nodes = 0;
  double carpet_step = 0, infill_step = 0, window = 0;  ///< s, with step_safety applied
  int carpet_substeps = 1, infill_substeps = 1;
  double backing_step = 0, fibre_step = 0;  ///< s, what each would bear alone; 0: the carpet has none
  int carpet_subcycle = 1;  ///< the slower of the two is evaluated in every so many of the carpet's steps
  std::uint64_t windows = 0;
  double predicted_wall_s = 0;  ///< from a short timing of the real loops on this machine
  std::uint64_t predicted_memory_bytes = 0;
  std::vector<EffectDecision> effects;
  std::vector<std::string> remarks;  ///< overlaps at the start, bounds that bite, warnings
};
[[nodiscard]] RunPlan plan(const Scene& scene);

/// Throws InputError where a scene's grains have no host on this machine: before anything is written or
/// packed. Of one that listens elsewhere nothing is known before it is asked.
void check_host(const Scene& scene);

}  // namespace tuft::rigs

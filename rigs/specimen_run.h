#pragma once
/// Runs of rigs that test infill alone: the contract of run.h without carpet, patch and settling. Frames,
/// histories and energies of all tests follow one another in run.h5; /history/test says which is which (from
/// 0).
#include "rigs/run.h"
#include "rigs/specimen_test.h"

namespace tuft::rigs {

/// What a specimen gives without a folder to record in.
struct SpecimenOutcome {
  std::map<std::string, Quantity> results;
  std::vector<SpecimenCurve> curves;
  bool stopped = false;  ///< by `stop`; results are of what was reached
};

/// Runs all tests of a scene whose rig.is_specimen() in memory, to the same bits as run() would. Throws
/// RunError where a run would fail. Uses the threads that are set.
[[nodiscard]] SpecimenOutcome measure_specimen(const Scene& scene, const std::atomic<bool>* stop = nullptr);

/// What run() and plan() are to scenes whose rig.is_specimen().
[[nodiscard]] RunSummary run_specimen(const RunRequest& request);
[[nodiscard]] RunPlan plan_specimen(const Scene& scene);

}  // namespace tuft::rigs

#pragma once
/// Runs of rigs that test infill alone: the contract of run.h without carpet, patch and settling. Frames,
/// histories and energies of all tests follow one another in run.h5; /history/test says which is which (from
/// 0).
#include "rigs/run.h"

namespace tuft::rigs {

/// What run() and plan() are to scenes whose rig.is_specimen().
[[nodiscard]] RunSummary run_specimen(const RunRequest& request);
[[nodiscard]] RunPlan plan_specimen(const Scene& scene);

}  // namespace tuft::rigs

#pragma once
/// Runs of rigs that test the carpet's material alone: the contract of run.h (folder, summary, run.h5,
/// checkpoints) without patch and infill.
#include "rigs/run.h"

namespace tuft::rigs {

/// What run() and plan() are to scenes whose rig.is_component().
[[nodiscard]] RunSummary run_component(const RunRequest& request);
[[nodiscard]] RunPlan plan_component(const Scene& scene);

}  // namespace tuft::rigs

#pragma once
/// What the user should know of what a run rests on, in words: for its log, summary and report.
#include <string>
#include <vector>

#include "rigs/run.h"
#include "rigs/run_state.h"

namespace tuft::rigs {

/// Takes remarks into the summary and tells them as the request asks; what has been said once is not said
/// again.
void add_remarks(const RunRequest& request, const std::vector<std::string>& remarks, RunSummary& summary);

/// Of a run that is built: what `check` says too, as far as it is known now.
[[nodiscard]] std::vector<std::string> remarks_on_setup(const Scene& scene, const RunState& state);
/// Of windows that are not as the scene asks for (numerics.coupling_window), after a first interval (s):
/// which contacts bound them is not known before. rows: see remark_on_windows.
[[nodiscard]] std::vector<std::string> remarks_on_window(const Scene& scene,
                                                         const coupler::Simulation& simulation,
                                                         double interval, const std::string& rows);
/// Of a packing that the cache held and that was of no use, and of grains that were not at rest when they
/// were packed.
[[nodiscard]] std::vector<std::string> remarks_on_packing(const Scene& scene,
                                                          const coupler::PackingReport& packing);
/// The same, and of grains that were not at rest when the rig was released (nothing before that).
[[nodiscard]] std::vector<std::string> remarks_on_rest(const Scene& scene, const RunState& state);
/// Of grains that overlapped by more than a tenth of the smaller radius.
[[nodiscard]] std::vector<std::string> remarks_on_overlaps(const Scene& scene, const dem::DemInfill& infill);

}  // namespace tuft::rigs

#pragma once
/// What every run's summary has in common, whatever its rig.
#include <map>
#include <string>

#include "core/error.h"
#include "core/infill.h"
#include "core/timers.h"
#include "rigs/run.h"

namespace tuft::rigs {

/// Names, version and effects; status "failed" until the run says otherwise. Sets the number of threads that
/// the scene asks for.
[[nodiscard]] RunSummary begin_run(const Scene& scene, std::string approach);

/// Does a stage of a run. A RunError makes the run a failed one, and is its error unless there was one
/// before.
template <class Stage>
void attempt(RunSummary& summary, Stage&& stage) {
  try {
    stage();
  } catch (const RunError& error) {
    if (summary.error.empty()) summary.error = error.what();
    summary.status = "failed";
  }
}

/// Throws the failure of a resumed run that did not go on (`went_on`) where its folder has a summary: that
/// says more than this run's would.
void keep_summary(const RunRequest& request, bool went_on, const std::string& error);

/// What has left the turf, if anything has.
void add_expelled_notes(const Expelled& expelled, std::map<std::string, Quantity>& notes);

/// Phase -> s.
[[nodiscard]] std::map<std::string, double> phase_seconds(const PhaseTimers& timers);

}  // namespace tuft::rigs

#pragma once
/// What every run's summary has in common, whatever its rig.
#include <map>
#include <string>

#include "core/timers.h"
#include "rigs/run.h"

namespace tuft::rigs {

/// Names, version and effects; status "failed" until the run says otherwise. Sets the number of threads that
/// the scene asks for.
[[nodiscard]] RunSummary begin_run(const Scene& scene, std::string approach);

/// Phase -> s.
[[nodiscard]] std::map<std::string, double> phase_seconds(const PhaseTimers& timers);

}  // namespace tuft::rigs

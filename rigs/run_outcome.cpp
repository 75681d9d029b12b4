#include "rigs/run_outcome.h"

#include "core/parallel.h"

namespace tuft::rigs {

RunSummary begin_run(const Scene& scene, std::string approach) {
  RunSummary summary;
  summary.status = "failed";
  summary.scene_name = scene.info.name;
  summary.rig = scene.rig.type;
  summary.approach = std::move(approach);
  summary.version = TUFT_VERSION;
  summary.effects = decide_effects(scene);
  if (scene.numerics.threads > 0) set_threads(scene.numerics.threads);
  return summary;
}

std::map<std::string, double> phase_seconds(const PhaseTimers& timers) {
  std::map<std::string, double> seconds;
  for (std::size_t p = 0; p < phase_names.size(); ++p)
    seconds[std::string(phase_names[p])] = timers.seconds(static_cast<Phase>(p));
  return seconds;
}

}  // namespace tuft::rigs

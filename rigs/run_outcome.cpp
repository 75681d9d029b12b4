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

void keep_summary(const RunRequest& request, bool went_on, const std::string& error) {
  std::error_code ignored;
  if (request.resume && !went_on && std::filesystem::exists(request.folder / "summary.json", ignored))
    throw RunError(error);
}

void add_expelled_notes(const Expelled& expelled, std::map<std::string, Quantity>& notes) {
  if (expelled.particles == 0) return;
  notes["expelled_particles"] = {static_cast<double>(expelled.particles), "1"};
  notes["expelled_mass"] = {expelled.mass, "kg"};
  notes["expelled_momentum_x"] = {expelled.momentum.x(), "kg m/s"};
  notes["expelled_momentum_y"] = {expelled.momentum.y(), "kg m/s"};
  notes["expelled_momentum_z"] = {expelled.momentum.z(), "kg m/s"};
  notes["expelled_kinetic_energy"] = {expelled.kinetic_energy, "J"};
}

std::map<std::string, double> phase_seconds(const PhaseTimers& timers) {
  std::map<std::string, double> seconds;
  for (std::size_t p = 0; p < phase_names.size(); ++p)
    seconds[std::string(phase_names[p])] = timers.seconds(static_cast<Phase>(p));
  return seconds;
}

}  // namespace tuft::rigs

#pragma once
/// A run at the moment of its last checkpoint, to be looked at: nothing is advanced, and nothing in the run's
/// folder changes. Also of a run that is at work, for checkpoints are replaced whole.
#include <filesystem>
#include <memory>

#include "core/scene.h"
#include "coupler/simulation.h"

namespace tuft::rigs {

struct CheckpointMoment {
  double time = 0;  ///< s, as of frames
  std::unique_ptr<coupler::Simulation> simulation;
};

/// As `tuft resume` would go on from it; with grains, a host is started. `scene` is the run's own,
/// with infill. Sets the number of threads that it asks for. Throws InputError for a checkpoint that is
/// missing, damaged, of another format or of another scene; RunError when the host fails.
[[nodiscard]] CheckpointMoment restore_checkpoint(const std::filesystem::path& folder, const Scene& scene);

/// Records the moment as the only frame of a run.h5 in `folder`, which is there, and describes it in
/// run.xdmf. `scene` says what of the micro-scale is recorded (Scene::output). Throws RunError.
void record_moment(const CheckpointMoment& moment, const Scene& scene, const std::filesystem::path& folder);

}  // namespace tuft::rigs

#pragma once
/// One run in the making: simulation, rig, place on the output grid. What run.cpp drives and checkpoints
/// hold.
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coupler/bed_state.h"
#include "coupler/build_simulation.h"
#include "coupler/packing_cache.h"
#include "coupler/recorder.h"
#include "rigs/compaction.h"
#include "rigs/rig.h"
#include "rigs/schedule.h"

namespace tuft::rigs {

/// What makes two runs continue each other. Where results go and how often they are saved may differ; physics
/// may not.
[[nodiscard]] std::string physics_hash(const Scene& scene);

struct RunState {
  Schedule schedule;
  std::vector<EffectDecision> effects;
  std::unique_ptr<Rig> rig;
  coupler::BuiltSimulation built;
  std::uint64_t index = 0;         ///< intervals done
  std::vector<double> layer_tops;  ///< m above the backing, when the rig was released; empty before

  std::optional<coupler::BedState> bed_placed,
      bed_released;  ///< of grains: at rest before all else, and when the rig was released

  std::optional<coupler::PackingReport> packing;  ///< of grains, how they were packed
  std::uint64_t settled = 0;  ///< intervals of settling that grains took until they were at rest; 0: not yet

  std::optional<Compaction> compaction;  ///< of a scene with conditioning

  [[nodiscard]] coupler::Simulation& simulation() const { return *built.simulation; }
};

/// Builds what a scene asks for. `bed`: grains at rest and the carpet among them; null: they are packed, or
/// taken from the cache; a carpet of no nodes stands as made. index: where the run will go on, for SPH infill
/// that is not yet conditioned is made of spheres.
[[nodiscard]] RunState make_run_state(const Scene& scene, const coupler::Packing* bed, std::uint64_t index,
                                      const std::function<void(const std::string&, double)>& on_progress);

/// Time spent up to a checkpoint, so that a resumed run tells the cost of the whole.
struct SpentSoFar {
  double wall = 0;                     ///< s
  std::map<std::string, double> cost;  ///< phase -> s
};

/// checkpoint.h5: state, the rows recorded so far, and the hash of the scene it belongs to.
void write_checkpoint(const std::filesystem::path& path, const Scene& scene, RunState& state,
                      const std::map<std::string, std::uint64_t>& rows, const SpentSoFar& spent);

/// Intervals that a checkpoint's run had done. Throws InputError as read_checkpoint.
[[nodiscard]] std::uint64_t read_checkpoint_index(const std::filesystem::path& path, const Scene& scene);

struct CheckpointRest {
  std::map<std::string, std::uint64_t> rows;
  SpentSoFar spent;
};
/// Grains as they stand in a DEM checkpoint's frame of reference are in the state itself; a fresh DEM infill
/// only needs as many grains, with their radii: read from here before the state is built, without a carpet's
/// shape, which is in the state too. Empty for SPH.
[[nodiscard]] std::optional<coupler::Packing> read_checkpoint_bed(const std::filesystem::path& path,
                                                                  const Scene& scene);
/// Throws InputError for a file that is missing, truncated, or of another scene.
CheckpointRest read_checkpoint(const std::filesystem::path& path, const Scene& scene, RunState& state);

}  // namespace tuft::rigs

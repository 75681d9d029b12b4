#pragma once
/// Scenes as they run, stepped by hand: without a folder, records and checkpoints.
#include <functional>
#include <memory>
#include <optional>

#include "core/scene.h"
#include "coupler/packing_cache.h"
#include "coupler/simulation.h"
#include "studies/turns.h"

namespace tuft::studies {

/// s of simulated time, of one interval: between rows of histories, or of a specimen's test.
[[nodiscard]] double interval_of(const Scene& scene);

class RunningScene : public SteppedScene {
 public:
  [[nodiscard]] virtual const coupler::Simulation& simulation() const = 0;
};

/// A scene whose rig is not a component's: of a specimen the first of its tests; of a drop without its
/// conditioning. bed: of a drop, from another scene with the same grains and mesh (bed_of); null: it is
/// packed, which on_packing follows (from 0 to 1; may throw to stop it). Throws InputError for grains on
/// another machine, whose processor time is not seen here, and what building a run throws.
[[nodiscard]] std::unique_ptr<RunningScene> step_scene(const Scene& scene, const coupler::Packing* bed,
                                                       const std::function<void(double)>& on_packing);

/// Grains of a drop and its carpet before the first step; empty where the infill is none. Of the packing's
/// report nothing is known.
[[nodiscard]] std::optional<coupler::Packing> bed_of(const RunningScene& running, const Scene& scene);

}  // namespace tuft::studies

#pragma once
/// Scenes as they run, stepped by hand: without a folder, records and checkpoints.
#include <functional>
#include <memory>
#include <optional>

#include "core/scene.h"
#include "coupler/simulation.h"
#include "dem_bridge/dem_infill.h"
#include "studies/turns.h"

namespace tuft::studies {

/// s of simulated time, of one interval: between rows of histories, or of a specimen's test.
[[nodiscard]] double interval_of(const Scene& scene);

class RunningScene : public SteppedScene {
 public:
  [[nodiscard]] virtual const coupler::Simulation& simulation() const = 0;
};

/// A scene whose rig is not a component's: of a specimen the first of its tests; of a drop without its
/// conditioning. grains: of a drop, at rest, from another scene with the same; null: they are packed, which
/// on_packing follows (from 0 to 1; may throw to stop it). Throws InputError for grains on another machine,
/// whose processor time is not seen here, and what building a run throws.
[[nodiscard]] std::unique_ptr<RunningScene> step_scene(const Scene& scene, const dem::Grains* grains,
                                                       const std::function<void(double)>& on_packing);

/// Grains where they are now; empty where the infill is none.
[[nodiscard]] std::optional<dem::Grains> grains_of(const RunningScene& running, const Scene& scene);

}  // namespace tuft::studies

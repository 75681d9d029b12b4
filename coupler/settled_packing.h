#pragma once
/// Grains at rest among still fibres, kept in a cache by content so that a later run with the same inputs
/// starts at once.
#include <functional>
#include <string>
#include <vector>

#include "core/scene.h"
#include "dem_bridge/dem_infill.h"
#include "fe_carpet/carpet.h"

namespace tuft::coupler {

/// The shells of a mesh as obstacles for packing.
[[nodiscard]] std::vector<dem::ThinQuad> thin_quads(const fe::ShellMesh& mesh);

/// Packs grains geometrically among the mesh (held still), then lets them come to rest in three stages,
/// shares of infill.dem.settle_time (1.5 : 6 : 3, PHYSICS section 8): strong drag; 5 g with light drag; 1 g.
/// The result depends on the scene's turf, grain materials, DEM options, numerics.seed and the program's
/// version only: equal inputs give equal bits, from the cache or not. `from_cache` tells which. Velocities
/// are not kept: grains start at rest.
[[nodiscard]] dem::Grains settle_grains(const Scene& scene, const std::vector<EffectDecision>& effects,
                                        const fe::ShellMesh& mesh, bool& from_cache,
                                        const std::function<void(const std::string&, double)>& on_progress);

}  // namespace tuft::coupler

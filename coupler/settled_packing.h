#pragma once
/// Grains at rest among the fibres that they have pushed, kept in a cache by content so that a later run with
/// the same inputs starts at once.
#include <functional>
#include <string>
#include <vector>

#include "core/scene.h"
#include "coupler/packing_cache.h"
#include "dem_bridge/dem_infill.h"
#include "fe_carpet/carpet.h"

namespace tuft::coupler {

/// The shells of a mesh as obstacles for packing.
[[nodiscard]] std::vector<dem::ThinQuad> thin_quads(const fe::ShellMesh& mesh);

/// MPI processes of the host while these grains come to rest: the scene's, or two for 20 000 grains and more
/// where the scene asks for one, mpirun is there, and grains are spheres on this machine's own host.
[[nodiscard]] int packing_ranks(const Scene& scene, const dem::Grains& grains);

struct SettledGrains : Packing {
  bool from_cache = false;
};

/// Packs grains geometrically among the mesh as made, lays them among strands that give way (laying.h), then
/// lets both come to rest (coming_to_rest.h). The result depends on the scene's turf, grain materials, DEM
/// options, numerics.seed and step_safety, packing_ranks the mesh, and the way of packing only: equal inputs
/// give equal bits, from the cache or not. (The cache does not tell ranks apart: a bed that was packed on
/// other ranks is as good, and is taken.) Velocities are not kept.
[[nodiscard]] SettledGrains settle_grains(const Scene& scene, const std::vector<EffectDecision>& effects,
                                          const fe::ShellMesh& mesh,
                                          const std::function<void(const std::string&, double)>& on_progress);

}  // namespace tuft::coupler

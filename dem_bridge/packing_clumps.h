#pragma once
/// Clumps in the place of packed spheres: turned at random, then pushed apart as rigid bodies.
#include <functional>
#include <span>
#include <vector>

#include "dem_bridge/clump_shape.h"
#include "dem_bridge/dem_infill.h"
#include "dem_bridge/packing_relaxation.h"

namespace tuft::dem {

/// Puts the clump of its material, where there is one, in place of every sphere, with the same volume and
/// centre of mass, and pushes all apart. Turns are drawn with
/// `uniform` ([0, 1)), in the order of the grains; then all is settled by geometry alone. Walls and floor are
/// never crossed.
[[nodiscard]] Grains make_clumps(const Grains& grains, const std::vector<Material>& materials,
                                 const PackingBox& box, std::span<const ThinQuad> obstacles, int sweeps,
                                 const std::function<double()>& uniform);

}  // namespace tuft::dem

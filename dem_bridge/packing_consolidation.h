#pragma once
/// A loose cloud of spheres becomes a bed whose grains lie on each other: geometry only, so that little is
/// left to fall when dynamics begin.
#include <functional>
#include <span>

#include "dem_bridge/packing_relaxation.h"

namespace tuft::dem {

/// Pushes spheres apart, first within their slabs; takes those that stick between obstacles to free places of
/// their slab; lets them fall on each other until the bed hardly sinks; and pushes apart what overlaps still.
/// `uniform` gives numbers in [0, 1). Returns how many spheres were taken elsewhere (each as often as it
/// was).
std::size_t consolidate(LooseSpheres& spheres, const PackingBox& box, std::span<const ThinQuad> obstacles,
                        const std::function<double()>& uniform);

}  // namespace tuft::dem

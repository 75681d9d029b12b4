#pragma once
/// What grains and their contacts must fulfil beyond the range of each key, and values that follow from
/// others.
#include <string>

#include "core/scene.h"
#include "core/scene_places.h"

namespace tuft {

/// Fills in the limits of a sieve curve and checks the sizes: `path` is the grain's table in `places`. Throws
/// InputError.
void complete_grain(GrainMaterial& grain, const std::string& path, const Places& places);
/// The same for [infill.dem] of a scene whose materials are complete.
void complete_dem(Scene& scene, const Places& places);

}  // namespace tuft

#pragma once
/// What a scene must fulfil beyond the range of each key, and values that follow from others.
#include "core/scene.h"
#include "core/scene_places.h"

namespace tuft {

/// Fills in what a material leaves to others and checks it: `path` is its table in `places`. Throws
/// InputError.
void complete_material(Material& material, Index self, const std::string& path, const Places& places);
/// The same for a scene whose materials and carpet are complete.
void complete_scene(Scene& scene, const Places& places);

}  // namespace tuft

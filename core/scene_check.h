#pragma once
/// What a scene must fulfil beyond the range of each key, and values that follow from others.
#include <string>

#include "core/scene.h"
#include "core/scene_places.h"

namespace tuft {

/// Fills in what a material leaves to others and checks it: `path` is its table in `places`. Throws
/// InputError.
void complete_material(Material& material, Index self, const std::string& path, const Places& places);
/// The same for a scene whose materials and carpet are complete.
void complete_scene(Scene& scene, const Places& places);

/// The part of it that [conditioning] is (conditioning_check.cpp).
void check_conditioning(const Scene& scene, const Places& places);

/// A length for a message: "50 mm".
[[nodiscard]] std::string in_mm(double metres);

}  // namespace tuft

#pragma once
/// Parts of a scene file that are no key of a struct.
#include <string_view>

namespace tuft {

/// In [turf.carpet] and [materials.NAME] of a resolved scene: the file that the values came from. Marks the
/// table as complete, so that no file is looked for.
inline constexpr std::string_view origin_key = "from";
/// Table of the materials given in the scene itself.
inline constexpr std::string_view materials_key = "materials";

}  // namespace tuft

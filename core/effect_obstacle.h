#pragma once
/// What an effect lacks in a scene.
#include <string>
#include <string_view>

#include "core/scene.h"

namespace tuft {

/// Why `effect` could not act if it were switched on, in words; empty: it could. Throws std::logic_error for
/// a name that the program does not know.
[[nodiscard]] std::string effect_obstacle(const Scene& scene, std::string_view effect);

}  // namespace tuft

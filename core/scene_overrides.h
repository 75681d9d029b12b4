#pragma once
/// `--set key=value`: values put into a parsed scene before it is read, so that they are checked like any
/// other.
#include <toml++/toml.h>
#include <string>
#include <vector>

#include "core/scene_reader.h"

namespace tuft {

/// Returns the keys that were set. A value that is no TOML stands for itself as text: `--set
/// infill.sph.pitch="3 mm"` needs no inner quotes. List items are reached by their number from 0. Throws
/// InputError where the path leads nowhere.
std::vector<std::string> apply_overrides(toml::table& scene, const Overrides& overrides);

}  // namespace tuft

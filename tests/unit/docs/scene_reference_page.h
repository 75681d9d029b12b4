#pragma once
/// docs/scene_reference.md as it must read.
#include <string>

#include "core/scene_reader.h"

namespace tuft {

inline std::string scene_reference_page() {
  return "# All keys of a scene\n\n"
         "Made from the code that reads them, by `build/release/bin/print_scene_reference`; do not edit.\n\n"
         "Quantities are strings with a unit, such as \"2 mm\". Any unit of the right dimension will "
         "do.\n\n" +
         scene_reference();
}

}  // namespace tuft

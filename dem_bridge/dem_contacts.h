#pragma once
/// Contacts of grains as the host sends them, and as the rest of the program knows them.
#include <string>

#include "core/infill.h"

namespace tuft::dem {

/// `bytes`: the answer to Request::network; `grains`: where its forces act. Throws RunError when the answer
/// is cut off, or names grains that do not exist.
[[nodiscard]] ContactNetwork read_contacts(const std::string& bytes, const ParticleView& grains);

}  // namespace tuft::dem

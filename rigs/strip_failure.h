#pragma once
/// When a strip under tension counts as failed.
#include "fe_carpet/carpet.h"

namespace tuft::rigs {

/// Whether a part of the strip has failed.
[[nodiscard]] bool strip_failed(const fe::Carpet& carpet);

}  // namespace tuft::rigs

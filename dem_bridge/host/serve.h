#pragma once
/// One request served.
#include <string>

#include "dem_bridge/host/liggghts_engine.h"

namespace tuft::dem {

/// The answer to a request (protocol.h): done and its text, or failed and why. Never empty.
[[nodiscard]] std::string answer_to(LiggghtsEngine& engine, const std::string& message);

}  // namespace tuft::dem

#pragma once
/// A C stream for LIGGGHTS' screen output that keeps its last characters in the shared memory, where the
/// driver can read them whatever way the host ended. No file grows, and a NULL screen (which crashes some
/// commands) is avoided.
#include <cstdio>

#include "dem_bridge/protocol.h"

namespace tuft::dem {

/// `shared` must outlive the stream. Line buffered, so that words said before a crash are there.
[[nodiscard]] std::FILE* open_screen_ring(RankState& shared);

}  // namespace tuft::dem

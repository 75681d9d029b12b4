#pragma once
/// LIGGGHTS in this process, on one rank, as what listens for drivers sees a host.
#include <memory>

#include "dem_bridge/host_wire.h"

namespace tuft::dem {

/// Starts MPI. Files are those of the working folder. LIGGGHTS ends this process on an error.
[[nodiscard]] std::unique_ptr<HostWire> start_own_liggghts(std::size_t grains);

}  // namespace tuft::dem

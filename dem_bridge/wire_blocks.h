#pragma once
/// The shared memory where nothing is shared: over a network its parts travel with the messages, and each end
/// has a memory of its own. A message has one frame for the request or answer and one for each block.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "dem_bridge/protocol.h"
#include "dem_bridge/shared_memory.h"

namespace tuft::dem {

/// Requests that only a host without a common folder serves.
enum class FileRequest : char {
  write = 'W',  ///< text: a name, '\n', the bytes
  take = 'T',   ///< text: a name; answered with the bytes, and the file is removed
};

/// A part of the memory.
using Block = std::uint64_t;
inline constexpr Block state_block = 0, ranks_block = 1, loads_block = 2, first_array_block = 16;
constexpr Block array_block(std::size_t name) {
  return first_array_block + name;
}

/// What a request needs of the driver's memory. `first_window`: velocities have been set by the driver.
[[nodiscard]] std::vector<Block> blocks_to_host(Request request, bool first_window);
/// What its answer fills in; `some_expelled`: a grain has left in the window.
[[nodiscard]] std::vector<Block> blocks_to_driver(Request request, bool some_expelled);

/// A block and its number as a frame, and back. Loads are as many as the state says, which goes ahead of
/// them. `unpack` throws std::runtime_error for a block that is not of this memory, and for the state of one
/// of other grains or ranks.
[[nodiscard]] std::string pack(const SharedMemory& memory, Block block);
void unpack(SharedMemory& memory, std::string_view frame);

}  // namespace tuft::dem

#include "dem_bridge/wire_blocks.h"

#include <cstring>
#include <span>
#include <stdexcept>

namespace tuft::dem {
namespace {

std::span<std::byte> bytes_of(const SharedMemory& memory, Block block) {
  if (block == state_block) return std::as_writable_bytes(std::span(&memory.state(), 1));
  if (block == ranks_block) return memory.rank_bytes();
  if (block == loads_block) return std::as_writable_bytes(memory.loads());
  if (block >= first_array_block && block < array_block(SharedArrays::count))
    return std::as_writable_bytes(memory.array(block - first_array_block));
  throw std::runtime_error("a message holds an unknown part of the memory");
}

void add_arrays(std::vector<Block>& blocks, std::size_t first, std::size_t count) {
  for (std::size_t name = first; name < first + count; ++name) blocks.push_back(array_block(name));
}

}  // namespace

std::vector<Block> blocks_to_host(Request request, bool first_window) {
  std::vector<Block> blocks;
  switch (request) {
    case Request::hello:
    case Request::commands:
      return {state_block};
    case Request::advance:
      blocks = {state_block, loads_block};
      if (first_window) add_arrays(blocks, SharedArrays::velocity_x, 6);
      return blocks;
    case Request::resume:
      blocks = {state_block, array_block(SharedArrays::expelled)};
      add_arrays(blocks, SharedArrays::position_x, 9);
      add_arrays(blocks, SharedArrays::own_force_x, 6);
      return blocks;
    case Request::census:
      return {array_block(SharedArrays::coordination)};
    case Request::energy:
    case Request::contacts:
    case Request::network:
    case Request::save:
    case Request::quit:
      return {};
  }
  return {};
}

std::vector<Block> blocks_to_driver(Request request, bool some_expelled) {
  std::vector<Block> blocks{ranks_block};
  switch (request) {
    case Request::commands:
      add_arrays(blocks, SharedArrays::mass, 2);
      break;
    case Request::advance:
      add_arrays(blocks, SharedArrays::position_x, 9);
      if (some_expelled) blocks.push_back(array_block(SharedArrays::expelled));
      break;
    case Request::census:
    case Request::contacts:
      blocks.push_back(array_block(SharedArrays::coordination));
      break;
    case Request::save:
      add_arrays(blocks, SharedArrays::own_force_x, 6);
      break;
    case Request::hello:
    case Request::energy:
    case Request::network:
    case Request::resume:
    case Request::quit:
      break;
  }
  return blocks;
}

std::string pack(const SharedMemory& memory, Block block) {
  const auto bytes = bytes_of(memory, block);
  std::string frame(sizeof(Block) + bytes.size(), '\0');
  std::memcpy(frame.data(), &block, sizeof block);
  std::memcpy(frame.data() + sizeof block, bytes.data(), bytes.size());
  return frame;
}

void unpack(SharedMemory& memory, std::string_view frame) {
  Block block = 0;
  if (frame.size() < sizeof block) throw std::runtime_error("a message is cut off");
  std::memcpy(&block, frame.data(), sizeof block);
  const auto bytes = bytes_of(memory, block);
  if (frame.size() != sizeof block + bytes.size())
    throw std::runtime_error("a part of the memory in a message is not as large as it must be");
  if (block == state_block) {
    SharedState state;
    std::memcpy(&state, frame.data() + sizeof block, sizeof state);
    if (state.grains != memory.grains() || state.ranks != memory.ranks())
      throw std::runtime_error("a message is of other grains or ranks than those before it");
  }
  std::memcpy(bytes.data(), frame.data() + sizeof block, bytes.size());
}

}  // namespace tuft::dem

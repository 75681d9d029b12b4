#pragma once
/// Writes to a file that are held in memory until they may reach the disk.
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace tuft::h5 {

/// In the order in which they are committed.
enum class BlockKind { superblock, raw_data, metadata, object_header };

/// Byte ranges that never overlap; a later write replaces what it covers.
class WriteOverlay {
 public:
  struct Block {
    BlockKind kind;
    std::vector<unsigned char> bytes;
  };

  void put(std::uint64_t address, const unsigned char* data, std::size_t size, BlockKind kind);
  /// Copies what is held within [address, address + size) over `data`.
  void apply(std::uint64_t address, unsigned char* data, std::size_t size) const;
  [[nodiscard]] const std::map<std::uint64_t, Block>& blocks() const { return blocks_; }
  [[nodiscard]] bool empty() const { return blocks_.empty(); }

 private:
  void cut_out(std::uint64_t address, std::uint64_t end);
  std::map<std::uint64_t, Block> blocks_;  // by address
};

}  // namespace tuft::h5

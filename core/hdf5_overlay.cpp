#include "core/hdf5_overlay.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

namespace tuft::h5 {

void WriteOverlay::cut_out(std::uint64_t address, std::uint64_t end) {
  auto it = blocks_.lower_bound(address);
  if (it != blocks_.begin()) {
    auto before = std::prev(it);
    const std::uint64_t before_end = before->first + before->second.bytes.size();
    if (before_end > end) {
      const auto tail = before->second.bytes.begin() + static_cast<std::ptrdiff_t>(end - before->first);
      blocks_[end] = Block{before->second.kind, {tail, before->second.bytes.end()}};
    }
    if (before_end > address) before->second.bytes.resize(address - before->first);
  }
  it = blocks_.lower_bound(address);
  while (it != blocks_.end() && it->first < end) {
    const std::uint64_t block_end = it->first + it->second.bytes.size();
    if (block_end > end) {
      const auto tail = it->second.bytes.begin() + static_cast<std::ptrdiff_t>(end - it->first);
      blocks_[end] = Block{it->second.kind, {tail, it->second.bytes.end()}};
    }
    it = blocks_.erase(it);
  }
}

void WriteOverlay::put(std::uint64_t address, const unsigned char* data, std::size_t size, BlockKind kind) {
  if (size == 0) return;
  cut_out(address, address + size);
  blocks_[address] = Block{kind, {data, data + size}};
}

void WriteOverlay::apply(std::uint64_t address, unsigned char* data, std::size_t size) const {
  const std::uint64_t end = address + size;
  auto it = blocks_.upper_bound(address);
  if (it != blocks_.begin()) --it;
  for (; it != blocks_.end() && it->first < end; ++it) {
    const std::uint64_t from = std::max(address, it->first);
    const std::uint64_t to = std::min<std::uint64_t>(end, it->first + it->second.bytes.size());
    if (from < to)
      std::memcpy(data + (from - address), it->second.bytes.data() + (from - it->first), to - from);
  }
}

}  // namespace tuft::h5

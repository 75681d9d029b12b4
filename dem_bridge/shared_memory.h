#pragma once
/// One POSIX shared memory object with SharedState and SharedArrays in it.
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include "dem_bridge/protocol.h"

namespace tuft::dem {

class SharedMemory {
 public:
  /// A new object for `grains` grains and `ranks` ranks, zeroed. Its name exists for an instant only: only
  /// who is given the descriptor can map it, and the kernel frees it with the last process. Throws RunError.
  static SharedMemory create(std::size_t grains, std::size_t ranks = 1);
  /// Maps a descriptor that was handed over and checks magic, version and size. Throws std::runtime_error.
  static SharedMemory open(int descriptor);

  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;
  SharedMemory(const SharedMemory&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] std::size_t grains() const { return grains_; }
  [[nodiscard]] SharedState& state() const { return *static_cast<SharedState*>(memory_); }
  [[nodiscard]] std::span<double> array(std::size_t name) const {
    return {at<double>(SharedArrays::array_offset(grains_, ranks(), name)), grains_};
  }
  /// Room for one a grain, and those of the window. Throws std::runtime_error where there are more.
  [[nodiscard]] std::span<LoadRecord> load_room() const {
    return {at<LoadRecord>(SharedArrays::loads_offset(grains_, ranks())), grains_};
  }
  [[nodiscard]] std::span<LoadRecord> loads() const {
    if (state().loads > grains_) throw std::runtime_error("there are more loads than grains");
    return load_room().first(state().loads);
  }
  [[nodiscard]] std::size_t ranks() const { return state().ranks; }
  [[nodiscard]] RankState& rank(std::size_t r) const { return *at<RankState>(SharedArrays::rank_offset(r)); }
  /// The RankStates of all ranks.
  [[nodiscard]] std::span<std::byte> rank_bytes() const {
    return {at<std::byte>(SharedArrays::rank_offset(0)),
            SharedArrays::rank_offset(ranks()) - SharedArrays::rank_offset(0)};
  }
  /// The last lines LIGGGHTS printed on a rank, oldest first.
  [[nodiscard]] std::string words(std::size_t rank = 0) const;

 private:
  template <class T>
  [[nodiscard]] T* at(std::size_t offset) const {
    return reinterpret_cast<T*>(static_cast<std::byte*>(memory_) + offset);
  }
  SharedMemory(int descriptor, void* memory, std::size_t bytes, std::size_t grains)
      : descriptor_(descriptor), memory_(memory), bytes_(bytes), grains_(grains) {}
  int descriptor_ = -1;
  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
  std::size_t grains_ = 0;
};

}  // namespace tuft::dem

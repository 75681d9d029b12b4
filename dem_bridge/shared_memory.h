#pragma once
/// One POSIX shared memory object with SharedState and SharedArrays in it.
#include <cstddef>
#include <span>
#include <string>

#include "dem_bridge/protocol.h"

namespace tuft::dem {

class SharedMemory {
 public:
  /// A new object for `grains` grains, zeroed. Its name exists for an instant only: only who inherits the
  /// descriptor can map it, and the kernel frees it with the last process. Throws RunError.
  static SharedMemory create(std::size_t grains);
  /// Maps an inherited descriptor and checks magic, version and size. Throws std::runtime_error.
  static SharedMemory open(int descriptor);

  ~SharedMemory();
  SharedMemory(SharedMemory&& other) noexcept;
  SharedMemory& operator=(SharedMemory&&) = delete;
  SharedMemory(const SharedMemory&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] std::size_t grains() const { return grains_; }
  [[nodiscard]] SharedState& state() const { return *static_cast<SharedState*>(memory_); }
  [[nodiscard]] std::span<double> array(std::size_t name) const {
    return SharedArrays::view(memory_, grains_, name);
  }
  /// The last lines LIGGGHTS printed, oldest first.
  [[nodiscard]] std::string words() const;

 private:
  SharedMemory(int descriptor, void* memory, std::size_t bytes, std::size_t grains)
      : descriptor_(descriptor), memory_(memory), bytes_(bytes), grains_(grains) {}
  int descriptor_ = -1;
  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
  std::size_t grains_ = 0;
};

}  // namespace tuft::dem

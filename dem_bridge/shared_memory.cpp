#include "dem_bridge/shared_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <utility>

#include "core/error.h"

namespace tuft::dem {

SharedMemory SharedMemory::create(std::size_t grains, std::size_t ranks) {
  static std::atomic<unsigned> counter{0};
  const std::string name = fmt::format("/tuft-dem-{}-{}", ::getpid(), counter++);
  const int descriptor = ::shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0)
    throw_run_error(
        "shared memory {} cannot be created: {}; see that /dev/shm can be written and that the limit of open "
        "files (ulimit -n) is not reached",
        name, std::strerror(errno));
  ::shm_unlink(name.c_str());

  // posix_fallocate and not ftruncate alone: a full /dev/shm must be an error here, not a SIGBUS later.
  const std::size_t bytes = SharedArrays::total_bytes(grains, ranks);
  const int full = ::posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
  if (full != 0) {
    ::close(descriptor);
    throw_run_error("no room for {} bytes of shared memory for {} grains: {}; free space in /dev/shm", bytes,
                    grains, std::strerror(full));
  }
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (memory == MAP_FAILED) {
    const int reason = errno;
    ::close(descriptor);
    throw_run_error(
        "{} bytes of shared memory for {} grains cannot be mapped: {}; raise the limit of address space "
        "(ulimit -v), or use fewer grains",
        bytes, grains, std::strerror(reason));
  }
  auto* state = new (memory) SharedState;
  state->grains = grains;
  state->ranks = ranks;
  for (std::size_t r = 0; r < ranks; ++r)
    new (static_cast<std::byte*>(memory) + SharedArrays::rank_offset(r)) RankState;
  return {descriptor, memory, bytes, grains};
}

SharedMemory SharedMemory::open(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || static_cast<std::size_t>(status.st_size) < sizeof(SharedState))
    throw std::runtime_error("the shared memory is missing or too small");
  const auto bytes = static_cast<std::size_t>(status.st_size);
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("the shared memory cannot be mapped");
  const auto* state = static_cast<const SharedState*>(memory);
  if (state->magic != protocol_magic || state->version != protocol_version)
    throw std::runtime_error(
        fmt::format("protocol version {} expected, {} found: host and program are of different builds",
                    protocol_version, state->version));
  if (SharedArrays::total_bytes(state->grains, state->ranks) > bytes)
    throw std::runtime_error("the shared memory is smaller than its grains need");
  return {descriptor, memory, bytes, state->grains};
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      memory_(std::exchange(other.memory_, nullptr)),
      bytes_(other.bytes_),
      grains_(other.grains_) {}

SharedMemory::~SharedMemory() {
  if (memory_ != nullptr) ::munmap(memory_, bytes_);
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::string SharedMemory::words(std::size_t of_rank) const {
  const RankState& shared = rank(of_rank);
  const std::uint64_t end = shared.words_written;
  const std::uint64_t length = std::min<std::uint64_t>(end, shared.words.size());
  std::string text;
  for (std::uint64_t i = end - length; i < end; ++i) text += shared.words[i % shared.words.size()];
  return text;
}

}  // namespace tuft::dem

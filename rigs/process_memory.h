#pragma once
/// Memory that a run took, from /proc.
#include <cstdint>

namespace tuft::rigs {

/// Largest resident size so far of this program plus, when `other` > 0, of that process; bytes. A process
/// that is gone counts 0.
[[nodiscard]] std::uint64_t peak_memory_bytes(int other);

/// What this machine could still give to programs, bytes; 0: it does not say.
[[nodiscard]] std::uint64_t available_memory_bytes();

}  // namespace tuft::rigs

#pragma once
/// Memory that is asked for before it is read, where its order is not one that processors foresee.
#include <cstddef>

namespace tuft {

/// What memory is asked for to do with it.
enum class Access { read = 0, write = 1 };

/// Asks for `bytes` from `first` on. A hint: it changes no result, and addresses need not exist.
/// Always inlined: GCC takes a function that only asks for one without effect and drops its calls.
template <Access access = Access::read>
[[gnu::always_inline]] inline void prefetch(const void* first, std::size_t bytes) {
  constexpr std::size_t cache_line = 64;
  for (std::size_t byte = 0; byte < bytes; byte += cache_line)
    __builtin_prefetch(static_cast<const char*>(first) + byte, static_cast<int>(access));
}

}  // namespace tuft

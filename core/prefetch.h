#pragma once
/// Memory that is asked for before it is read, where its order is not one that processors foresee.
#include <cstddef>
#include <cstdint>

namespace tuft {

inline constexpr std::size_t cache_line = 64;

/// What memory is asked for to do with it.
enum class Access { read = 0, write = 1 };

/// Calls ask(address) with an address in each cache line that holds some of the `bytes` from `first` on,
/// which is a multiple of `alignment`. Their number is known to the compiler where that of the bytes is: what
/// does not begin with a line may end in one more, so that its last byte is asked for in any case.
template <std::size_t alignment, class Ask>
[[gnu::always_inline]] constexpr void for_cache_lines(std::uintptr_t first, std::size_t bytes, Ask&& ask) {
  for (std::size_t byte = 0; byte < bytes; byte += cache_line) ask(first + byte);
  if (alignment % cache_line != 0 && bytes > 1) ask(first + bytes - 1);
}

/// Asks for `count` values from `first` on. A hint: it changes no result, and addresses need not exist, which
/// is why they are reckoned as numbers: a pointer may not leave its array.
/// Always inlined: GCC takes a function that only asks for one without effect and drops its calls.
template <Access access = Access::read, class T>
[[gnu::always_inline]] inline void prefetch(const T* first, std::size_t count) {
  for_cache_lines<alignof(T)>(
      reinterpret_cast<std::uintptr_t>(first), count * sizeof(T),
      [](std::uintptr_t address) __attribute__((always_inline)) {
        __builtin_prefetch(reinterpret_cast<const void*>(address), static_cast<int>(access));
      });
}

}  // namespace tuft

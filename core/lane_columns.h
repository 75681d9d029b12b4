#pragma once
/// Values that lie together in memory, by rows, loaded as packs, by columns: lane l of column c is value c of
/// row index[l]. A row is read whole, as neighbours' values in a pair loop should be, and the lanes are
/// sorted out in registers: several times faster than gathering column by column.
#include <array>
#include <bit>
#include <utility>

#include "core/lanes.h"

namespace tuft {
namespace detail {

// The compilers' vector extension, for shuffles, which the standard's packs do not have.
template <class T, std::size_t count>
struct VectorOf {
  using type __attribute__((vector_size(count * sizeof(T)))) = T;
  /// The same at any address of a T.
  using unaligned __attribute__((vector_size(count * sizeof(T)), aligned(alignof(T)), may_alias)) = T;
};
template <class T, std::size_t count>
using Vector = typename VectorOf<T, count>::type;

/// Whole registers are rearranged within each group of four lanes.
inline constexpr bool lanes_by_fours = lanes == 4 || lanes == 8;

template <class T>
Vector<T, 4> load_four(const T* first) {
  return *reinterpret_cast<const typename VectorOf<T, 4>::unaligned*>(first);
}

/// Four values of row index[k], and with 8 lanes of row index[k + 4] behind them.
template <class T>
Vector<T, lanes> load_fours(const T* table, std::size_t row_length, const Index* index, std::size_t k) {
  const auto row = [&](std::size_t lane) {
    return load_four(table + static_cast<std::size_t>(index[lane]) * row_length);
  };
  if constexpr (lanes == 8)
    return __builtin_shufflevector(row(k), row(k + 4), 0, 1, 2, 3, 4, 5, 6, 7);
  else
    return row(k);
}

/// Lane l of the result is lane `pick(l % 4)` of a's, or with `from_b(l % 4)` of b's, same group of four.
template <class Pattern, class V, std::size_t... l>
V shuffled(const V& a, const V& b, std::index_sequence<l...> /*lanes*/) {
  return __builtin_shufflevector(
      a, b, static_cast<int>(l / 4 * 4 + Pattern::pick(l % 4) + (Pattern::from_b(l % 4) ? lanes : 0))...);
}
template <class Pattern, class V>
V shuffled(const V& a, const V& b) {
  return shuffled<Pattern>(a, b, std::make_index_sequence<lanes>());
}
/// a0 b0 a2 b2 (offset 0) or a1 b1 a3 b3 (offset 1)
template <std::size_t offset>
struct Interleave {
  static constexpr std::size_t pick(std::size_t l) { return l / 2 * 2 + offset; }
  static constexpr bool from_b(std::size_t l) { return l % 2 == 1; }
};
/// a0 a1 b0 b1 (offset 0) or a2 a3 b2 b3 (offset 2)
template <std::size_t offset>
struct Halves {
  static constexpr std::size_t pick(std::size_t l) { return l % 2 + offset; }
  static constexpr bool from_b(std::size_t l) { return l / 2 == 1; }
};

inline Pack to_pack(const Vector<double, lanes>& v) {
  return std::bit_cast<Pack>(v);
}
inline Pack to_pack(const Vector<float, lanes>& v) {
  return std::bit_cast<Pack>(__builtin_convertvector(v, Vector<double, lanes>));
}

}  // namespace detail

/// The first `columns` values (a multiple of 4) of the rows index[0] to index[lanes - 1].
template <std::size_t columns, class T>
[[nodiscard]] inline std::array<Pack, columns> load_columns(const T* table, std::size_t row_length,
                                                            const Index* index) {
  static_assert(columns % 4 == 0);
  std::array<Pack, columns> column;
  if constexpr (detail::lanes_by_fours) {
    using namespace detail;
    for (std::size_t c = 0; c < columns; c += 4) {
      const auto r0 = load_fours(table + c, row_length, index, 0),
                 r1 = load_fours(table + c, row_length, index, 1),
                 r2 = load_fours(table + c, row_length, index, 2),
                 r3 = load_fours(table + c, row_length, index, 3);
      const auto even01 = shuffled<Interleave<0>>(r0, r1), odd01 = shuffled<Interleave<1>>(r0, r1),
                 even23 = shuffled<Interleave<0>>(r2, r3), odd23 = shuffled<Interleave<1>>(r2, r3);
      column[c] = to_pack(shuffled<Halves<0>>(even01, even23));
      column[c + 1] = to_pack(shuffled<Halves<0>>(odd01, odd23));
      column[c + 2] = to_pack(shuffled<Halves<2>>(even01, even23));
      column[c + 3] = to_pack(shuffled<Halves<2>>(odd01, odd23));
    }
  } else {
    for (std::size_t c = 0; c < columns; ++c)
      column[c] = Pack([&](auto lane) {
        return static_cast<double>(table[static_cast<std::size_t>(index[lane]) * row_length + c]);
      });
  }
  return column;
}

}  // namespace tuft

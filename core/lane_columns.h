#pragma once
/// Values that lie together in memory, by rows, loaded as packs, by columns: lane l of column c is value c of
/// row index[l]. A row is read whole, as neighbours' values in a pair loop should be, and the lanes are
/// sorted out in registers: several times faster than gathering column by column.
#include <array>
#include <bit>
#include <type_traits>
#include <utility>

#include "core/lanes.h"
#ifdef __AVX__
#include <immintrin.h>
#endif

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

/// Whole registers are rearranged where lanes come in fours.
inline constexpr bool lanes_by_fours = lanes == 4 || lanes == 8;

/// Four values of a row.
template <class T>
Vector<T, 4> load_four(const T* first) {
  return *reinterpret_cast<const typename VectorOf<T, 4>::unaligned*>(first);
}

/// Four values of row index[k], and with 8 lanes four of row index[above] behind them.
template <class T>
Vector<T, lanes> load_fours(const T* table, std::size_t row_length, const Index* index, std::size_t k,
                            [[maybe_unused]] std::size_t above) {
  const auto row = [&](std::size_t lane) {
    return load_four(table + static_cast<std::size_t>(index[lane]) * row_length);
  };
  if constexpr (lanes == 4) {
    return row(k);
  } else {
#ifdef __AVX512F__
    // One instruction that loads and inserts; of the general shuffle compilers make two.
    if constexpr (std::is_same_v<T, double>)
      return std::bit_cast<Vector<T, lanes>>(
          _mm512_insertf64x4(_mm512_castpd256_pd512(row(k)), row(above), 1));
    else
      return std::bit_cast<Vector<T, lanes>>(
          _mm256_insertf128_ps(_mm256_castps128_ps256(row(k)), row(above), 1));
#else
    return __builtin_shufflevector(row(k), row(above), 0, 1, 2, 3, 4, 5, 6, 7);
#endif
  }
}

/// Lane l of the result is lane pick(l) of a and, counted on, b.
template <auto pick, class V, std::size_t... l>
V shuffled(const V& a, const V& b, std::index_sequence<l...> /*lanes*/) {
  return __builtin_shufflevector(a, b, static_cast<int>(pick(l))...);
}
template <auto pick, class V>
V shuffled(const V& a, const V& b) {
  return shuffled<pick>(a, b, std::make_index_sequence<lanes>());
}

// What follows moves values within pieces of 16 bytes, or whole pieces: one quick instruction each.

/// a0 b0 a2 b2 (offset 0) or a1 b1 a3 b3 (offset 1), and so on.
template <std::size_t offset>
Vector<double, lanes> interleaved(const Vector<double, lanes>& a, const Vector<double, lanes>& b) {
  return shuffled<[](std::size_t l) { return l / 2 * 2 + offset + l % 2 * lanes; }>(a, b);
}
/// a0 a1 a4 a5 and so on, then of b (offset 0), or a2 a3 a6 a7 (offset 2).
template <std::size_t offset>
Vector<double, lanes> every_other_two(const Vector<double, lanes>& a, const Vector<double, lanes>& b) {
  return shuffled<[](std::size_t l) { return l / 2 * 4 + offset + l % 2; }>(a, b);
}
/// a0 b0 a1 b1 a4 b4 a5 b5 (offset 0) or a2 b2 a3 b3 a6 b6 a7 b7 (offset 2).
template <std::size_t offset>
Vector<float, lanes> interleaved(const Vector<float, lanes>& a, const Vector<float, lanes>& b) {
  return shuffled<[](std::size_t l) { return l / 4 * 4 + offset + l % 4 / 2 + l % 2 * lanes; }>(a, b);
}
/// a0 a1 b0 b1 a4 a5 b4 b5 (offset 0) or a2 a3 b2 b3 a6 a7 b6 b7 (offset 2).
template <std::size_t offset>
Vector<float, lanes> halves(const Vector<float, lanes>& a, const Vector<float, lanes>& b) {
  return shuffled<[](std::size_t l) { return l / 4 * 4 + offset + l % 2 + l % 4 / 2 * lanes; }>(a, b);
}

inline Pack to_pack(const Vector<double, lanes>& v) {
  return std::bit_cast<Pack>(v);
}
inline Pack to_pack(const Vector<float, lanes>& v) {
#ifdef __AVX512F__
  if constexpr (lanes == 8) return std::bit_cast<Pack>(_mm512_cvtps_pd(v));  // GCC 12 makes four of it
#endif
#ifdef __AVX__
  if constexpr (lanes == 4) return std::bit_cast<Pack>(_mm256_cvtps_pd(std::bit_cast<__m128>(v)));
#endif
  return std::bit_cast<Pack>(__builtin_convertvector(v, Vector<double, lanes>));
}

/// Four values of the rows named, as columns from `column` on.
inline void load_four_columns(const double* table, std::size_t row_length, const Index* index, Pack* column) {
  const auto rows = [&](std::size_t k) { return load_fours(table, row_length, index, k, k + 2); };
  constexpr std::size_t half = lanes / 2;  // the lanes of a and b; with 8 of them, rows 0 to 3
  const auto a = rows(0), b = rows(1), c = rows(half), d = rows(half + 1);
  const auto low_ab = interleaved<0>(a, b), high_ab = interleaved<1>(a, b), low_cd = interleaved<0>(c, d),
             high_cd = interleaved<1>(c, d);
  column[0] = to_pack(every_other_two<0>(low_ab, low_cd));
  column[1] = to_pack(every_other_two<0>(high_ab, high_cd));
  column[2] = to_pack(every_other_two<2>(low_ab, low_cd));
  column[3] = to_pack(every_other_two<2>(high_ab, high_cd));
}
inline void load_four_columns(const float* table, std::size_t row_length, const Index* index, Pack* column) {
  const auto rows = [&](std::size_t k) { return load_fours(table, row_length, index, k, k + 4); };
  const auto a = rows(0), b = rows(1), c = rows(2), d = rows(3);
  const auto low_ab = interleaved<0>(a, b), high_ab = interleaved<2>(a, b), low_cd = interleaved<0>(c, d),
             high_cd = interleaved<2>(c, d);
  column[0] = to_pack(halves<0>(low_ab, low_cd));
  column[1] = to_pack(halves<2>(low_ab, low_cd));
  column[2] = to_pack(halves<0>(high_ab, high_cd));
  column[3] = to_pack(halves<2>(high_ab, high_cd));
}

}  // namespace detail

/// Four values that lie side by side, of one particle.
using Four = detail::Vector<double, 4>;

[[nodiscard]] inline Four load_four_in_double(const float* first) {
#ifdef __AVX__
  return std::bit_cast<Four>(_mm256_cvtps_pd(_mm_loadu_ps(first)));  // GCC 12 makes four of it
#else
  return __builtin_convertvector(detail::load_four(first), Four);
#endif
}

/// The first `columns` values (a multiple of 4) of the rows index[0] to index[lanes - 1].
template <std::size_t columns, class T>
[[nodiscard]] inline std::array<Pack, columns> load_columns(const T* table, std::size_t row_length,
                                                            const Index* index) {
  static_assert(columns % 4 == 0);
  std::array<Pack, columns> column;
  if constexpr (detail::lanes_by_fours) {
    for (std::size_t c = 0; c < columns; c += 4)
      detail::load_four_columns(table + c, row_length, index, &column[c]);
  } else {
    for (std::size_t c = 0; c < columns; ++c)
      column[c] = Pack([&](auto lane) {
        return static_cast<double>(table[static_cast<std::size_t>(index[lane]) * row_length + c]);
      });
  }
  return column;
}

}  // namespace tuft

#pragma once
/// Values that lie together in memory, by rows, loaded as packs, by columns: lane l of column c is value c of
/// row index[l]. A row is read whole, as neighbours' values in a pair loop should be, and the lanes are
/// sorted out in registers: several times faster than gathering column by column.
#include <array>
#include <bit>
#include <cstdint>
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

#ifdef __AVX__  // lanes come in fours; elsewhere values are taken one by one
/// Four values of a row.
template <class T>
Vector<T, 4> load_four(const T* first) {
  return *reinterpret_cast<const typename VectorOf<T, 4>::unaligned*>(first);
}

/// Lane l of the result is lane pick(l) of a and, counted on, b.
template <auto pick, class V, std::size_t... l>
V shuffled(const V& a, const V& b, std::index_sequence<l...> /*lanes*/) {
  return __builtin_shufflevector(a, b, static_cast<int>(pick(l))...);
}
template <auto pick, std::size_t count, class V>
V shuffled(const V& a, const V& b) {
  return shuffled<pick>(a, b, std::make_index_sequence<count>());
}

// What follows moves values within pieces of 16 bytes, or whole pieces: one quick instruction each.

/// a0 b0 a2 b2 (offset 0) or a1 b1 a3 b3 (offset 1), and so on.
template <std::size_t offset>
Vector<double, lanes> interleaved(const Vector<double, lanes>& a, const Vector<double, lanes>& b) {
  return shuffled<[](std::size_t l) { return l / 2 * 2 + offset + l % 2 * lanes; }, lanes>(a, b);
}
/// a0 a1 a4 a5 and so on, then of b (offset 0), or a2 a3 a6 a7 (offset 2).
template <std::size_t offset>
Vector<double, lanes> every_other_two(const Vector<double, lanes>& a, const Vector<double, lanes>& b) {
  return shuffled<[](std::size_t l) { return l / 2 * 4 + offset + l % 2; }, lanes>(a, b);
}

/// Four values of row index[k], and with 8 lanes four of row index[above] behind them.
inline Vector<double, lanes> load_fours(const double* table, std::size_t row_length, const Index* index,
                                        std::size_t k, [[maybe_unused]] std::size_t above) {
  const auto row = [&](std::size_t lane) {
    return load_four(table + static_cast<std::size_t>(index[lane]) * row_length);
  };
#ifdef __AVX512F__
  // One instruction that loads and inserts; of the general shuffle compilers make two.
  return std::bit_cast<Vector<double, lanes>>(
      _mm512_insertf64x4(_mm512_castpd256_pd512(row(k)), row(above), 1));
#else
  return row(k);
#endif
}

/// Four values of the rows named, as columns from `column` on.
inline void load_four_columns(const double* table, std::size_t row_length, const Index* index, Pack* column) {
  const auto rows = [&](std::size_t k) { return load_fours(table, row_length, index, k, k + 2); };
  const auto to_pack = [](const Vector<double, lanes>& v) { return std::bit_cast<Pack>(v); };
  constexpr std::size_t half = lanes / 2;  // the lanes of a and b; with 8 of them, rows 0 to 3
  const auto a = rows(0), b = rows(1), c = rows(half), d = rows(half + 1);
  const auto low_ab = interleaved<0>(a, b), high_ab = interleaved<1>(a, b), low_cd = interleaved<0>(c, d),
             high_cd = interleaved<1>(c, d);
  column[0] = to_pack(every_other_two<0>(low_ab, low_cd));
  column[1] = to_pack(every_other_two<0>(high_ab, high_cd));
  column[2] = to_pack(every_other_two<2>(low_ab, low_cd));
  column[3] = to_pack(every_other_two<2>(high_ab, high_cd));
}

using Singles = Vector<float, single_lanes>;

/// a0 b0 a1 b1 a4 b4 a5 b5 (offset 0) or a2 b2 a3 b3 a6 b6 a7 b7 (offset 2).
template <std::size_t offset>
Singles interleaved(const Singles& a, const Singles& b) {
  return shuffled<[](std::size_t l) { return l / 4 * 4 + offset + l % 4 / 2 + l % 2 * single_lanes; },
                  single_lanes>(a, b);
}
/// a0 a1 b0 b1 a4 a5 b4 b5 (offset 0) or a2 a3 b2 b3 a6 a7 b6 b7 (offset 2).
template <std::size_t offset>
Singles halves(const Singles& a, const Singles& b) {
  return shuffled<[](std::size_t l) { return l / 4 * 4 + offset + l % 2 + l % 4 / 2 * single_lanes; },
                  single_lanes>(a, b);
}

inline void load_four_columns(const float* table, std::size_t row_length, const Index* index,
                              SinglePack* column) {
  const auto row = [&](std::size_t lane) {
    return _mm_loadu_ps(table + static_cast<std::size_t>(index[lane]) * row_length);
  };
  const auto rows = [&](std::size_t k) {  // one instruction that loads and inserts
    return std::bit_cast<Singles>(_mm256_insertf128_ps(_mm256_castps128_ps256(row(k)), row(k + 4), 1));
  };
  const auto to_pack = [](const Singles& v) { return std::bit_cast<SinglePack>(v); };
  const auto a = rows(0), b = rows(1), c = rows(2), d = rows(3);
  const auto low_ab = interleaved<0>(a, b), high_ab = interleaved<2>(a, b), low_cd = interleaved<0>(c, d),
             high_cd = interleaved<2>(c, d);
  column[0] = to_pack(halves<0>(low_ab, low_cd));
  column[1] = to_pack(halves<2>(low_ab, low_cd));
  column[2] = to_pack(halves<0>(high_ab, high_cd));
  column[3] = to_pack(halves<2>(high_ab, high_cd));
}
#endif

}  // namespace detail

/// The first `columns` values (a multiple of 4) of the rows index[0] to index[lanes - 1].
template <std::size_t columns>
[[nodiscard]] inline std::array<Pack, columns> load_columns(const double* table, std::size_t row_length,
                                                            const Index* index) {
  static_assert(columns % 4 == 0);
  std::array<Pack, columns> column;
  for (std::size_t c = 0; c < columns; c += 4) {
#ifdef __AVX__
    detail::load_four_columns(table + c, row_length, index, &column[c]);
#else
    for (std::size_t k = c; k < c + 4; ++k)
      column[k] =
          Pack([&](auto lane) { return table[static_cast<std::size_t>(index[lane]) * row_length + k]; });
#endif
  }
  return column;
}
/// The same of single-precision rows index[0] to index[single_lanes - 1].
template <std::size_t columns>
[[nodiscard]] inline std::array<SinglePack, columns> load_columns(const float* table, std::size_t row_length,
                                                                  const Index* index) {
  static_assert(columns % 4 == 0);
  std::array<SinglePack, columns> column;
  for (std::size_t c = 0; c < columns; c += 4) {
#ifdef __AVX__
    detail::load_four_columns(table + c, row_length, index, &column[c]);
#else
    for (std::size_t k = c; k < c + 4; ++k)
      column[k] = SinglePack(
          [&](auto lane) { return table[static_cast<std::size_t>(index[lane]) * row_length + k]; });
#endif
  }
  return column;
}

/// In double precision, as many as there are lanes after each other.
[[nodiscard]] inline std::array<Pack, packs_of_single> widened(const SinglePack& single) {
  std::array<Pack, packs_of_single> wide;
#if defined(__AVX512F__)
  wide[0] = std::bit_cast<Pack>(_mm512_cvtps_pd(std::bit_cast<__m256>(single)));
#elif defined(__AVX__)
  const auto all = std::bit_cast<__m256>(single);
  wide[0] = std::bit_cast<Pack>(_mm256_cvtps_pd(_mm256_castps256_ps128(all)));
  wide[1] = std::bit_cast<Pack>(_mm256_cvtps_pd(_mm256_extractf128_ps(all, 1)));
#else
  for (std::size_t k = 0; k < packs_of_single; ++k)
    wide[k] = Pack([&](auto lane) { return static_cast<double>(single[k * lanes + lane]); });
#endif
  return wide;
}

/// a - b of 32-bit integers that lie in the packs' bits, modulo 2^32, as numbers: exact below 2^24.
[[nodiscard]] inline SinglePack integer_difference(const SinglePack& a, const SinglePack& b) {
#ifdef __AVX__
  using Unsigned = detail::Vector<std::uint32_t, single_lanes>;
  using Signed = detail::Vector<std::int32_t, single_lanes>;
  const auto difference = std::bit_cast<Signed>(std::bit_cast<Unsigned>(a) - std::bit_cast<Unsigned>(b));
  return std::bit_cast<SinglePack>(__builtin_convertvector(difference, detail::Singles));
#else
  return SinglePack([&](auto lane) {
    const auto of = [lane](const SinglePack& p) { return std::bit_cast<std::uint32_t>(float(p[lane])); };
    return static_cast<float>(static_cast<std::int32_t>(of(a) - of(b)));
  });
#endif
}

}  // namespace tuft

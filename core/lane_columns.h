#pragma once
/// Values that lie together in memory, by rows, loaded as packs, by columns: lane l of column c is value c of
/// the row of lane l. A row is read whole, as neighbours' values in a pair loop should be, and the lanes are
/// sorted out in registers: several times faster than gathering column by column. Rows are stored likewise.
#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "core/lanes.h"
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace tuft {

template <class T>
using PackOf = std::conditional_t<std::is_same_v<T, float>, SinglePack, Pack>;

/// Rows of a table, a lane each: that of lane l begins at[l] times `bytes` behind the table's beginning.
template <class T, std::size_t bytes>
struct RowsOf {
  const T* table;
  std::array<std::size_t, PackOf<T>::size()> at;

  [[nodiscard]] const T* row(std::size_t lane) const {
    return reinterpret_cast<const T*>(reinterpret_cast<const char*>(table) + bytes * at[lane]);
  }
  [[nodiscard]] RowsOf from(std::size_t column) const { return {table + column, at}; }
};

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
auto shuffled(const V& a, const V& b, std::index_sequence<l...> /*lanes*/) {
  return __builtin_shufflevector(a, b, static_cast<int>(pick(l))...);
}
template <auto pick, std::size_t count, class V>
auto shuffled(const V& a, const V& b) {
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

/// Four values of row k, and with 8 lanes four of row `above` behind them.
template <std::size_t bytes>
Vector<double, lanes> load_fours(const RowsOf<double, bytes>& rows, std::size_t k,
                                 [[maybe_unused]] std::size_t above) {
#ifdef __AVX512F__
  // One instruction that loads and inserts; of the general shuffle compilers make two.
  return std::bit_cast<Vector<double, lanes>>(
      _mm512_insertf64x4(_mm512_castpd256_pd512(load_four(rows.row(k))), load_four(rows.row(above)), 1));
#else
  return load_four(rows.row(k));
#endif
}

/// Four values of the rows, as columns from `column` on.
template <std::size_t bytes>
void load_four_columns(const RowsOf<double, bytes>& rows, Pack* column) {
  const auto to_pack = [](const Vector<double, lanes>& v) { return std::bit_cast<Pack>(v); };
  constexpr std::size_t half = lanes / 2;  // the lanes of a and b; with 8 of them, rows 0 to 3
  const auto a = load_fours(rows, 0, 2), b = load_fours(rows, 1, 3), c = load_fours(rows, half, half + 2),
             d = load_fours(rows, half + 1, half + 3);
  const auto low_ab = interleaved<0>(a, b), high_ab = interleaved<1>(a, b), low_cd = interleaved<0>(c, d),
             high_cd = interleaved<1>(c, d);
  column[0] = to_pack(every_other_two<0>(low_ab, low_cd));
  column[1] = to_pack(every_other_two<0>(high_ab, high_cd));
  column[2] = to_pack(every_other_two<2>(low_ab, low_cd));
  column[3] = to_pack(every_other_two<2>(high_ab, high_cd));
}

using Singles = Vector<float, single_lanes>;

template <class V>
inline constexpr std::size_t lanes_of = sizeof(V) / sizeof(float);

/// a0 b0 a1 b1 a4 b4 a5 b5 (offset 0) or a2 b2 a3 b3 a6 b6 a7 b7 (offset 2).
template <std::size_t offset, class V>
V interleaved_singles(const V& a, const V& b) {
  return shuffled<[](std::size_t l) { return l / 4 * 4 + offset + l % 4 / 2 + l % 2 * lanes_of<V>; },
                  lanes_of<V>>(a, b);
}
/// a0 a1 b0 b1 a4 a5 b4 b5 (offset 0) or a2 a3 b2 b3 a6 a7 b6 b7 (offset 2).
template <std::size_t offset, class V>
V halves(const V& a, const V& b) {
  return shuffled<[](std::size_t l) { return l / 4 * 4 + offset + l % 2 + l % 4 / 2 * lanes_of<V>; },
                  lanes_of<V>>(a, b);
}

/// Columns of four rows, or rows of four columns; with 8 lanes two such squares side by side.
template <class V>
std::array<V, 4> transposed(const V& a, const V& b, const V& c, const V& d) {
  const auto low_ab = interleaved_singles<0>(a, b), high_ab = interleaved_singles<2>(a, b),
             low_cd = interleaved_singles<0>(c, d), high_cd = interleaved_singles<2>(c, d);
  return {halves<0>(low_ab, low_cd), halves<2>(low_ab, low_cd), halves<0>(high_ab, high_cd),
          halves<2>(high_ab, high_cd)};
}

template <std::size_t bytes>
[[gnu::always_inline]] inline void load_four_columns(const RowsOf<float, bytes>& rows, SinglePack* column) {
  const auto pair = [&](std::size_t k) {  // one instruction that loads and inserts
    return std::bit_cast<Singles>(_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(rows.row(k))),
                                                       _mm_loadu_ps(rows.row(k + 4)), 1));
  };
  const auto columns = transposed(pair(0), pair(1), pair(2), pair(3));
  for (std::size_t k = 0; k < 4; ++k) column[k] = std::bit_cast<SinglePack>(columns[k]);
}
#endif

}  // namespace detail

/// The first `columns` values (a multiple of 4) of the rows.
template <std::size_t columns, class T, std::size_t bytes>
[[nodiscard]] inline std::array<PackOf<T>, columns> load_columns(const RowsOf<T, bytes>& rows) {
  static_assert(columns % 4 == 0);
  std::array<PackOf<T>, columns> column;
  for (std::size_t c = 0; c < columns; c += 4) {
#ifdef __AVX__
    detail::load_four_columns(rows.from(c), &column[c]);
#else
    for (std::size_t k = c; k < c + 4; ++k)
      column[k] = PackOf<T>([&](auto lane) { return rows.row(lane)[k]; });
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

/// As many numbers of single precision as there are lanes.
using NarrowPack = stdx::simd<float, stdx::simd_abi::deduce_t<float, lanes>>;

[[nodiscard]] inline NarrowPack narrowed(const Pack& wide) {
#if defined(__AVX512F__)
  return std::bit_cast<NarrowPack>(_mm512_cvtpd_ps(std::bit_cast<__m512d>(wide)));
#elif defined(__AVX__)
  return std::bit_cast<NarrowPack>(_mm256_cvtpd_ps(std::bit_cast<__m256d>(wide)));
#else
  return NarrowPack([&](auto lane) { return static_cast<float>(wide[lane]); });
#endif
}

/// The last 32 bits of each.
[[nodiscard]] inline NarrowPack low_halves(const Pack& wide) {
#ifdef __AVX__
  using V = detail::Vector<float, 2 * lanes>;
  const auto halves = std::bit_cast<V>(wide);
  return std::bit_cast<NarrowPack>(
      detail::shuffled<[](std::size_t l) { return 2 * l; }, lanes>(halves, halves));
#else
  return NarrowPack([&](auto lane) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(double(wide[lane]))));
  });
#endif
}

/// Four columns as four values of each of `count` rows (at most as many as there are lanes), `row_length`
/// apart.
inline void store_four_columns(const std::array<NarrowPack, 4>& column, std::size_t count, float* first,
                               std::size_t row_length) {
#ifdef __AVX__
  using V = detail::Vector<float, lanes>;
  if (count == lanes) {
    const auto rows = detail::transposed(std::bit_cast<V>(column[0]), std::bit_cast<V>(column[1]),
                                         std::bit_cast<V>(column[2]), std::bit_cast<V>(column[3]));
    // Four values, of row k and with 8 lanes of row 4 + k.
    for (std::size_t k = 0; k < 4; ++k) {
#ifdef __AVX512F__
      const auto both = std::bit_cast<__m256>(rows[k]);
      _mm_storeu_ps(first + k * row_length, _mm256_castps256_ps128(both));
      _mm_storeu_ps(first + (4 + k) * row_length, _mm256_extractf128_ps(both, 1));
#else
      _mm_storeu_ps(first + k * row_length, std::bit_cast<__m128>(rows[k]));
#endif
    }
    return;
  }
#endif
  for (std::size_t l = 0; l < count; ++l)
    for (std::size_t c = 0; c < 4; ++c) first[l * row_length + c] = column[c][l];
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

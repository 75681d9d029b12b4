#pragma once
/// Functions of a Pack that the standard library has for one number alone, and what lets one template serve
/// both. A template calls exp, expm1 and log1p by these names without `using std::exp`: that would hide them,
/// and the standard library's own for packs, found in their place, take one lane after the other.
///
/// Each follows from its series after reduction of the argument; within 3 units in the last place of the
/// correctly rounded value for the ranges given (tests/unit/core/lane_math_test.cpp).
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/lanes.h"
#ifdef __AVX__
#include <immintrin.h>
#endif

namespace tuft {

using PackMask = Pack::mask_type;
/// The bits of a pack's numbers.
using PackBits = stdx::rebind_simd_t<std::int64_t, Pack>;

[[nodiscard]] inline double select(bool which, double yes, double no) {
  return which ? yes : no;
}
[[nodiscard]] inline Pack select(const PackMask& which, const Pack& yes, const Pack& no) {
  Pack chosen = no;
  stdx::where(which, chosen) = yes;
  return chosen;
}
[[nodiscard]] inline SinglePack select(const SinglePack::mask_type& which, const SinglePack& yes,
                                       const SinglePack& no) {
  SinglePack chosen = no;
  stdx::where(which, chosen) = yes;
  return chosen;
}
/// Bit l: whether lane l is below the limit; NaN is not.
[[nodiscard]] inline unsigned lanes_below(const Pack& value, double limit) {
#if defined(__AVX512F__)
  return _mm512_cmp_pd_mask(std::bit_cast<__m512d>(value), _mm512_set1_pd(limit), _CMP_LT_OQ);
#elif defined(__AVX__)
  return static_cast<unsigned>(
      _mm256_movemask_pd(_mm256_cmp_pd(std::bit_cast<__m256d>(value), _mm256_set1_pd(limit), _CMP_LT_OQ)));
#else
  unsigned bits = 0;
  for (std::size_t l = 0; l < lanes; ++l) bits |= static_cast<unsigned>(value[l] < limit) << l;
  return bits;
#endif
}
[[nodiscard]] inline bool any(bool which) {
  return which;
}
[[nodiscard]] inline bool any(const PackMask& which) {
  return stdx::any_of(which);
}

[[nodiscard]] inline bool all(bool which) {
  return which;
}
[[nodiscard]] inline bool all(const PackMask& which) {
  return stdx::all_of(which);
}
[[nodiscard]] inline double exp(double x) {
  return std::exp(x);
}
[[nodiscard]] inline double expm1(double x) {
  return std::expm1(x);
}
[[nodiscard]] inline double log1p(double x) {
  return std::log1p(x);
}

namespace detail {

/// sum_k c[k] x^k by Horner's rule.
template <std::size_t count>
[[nodiscard]] inline Pack polynomial(const Pack& x, const std::array<double, count>& c) {
  Pack sum = c[count - 1];
  for (std::size_t k = count - 1; k-- > 0;) sum = sum * x + c[k];
  return sum;
}

inline constexpr double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;

/// x = k ln 2 + r with |r| <= ln 2/2: expm1(r) and 2^k.
struct ReducedExponential {
  Pack expm1, scale;

  explicit ReducedExponential(const Pack& x) {
    constexpr double largest = 700;  // e^x stays a number, and so does 2^k
    const Pack held = select(x > largest, Pack(largest), select(x < -largest, Pack(-largest), x));
    constexpr double to_integer = 0x1.8p52;  // adding it leaves the nearest integer in the low bits
    const Pack shifted = held * (1 / (ln2_high + ln2_low)) + to_integer, k = shifted - to_integer;
    const Pack r = (held - k * ln2_high) - k * ln2_low;
    // (e^r - 1 - r)/r^2 up to r^12/14!: beyond, terms are below 1e-17 of the first.
    constexpr std::array<double, 13> c{1.0 / 2,          1.0 / 6,        1.0 / 24,        1.0 / 120,
                                       1.0 / 720,        1.0 / 5040,     1.0 / 40320,     1.0 / 362880,
                                       1.0 / 3628800,    1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800,
                                       1.0 / 87178291200};
    expm1 = r + r * r * polynomial(r, c);
    constexpr int bias = 1023, fraction_bits = 52;
    scale = std::bit_cast<Pack>((std::bit_cast<PackBits>(shifted) + bias) << fraction_bits);
  }
};

}  // namespace detail

/// e^x; beyond |x| = 700 as at 700.
[[nodiscard]] inline Pack exp(const Pack& x) {
  const detail::ReducedExponential e(x);
  return e.scale * e.expm1 + e.scale;
}

/// e^x - 1, as precise near 0; beyond |x| = 700 as at 700.
[[nodiscard]] inline Pack expm1(const Pack& x) {
  const detail::ReducedExponential e(x);
  return e.scale * e.expm1 + (e.scale - 1.0);
}

/// ln(1 + x), as precise near 0; x > -1 and normal 1 + x, or NaN.
[[nodiscard]] inline Pack log1p(const Pack& x) {
  const Pack u = 1.0 + x;
  // u = 2^k m with m in [sqrt(1/2), sqrt 2): the exponent is taken off relative to the lower end's.
  constexpr std::int64_t lower_end = 0x3fe6a09e667f3bcd, one = 0x3ff0000000000000;
  constexpr std::int64_t fraction = 0x000fffffffffffff, two_to_52 = 0x4330000000000000;
  const PackBits shifted = std::bit_cast<PackBits>(u) + (one - lower_end);
  const Pack m = std::bit_cast<Pack>((shifted & fraction) + lower_end);
  const Pack k = std::bit_cast<Pack>((shifted >> 52) | two_to_52) - (0x1p52 + 1023);
  // ln m = 2 artanh(s), s = (m - 1)/(m + 1), |s| < 0.172: up to s^21/21.
  const Pack s = (m - 1.0) / (m + 1.0);
  constexpr std::array<double, 11> c{1.0,      1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9, 1.0 / 11,
                                     1.0 / 13, 1.0 / 15, 1.0 / 17, 1.0 / 19, 1.0 / 21};
  const Pack lost = (x - (u - 1.0)) / u;  // by rounding of 1 + x
  const Pack logarithm =
      k * detail::ln2_high + (2.0 * s * detail::polynomial(s * s, c) + (k * detail::ln2_low + lost));
  // NaN has an exponent too; it must stay what it is.
  return select(x == x, logarithm, x);
}

}  // namespace tuft

#include "core/lane_math.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace tuft {
namespace {

/// Distance in units in the last place of the reference.
double ulps(double value, double reference) {
  if (value == reference) return 0;
  const double next = std::nextafter(std::abs(reference), std::numeric_limits<double>::infinity());
  return std::abs(value - reference) / (next - std::abs(reference));
}

/// Largest distance of `pack` from `one` over arguments, many in each power of two of the range.
template <class OfPack, class OfOne>
double largest_error(double low, double high, double smallest, OfPack&& of_pack, OfOne&& of_one) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> even(low, high), power(std::log(smallest), std::log(high));
  double largest = 0;
  for (int i = 0; i < 20000; ++i) {
    const Pack x([&](auto lane) {
      const double size = std::exp(power(random)), any = even(random);
      return lane % 2 == 0 ? any : (any < 0 && -size > low ? -size : size);
    });
    const Pack y = of_pack(x);
    for (std::size_t l = 0; l < lanes; ++l) largest = std::max(largest, ulps(y[l], of_one(x[l])));
  }
  return largest;
}

TEST(LaneMath, ExponentialIsWithinThreeUnitsInTheLastPlace) {
  EXPECT_LE(
      largest_error(
          -690, 690, 1e-300, [](const Pack& x) { return exp(x); }, [](double x) { return std::exp(x); }),
      3);
}

TEST(LaneMath, ExponentialLessOneIsAsPreciseNearZero) {
  EXPECT_LE(
      largest_error(
          -690, 690, 1e-300, [](const Pack& x) { return expm1(x); }, [](double x) { return std::expm1(x); }),
      3);
  EXPECT_LE(largest_error(
                -1, 1, 1e-20, [](const Pack& x) { return expm1(x); }, [](double x) { return std::expm1(x); }),
            3);
}

TEST(LaneMath, LogarithmOfOneAndAPartIsAsPreciseNearZero) {
  const auto of_pack = [](const Pack& x) { return log1p(x); };
  const auto of_one = [](double x) { return std::log1p(x); };
  EXPECT_LE(largest_error(-0.9999, 1e6, 1e-300, of_pack, of_one), 3);
  EXPECT_LE(largest_error(-0.3, 0.5, 1e-20, of_pack, of_one), 3);
}

TEST(LaneMath, KeepsZeroAndWhatIsNotANumber) {
  const Pack zero(0.0), none(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(exp(zero)[0], 1);
  EXPECT_EQ(expm1(zero)[0], 0);
  EXPECT_EQ(log1p(zero)[0], 0);
  for (const Pack& y : {exp(none), expm1(none), log1p(none)}) EXPECT_TRUE(std::isnan(y[lanes - 1]));
}

TEST(LaneMath, ExponentialBeyondItsRangeIsThatOfTheEdge) {
  EXPECT_EQ(exp(Pack(1e5))[0], exp(Pack(700.0))[0]);
  EXPECT_EQ(exp(Pack(-std::numeric_limits<double>::infinity()))[0], exp(Pack(-700.0))[0]);
  EXPECT_TRUE(std::isfinite(double(exp(Pack(1e300))[0])));
}

/// Some compilers get masked assignment of whole vectors wrong; all loops that select lanes would be.
TEST(LaneMath, LanesBelowALimitAreBitsOfTheirPlaces) {
  for (unsigned bits = 0; bits < 1U << lanes; ++bits) {
    const Pack values(
        [bits](auto lane) { return (bits >> lane & 1U) != 0 ? 0.999 : 1.0; });  // 1 is not below 1
    EXPECT_EQ(lanes_below(values, 1), bits);
  }
  EXPECT_EQ(lanes_below(Pack(std::numeric_limits<double>::quiet_NaN()), 1), 0U);
}

TEST(LaneMath, SelectionAndMaskedAssignmentTakeEachLaneByItself) {
  const Pack x([](auto lane) { return lane % 2 == 0 ? 1.5 : -2.5; });
  Pack assigned = x;
  stdx::where(x < 0.0, assigned) = 7.0;
  const Pack selected = select(x < 0.0, Pack(7.0), x);
  for (std::size_t l = 0; l < lanes; ++l) {
    EXPECT_EQ(assigned[l], l % 2 == 0 ? 1.5 : 7) << l;
    EXPECT_EQ(selected[l], l % 2 == 0 ? 1.5 : 7) << l;
  }
  EXPECT_TRUE(any(x < 0.0));
  EXPECT_FALSE(any(x > 2.0));
}

}  // namespace
}  // namespace tuft

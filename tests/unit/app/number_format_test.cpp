#include "app/number_format.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tuft::app {
namespace {

TEST(FormatSignificant, KeepsTheDigitsThatWereAskedFor) {
  EXPECT_EQ(format_significant(53.16), "53.2");
  EXPECT_EQ(format_significant(0.0137), "0.0137");
  EXPECT_EQ(format_significant(-1.254, 2), "-1.3");
  EXPECT_EQ(format_significant(12345.6), "12300");
}

TEST(FormatSignificant, RoundsUpToTheNextDecadeWithoutAnExtraDigit) {
  EXPECT_EQ(format_significant(9.996), "10.0");
  EXPECT_EQ(format_significant(999.6), "1000");
}

TEST(FormatSignificant, UsesPowersOfTenForTheVerySmallAndLarge) {
  EXPECT_EQ(format_significant(3.24e-13, 2), "3.2e-13");
  EXPECT_EQ(format_significant(2.5e7, 2), "2.5e7");
}

TEST(FormatSignificant, NeverPrintsNanOrInfinity) {
  EXPECT_EQ(format_significant(std::nan("")), not_available);
  EXPECT_EQ(format_significant(std::numeric_limits<double>::infinity()), not_available);
  EXPECT_EQ(format_quantity(std::nan(""), "m"), not_available);
  EXPECT_EQ(format_percent(std::nan("")), not_available);
  EXPECT_EQ(format_duration(std::nan("")), not_available);
}

TEST(FormatQuantity, ShowsLengthsInMillimetresAndShortTimesInMilliseconds) {
  EXPECT_EQ(format_quantity(0.0137, "m"), "13.7 mm");
  EXPECT_EQ(format_quantity(0.0074, "s"), "7.40 ms");
  EXPECT_EQ(format_quantity(2.1e-7, "s"), "0.210 µs");
  EXPECT_EQ(format_quantity(2.5e6, "Pa"), "2.50 MPa");
  EXPECT_EQ(format_quantity(0.36, "1"), "0.360");
}

TEST(FormatDuration, ChangesUnitWhereSecondsStopBeingReadable) {
  EXPECT_EQ(format_duration(0.85), "850 ms");
  EXPECT_EQ(format_duration(12.34), "12.3 s");
  EXPECT_EQ(format_duration(245), "4 min 05 s");
  EXPECT_EQ(format_duration(7800), "2 h 10 min");
}

TEST(FormatCount, GroupsByThousands) {
  EXPECT_EQ(format_count(0), "0");
  EXPECT_EQ(format_count(999), "999");
  EXPECT_EQ(format_count(1234567), "1 234 567");
}

TEST(FormatRate, KeepsThreeDigits) {
  EXPECT_EQ(format_rate(1.4149e6), "1.41 million/s");
  EXPECT_EQ(format_rate(35432), "35 400/s");
}

}  // namespace
}  // namespace tuft::app

#include "studies/median_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace tuft::studies {
namespace {

std::vector<double> one_to(int n) {
  std::vector<double> values(static_cast<std::size_t>(n));
  std::iota(values.begin(), values.end(), 1.0);
  return values;
}

TEST(MedianEstimate, BoundsAreTheOrderStatisticsOfTheBinomialTable) {
  EXPECT_FALSE(estimate_median(one_to(5)).bounded);
  EXPECT_EQ(estimate_median(one_to(5)).low, 1);
  EXPECT_EQ(estimate_median(one_to(5)).high, 5);
  // n, and the rank that tables of the sign test give for 95 %.
  for (const auto& [n, rank] : {std::pair{6, 1}, {8, 1}, {9, 2}, {12, 3}, {25, 8}, {100, 40}}) {
    const MedianEstimate e = estimate_median(one_to(n));
    EXPECT_TRUE(e.bounded) << n;
    EXPECT_EQ(e.low, rank) << n;
    EXPECT_EQ(e.high, n + 1 - rank) << n;
    EXPECT_EQ(e.median, 0.5 * (n + 1)) << n;
  }
}

TEST(MedianEstimate, OfNothingIsNothing) {
  const MedianEstimate e = estimate_median({});
  EXPECT_EQ(e.median, 0);
  EXPECT_FALSE(e.bounded);
}

TEST(MedianEstimate, HoldsTheMedianAsOftenAsPromisedWhateverTheScatter) {
  std::mt19937 random(7);
  std::lognormal_distribution<double> skewed(0, 1);  // median 1
  int held = 0;
  constexpr int series = 2000;
  for (int s = 0; s < series; ++s) {
    std::vector<double> values(13);
    for (double& v : values) v = skewed(random);
    const MedianEstimate e = estimate_median(values);
    held += e.low <= 1 && 1 <= e.high;
  }
  EXPECT_GT(held, 0.94 * series);
  EXPECT_LT(held, 0.995 * series) << "bounds are wider than they need be";
}

}  // namespace
}  // namespace tuft::studies

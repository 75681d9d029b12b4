#include "app/svg_plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tuft::app {
namespace {

TEST(RoundTicks, StandOnOneTwoOrFiveTimesAPowerOfTenAndCoverTheRange) {
  for (const auto& [low, high] :
       {std::pair{0.0, 53.2}, std::pair{-3.1, 1.3}, std::pair{0.0, 3e-4}, std::pair{-1e7, 5e7}}) {
    const std::vector<double> ticks = round_ticks(low, high, 6);
    ASSERT_GE(ticks.size(), 3u);
    ASSERT_LE(ticks.size(), 7u);
    const double step = ticks[1] - ticks[0];
    const double digit = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
    EXPECT_TRUE(std::abs(digit - 1) < 1e-6 || std::abs(digit - 2) < 1e-6 || std::abs(digit - 5) < 1e-6)
        << step;
    EXPECT_GE(ticks.front(), low - 1e-9 * step);
    EXPECT_LE(ticks.back(), high + 1e-9 * step);
  }
}

TEST(Thinned, KeepsEveryExtremeOfALongCurve) {
  Series series;
  for (int i = 0; i < 100000; ++i) {
    series.x.push_back(i);
    series.y.push_back(i == 54321 ? 1000.0 : std::sin(0.01 * i));
  }
  const Series thin = thinned(series, 0, 1e5, 500);
  EXPECT_LE(thin.x.size(), 2100u);
  EXPECT_EQ(*std::max_element(thin.y.begin(), thin.y.end()), 1000.0);
  EXPECT_TRUE(std::is_sorted(thin.x.begin(), thin.x.end()));
}

TEST(SvgPlot, LeavesOutPointsThatAreNotFinite) {
  Plot plot{"p", "time [ms]", "y [1]", {{"a", "c0", {0, 1, 2, 3, 4}, {0, 1, std::nan(""), 2, 3}}}, {}, {}};
  const std::string svg = svg_plot(plot);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  // The gap breaks the curve in two.
  const std::size_t first = svg.find("<polyline");
  ASSERT_NE(first, std::string::npos);
  EXPECT_NE(svg.find("<polyline", first + 1), std::string::npos);
}

TEST(SvgPlot, SaysSoInsteadOfDrawingWhenThereIsNoData) {
  const Plot plot{"p", "time [ms]", "velocity [m/s]", {}, {}, {}};
  EXPECT_NE(svg_plot(plot).find("Not recorded: velocity [m/s]"), std::string::npos);
}

TEST(SvgPlot, DrawsAConstantCurve) {
  const Plot plot{"p", "t", "y", {{"a", "c0", {0, 1}, {5, 5}}}, {}, {}};
  EXPECT_NE(svg_plot(plot).find("<polyline"), std::string::npos);
}

}  // namespace
}  // namespace tuft::app

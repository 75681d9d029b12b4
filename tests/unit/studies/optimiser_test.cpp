// The search: it finds, keeps inside the box, repeats itself and stops.
#include "studies/optimiser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tuft::studies {
namespace {

constexpr OptimiserAlgorithm all[] = {OptimiserAlgorithm::bobyqa, OptimiserAlgorithm::sbplx,
                                      OptimiserAlgorithm::cobyla, OptimiserAlgorithm::crs2,
                                      OptimiserAlgorithm::direct_l};

struct Found {
  std::vector<double> best;
  double least = 1e300;
  std::vector<std::vector<double>> asked;
  SearchEnd end;
};

template <class Function>
Found search(OptimiserAlgorithm algorithm, std::vector<double> start, const Function& function,
             int evaluations = 3000) {
  Found found;
  OptimiserChoice choice;
  choice.algorithm = algorithm;
  choice.max_evaluations = evaluations;
  choice.global_share = 0.3;
  found.end = minimise(choice, start, [&](const std::vector<double>& x) {
    found.asked.push_back(x);
    const double value = function(x);
    if (value < found.least) found.least = value, found.best = x;
    return std::optional(value);
  });
  return found;
}

/// Narrow and curved, least at (0.7, 0.49).
double valley(const std::vector<double>& x) {
  return 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(0.7 - x[0], 2);
}

TEST(Optimiser, FindsTheLeastOfACurvedValley) {
  for (const OptimiserAlgorithm algorithm : all) {
    const Found found = search(algorithm, {0.1, 0.9}, valley);
    EXPECT_NEAR(found.best[0], 0.7, 0.01) << static_cast<int>(algorithm);
    EXPECT_NEAR(found.best[1], 0.49, 0.015) << static_cast<int>(algorithm);
  }
}

TEST(Optimiser, OfOneParameterWorksToo) {
  for (const OptimiserAlgorithm algorithm : all) {
    const Found found = search(
        algorithm, {0.9}, [](const auto& x) { return std::pow(x[0] - 0.3, 2); }, 500);
    EXPECT_NEAR(found.best[0], 0.3, 1e-3) << static_cast<int>(algorithm);
  }
}

TEST(Optimiser, NeverLeavesTheBoxAndReachesItsCorner) {
  for (const OptimiserAlgorithm algorithm : all) {
    const Found found = search(
        algorithm, {0.5, 0.0, 1.0}, [](const auto& x) { return 2 * x[0] + x[1] - x[2]; }, 600);
    for (const auto& x : found.asked)
      EXPECT_TRUE(std::ranges::all_of(x, [](double each) { return each >= 0 && each <= 1; }));
    EXPECT_NEAR(found.best[0], 0, 1e-3) << static_cast<int>(algorithm);
    EXPECT_NEAR(found.best[1], 0, 1e-3) << static_cast<int>(algorithm);
    EXPECT_NEAR(found.best[2], 1, 1e-3) << static_cast<int>(algorithm);
  }
}

TEST(Optimiser, AsksTheSamePointsEachTime) {
  for (const OptimiserAlgorithm algorithm : all)
    EXPECT_EQ(search(algorithm, {0.2, 0.8}, valley, 300).asked,
              search(algorithm, {0.2, 0.8}, valley, 300).asked)
        << static_cast<int>(algorithm);
}

TEST(Optimiser, KeepsToItsEvaluationsAndSaysSo) {
  for (const OptimiserAlgorithm algorithm : all) {
    const Found found = search(algorithm, {0.2, 0.8}, valley, 40);
    EXPECT_LE(found.asked.size(), 42U)
        << static_cast<int>(algorithm) << ": a few beyond, by NLopt's own rules";
    EXPECT_EQ(found.end.reason, "40 evaluations");
  }
}

TEST(Optimiser, StopsWhenAsked) {
  for (const OptimiserAlgorithm algorithm : all) {
    OptimiserChoice choice;
    choice.algorithm = algorithm;
    int count = 0;
    const SearchEnd end = minimise(choice, {0.2, 0.8}, [&](const std::vector<double>& x) {
      return ++count > 7 ? std::nullopt : std::optional(valley(x));
    });
    EXPECT_TRUE(end.stopped);
    EXPECT_EQ(count, 8);
  }
}

TEST(Optimiser, GetsOverACliff) {
  // A third of the box fails with a large value; the least is close to it.
  const auto cliff = [](const std::vector<double>& x) {
    return x[0] < 0.33 ? 1e4 : std::pow(x[0] - 0.4, 2) + std::pow(x[1] - 0.6, 2);
  };
  for (const OptimiserAlgorithm algorithm : all) {
    const Found found = search(algorithm, {0.9, 0.1}, cliff, 2000);
    EXPECT_NEAR(found.best[0], 0.4, 0.01) << static_cast<int>(algorithm);
    EXPECT_NEAR(found.best[1], 0.6, 0.01) << static_cast<int>(algorithm);
  }
}

}  // namespace
}  // namespace tuft::studies

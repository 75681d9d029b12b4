// The shell benchmarks of the literature on their finest meshes, by dynamic relaxation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/verification/shell_benchmarks/models.h"

namespace tuft::fe::test {
namespace {

class ShellBenchmark : public testing::TestWithParam<Benchmark> {};

void expect_within(const Benchmark& benchmark, ElementKind element, double bound) {
  ShellSection section;
  section.element = element;
  const BenchmarkAnswer answer = solve(benchmark, benchmark.levels[2], section, benchmark_tolerance);
  EXPECT_TRUE(answer.relaxation.at_rest);
  for (std::size_t q = 0; q < answer.error.size(); ++q)
    EXPECT_LT(std::abs(answer.error[q]), bound) << benchmark.quantities[q].name << ": " << answer.error[q];
}

TEST_P(ShellBenchmark, IsMetWithinTwoPercentByTheFullyIntegratedElement) {
  expect_within(GetParam(), ElementKind::fully_integrated, 0.02);
}

TEST_P(ShellBenchmark, IsMetWithinThreePercentByTheOnePointElement) {
  expect_within(GetParam(), ElementKind::one_point, 0.03);
}

/// Bending with large rotations, where points through the thickness have most to do.
class ShellBenchmarkByLayers : public testing::TestWithParam<ElementKind> {};

TEST_P(ShellBenchmarkByLayers, HalfCircleRolledUpWithThreePointsIsThatOfTheExactResultants) {
  const std::vector<Benchmark> all = shell_benchmarks();
  const auto roll_up = std::find_if(all.begin(), all.end(),
                                    [](const Benchmark& b) { return b.name == "roll_up_half_circle"; });
  ASSERT_NE(roll_up, all.end());
  const double bound = GetParam() == ElementKind::fully_integrated ? 0.02 : 0.03;
  const auto answer = [&](int points) {
    ShellSection section;
    section.element = GetParam();
    section.thickness_points = points;
    return solve(*roll_up, roll_up->levels[2], section, benchmark_tolerance);
  };
  const BenchmarkAnswer layers = answer(3), resultants = answer(1);
  EXPECT_TRUE(layers.relaxation.at_rest);
  for (std::size_t q = 0; q < layers.error.size(); ++q) {
    EXPECT_LT(std::abs(layers.error[q]), bound) << roll_up->quantities[q].name;
    EXPECT_NEAR(layers.error[q], resultants.error[q], 1e-6) << roll_up->quantities[q].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, ShellBenchmarkByLayers,
                         testing::Values(ElementKind::one_point, ElementKind::fully_integrated),
                         [](const auto& parameter) {
                           return parameter.param == ElementKind::one_point ? "one_point"
                                                                            : "fully_integrated";
                         });

INSTANTIATE_TEST_SUITE_P(Of, ShellBenchmark, testing::ValuesIn(shell_benchmarks()),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace

void PrintTo(const Benchmark& benchmark, std::ostream* stream) {
  *stream << benchmark.name;
}

}  // namespace tuft::fe::test

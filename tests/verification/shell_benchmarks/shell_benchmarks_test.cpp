// The shell benchmarks of the literature on their finest meshes, by dynamic relaxation.
#include <gtest/gtest.h>

#include "tests/verification/shell_benchmarks/models.h"

namespace tuft::fe::test {
namespace {

class ShellBenchmark : public testing::TestWithParam<Benchmark> {};

void expect_within(const Benchmark& benchmark, ElementKind element, double bound) {
  ShellSection section;
  section.element = element;
  const BenchmarkAnswer answer = solve(benchmark, benchmark.levels[2], section, benchmark_tolerance);
  EXPECT_TRUE(answer.relaxation.at_rest);
  for (std::size_t q = 0; q < answer.ratio.size(); ++q)
    EXPECT_NEAR(answer.ratio[q], 1, bound) << benchmark.quantities[q].name;
}

TEST_P(ShellBenchmark, IsMetWithinTwoPercentByTheFullyIntegratedElement) {
  expect_within(GetParam(), ElementKind::fully_integrated, 0.02);
}

TEST_P(ShellBenchmark, IsMetWithinThreePercentByTheOnePointElement) {
  expect_within(GetParam(), ElementKind::one_point, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Of, ShellBenchmark, testing::ValuesIn(shell_benchmarks()),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace

void PrintTo(const Benchmark& benchmark, std::ostream* stream) {
  *stream << benchmark.name;
}

}  // namespace tuft::fe::test

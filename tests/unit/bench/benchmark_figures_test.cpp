#include "bench/benchmark_figures.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace tuft::bench {
namespace {

nlohmann::json report_of(std::initializer_list<nlohmann::json> entries) {
  nlohmann::json report;
  report["benchmarks"] = nlohmann::json::array();
  for (const nlohmann::json& entry : entries) report["benchmarks"].push_back(entry);
  return report;
}

TEST(BenchmarkFigures, RateIsTheLargestOfTheRepetitions) {
  const Figures figures = figures_of_benchmark(report_of({
      {{"name", "sph_paper/2/iterations:3/repeats:2/real_time"},
       {"run_type", "iteration"},
       {"particle_steps", 4e6}},
      {{"name", "sph_paper/2/iterations:3/repeats:2/real_time"},
       {"run_type", "iteration"},
       {"particle_steps", 5e6}},
      {{"name", "sph_paper/2/iterations:3/repeats:2/real_time_mean"},
       {"run_type", "aggregate"},
       {"particle_steps", 9e6}},
  }));
  ASSERT_EQ(figures.size(), 1u);
  const Figure& figure = figures.at("sph_paper/2");
  EXPECT_EQ(figure.value, 5e6);
  EXPECT_EQ(figure.unit, "particle-steps/s");
  EXPECT_EQ(figure.threads, 2);
}

TEST(BenchmarkFigures, ShareIsTheMedianOfTheRepetitions) {
  const Figures figures = figures_of_benchmark(report_of({
      {{"name", "bridge_overhead_20k/1"}, {"run_type", "iteration"}, {"share", 0.04}},
      {{"name", "bridge_overhead_20k/1"}, {"run_type", "iteration"}, {"share", 0.02}},
      {{"name", "bridge_overhead_20k/1"}, {"run_type", "iteration"}, {"share", 0.03}},
  }));
  EXPECT_EQ(figures.at("bridge_overhead_20k/1").value, 0.03);
}

TEST(BenchmarkFigures, NamesThatAreNoFiguresAreLeftOut) {
  const Figures figures = figures_of_benchmark(report_of({
      {{"name", "neighbour_search/1"}, {"run_type", "iteration"}, {"particle_steps", 1.0}},
      {{"name", "sph_paper"}, {"run_type", "iteration"}, {"particle_steps", 1.0}},
      {{"name", "sph_paper/threads:2"}, {"run_type", "iteration"}, {"particle_steps", 1.0}},
      {{"name", "sph_paper/2x"}, {"run_type", "iteration"}, {"particle_steps", 1.0}},
  }));
  EXPECT_TRUE(figures.empty());
}

TEST(BenchmarkFigures, FigureWithoutItsCounterIsAnError) {
  const auto report =
      report_of({{{"name", "sph_accurate/1"}, {"run_type", "iteration"}, {"real_time", 3.0}}});
  try {
    static_cast<void>(figures_of_benchmark(report));
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "sph_accurate/1 reports no particle_steps");
  }
}

TEST(BenchmarkFigures, BenchmarkThatStoppedPassesItsWordsOn) {
  const auto report = report_of({{{"name", "bridge_overhead_100k/2"},
                                  {"run_type", "iteration"},
                                  {"error_occurred", true},
                                  {"error_message", "the host is missing"}}});
  try {
    static_cast<void>(figures_of_benchmark(report));
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "bridge_overhead_100k/2: the host is missing");
  }
}

}  // namespace
}  // namespace tuft::bench

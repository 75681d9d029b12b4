/// What the machine can do, to hold the loops against: bytes per second of a triad over arrays far larger
/// than the caches, and of one the size of the shells' field; double-precision operations per second of fused
/// multiply-adds in registers.
#include <benchmark/benchmark.h>

#include <vector>

#include "core/parallel.h"
#include "core/lanes.h"

namespace {

using namespace tuft;

/// a = b + s c: 24 bytes read and written a value, 8 more for the write allocate.
void triad(benchmark::State& state, std::size_t values) {
  set_threads(static_cast<int>(state.range(0)));
  std::vector<double> a(values), b(values, 1.0), c(values, 2.0);
  for (auto _ : state) {
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < values; ++i) a[i] = b[i] + 3.0 * c[i];
    benchmark::ClobberMemory();
  }
  state.counters["bytes"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 32 * static_cast<double>(values),
                         benchmark::Counter::kIsRate);
}

void machine_memory(benchmark::State& state) {
  triad(state, 16'000'000);  // 384 MB
}
void machine_memory_32mb(benchmark::State& state) {
  triad(state, 1'333'333);  // 32 MB, about the shells' field
}

/// Enough chains to hide the latency of one.
void machine_arithmetic(benchmark::State& state) {
  set_threads(static_cast<int>(state.range(0)));
  constexpr int chains = 12, rounds = 4096;
  double sum = 0;
  for (auto _ : state) {
#pragma omp parallel reduction(+ : sum)
    {
      Pack x[chains];
      for (int c = 0; c < chains; ++c) x[c] = 1.0 + 1e-3 * c;
      const Pack factor(0.999), step(1e-3);
      for (int r = 0; r < rounds; ++r)
        for (int c = 0; c < chains; ++c) x[c] = x[c] * factor + step;
      for (int c = 0; c < chains; ++c) sum += sum_lanes(x[c]);
    }
    benchmark::DoNotOptimize(sum);
  }
  const double flops =
      2.0 * static_cast<double>(lanes) * chains * rounds * static_cast<double>(state.range(0));
  state.counters["flops"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * flops, benchmark::Counter::kIsRate);
}

BENCHMARK(machine_memory)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(machine_memory_32mb)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(machine_arithmetic)->Arg(1)->Arg(2)->UseRealTime();

}  // namespace

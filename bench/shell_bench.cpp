/// Element-steps per second of the shells on a field of 50 000 fibre shells (fibre_field.h). One-point
/// elements with stress resultants and with three points through the thickness; fully integrated ones,
/// elastic with resultants and viscoelastic with three points. Step control is in it as often as in a run.
#include <benchmark/benchmark.h>

#include "bench/fibre_field.h"
#include "bench/shell_traffic.h"
#include "core/parallel.h"

namespace {

using namespace tuft;

void step_field(benchmark::State& state, int which) {
  set_threads(static_cast<int>(state.range(0)));
  const bench::FieldCase of = bench::field_case(which);
  const auto carpet = bench::swinging_field(of);
  Vec3Array load;
  load.assign(carpet->nodes().x.size(), 0.0);
  double dt = bench::field_step_safety * carpet->stable_step();
  for (int i = 0; i < 5; ++i) carpet->step(dt, load);
  const std::uint64_t before = carpet->element_steps();
  int until_control = 0;
  for (auto _ : state) {
    if (until_control-- == 0) {
      dt = bench::field_step_safety * carpet->stable_step();
      until_control = bench::steps_per_step_control - 1;
    }
    carpet->step(dt, load);
  }
  const auto steps = static_cast<double>(carpet->element_steps() - before);
  state.counters["element_steps"] = benchmark::Counter(steps, benchmark::Counter::kIsRate);
  const double bytes = bench::bytes_per_element_step(carpet->mesh(), of.material, of.section);
  state.counters["bytes_per_element_step"] = bytes;
  state.counters["bytes"] = benchmark::Counter(steps * bytes, benchmark::Counter::kIsRate);
}

void shell_one_point_elastic(benchmark::State& state) {
  step_field(state, 0);
}
void shell_one_point_3pt(benchmark::State& state) {
  step_field(state, 1);
}
void shell_full_elastic(benchmark::State& state) {
  step_field(state, 2);
}
void shell_full_prony_3pt(benchmark::State& state) {
  step_field(state, 3);
}

void shell_full_prony_3pt_erosion(benchmark::State& state) {
  step_field(state, 4);
}

BENCHMARK(shell_one_point_elastic)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(shell_one_point_3pt)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(shell_full_elastic)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(shell_full_prony_3pt)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(shell_full_prony_3pt_erosion)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace

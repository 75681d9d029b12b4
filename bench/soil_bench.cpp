/// Soil points updated per second, with each effect alone, with none and with all: what an effect costs where
/// nothing else is done. The argument of a benchmark is its number of threads; counter `point_updates` is the
/// rate in real time.
///
/// Each point goes through a blow of 32 steps: compression with shear, most of it first loading and yield,
/// then half of it back. Points of a thread stay in its caches.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "sph_infill/soil_update.h"

namespace tuft::sph {
namespace {

constexpr std::size_t packs = 64, blow = 32, rounds = 8;

/// The mixture, loose, with parameters for all effects.
SoilLaw bench_law(const SoilEffects& effects) {
  SoilFoamMaterial m;
  m.density = 977;
  m.pressure_exponential = ExponentialCompression{1.5e6, 10};
  m.unloading_ratio = 1.2;
  m.yield_a0 = 20e3 * 20e3;
  m.yield_a1 = 2 * 20e3 * 0.35;
  m.yield_a2 = 0.35 * 0.35;
  m.tension_cutoff = 20e3;
  m.density_hardening = DensityHardening{4, 2, 0.5};
  m.strength_softening = StrengthSoftening{0.05, 0.2, 0.8};
  m.strength_recovery = StrengthRecovery{0.5, 0.02};
  m.strength_rate = StrengthRate{0.05, 0.1};
  m.inertial_friction = InertialFriction{0.7, 0.279, 0.001, 2450};
  m.dilation_angle = 0.15;
  return make_soil_law(m, true, effects);
}

template <SoilEffects on>
double strike(const std::array<const SoilLaw*, lanes>& of_lane, const SoilState& start,
              std::vector<SoilStateOf<Pack>>& points) {
  const LawOfLanes law(of_lane);
  Pack sum = 0;
  for (std::size_t round = 0; round < rounds; ++round) {
    for (SoilStateOf<Pack>& point : points) {
      point = {};
      point.compression = start.compression;
      point.largest_compression = start.largest_compression;
      point.plastic_compression = start.plastic_compression;
      point.bulk_modulus = start.bulk_modulus;
    }
    for (std::size_t k = 0; k < blow; ++k) {
      const double forth = k < blow / 2 ? 1 : -0.5;
      for (std::size_t p = 0; p < packs; ++p) {
        StrainStepOf<Pack> step;
        const Pack size([p](auto lane) { return 1e-3 * (1 + 0.01 * static_cast<double>((p + lane) % 17)); });
        step.strain.zz = -forth * 4.0 * size;
        step.strain.xx = forth * 0.5 * size;
        step.strain.xy = forth * size;
        step.rotation[2] = forth * size;
        step.duration = 1e-5;
        sum += update_soil_state<on>(law, step, points[p]).total;
      }
    }
  }
  return sum_lanes(sum);
}

/// residual: of the compression that the points start from, so that dilation has something to loosen.
void measure(benchmark::State& state, const SoilEffects& effects, double residual = 0) {
  const int threads = static_cast<int>(state.range(0));
  set_threads(threads);
  const SoilLaw law = bench_law(effects);
  const SoilState start = compacted_state(law, residual);
  std::array<const SoilLaw*, lanes> of_lane;
  of_lane.fill(&law);
  std::vector<std::vector<SoilStateOf<Pack>>> points(static_cast<std::size_t>(threads));
  for (auto& own : points) own.resize(packs);
  std::vector<double> sums(points.size());
  for (auto _ : state)
    with_soil_effects(effects, [&](auto on) {
      parallel_for(points.size(),
                   [&](std::size_t t) { sums[t] = strike<decltype(on)::value>(of_lane, start, points[t]); });
    });
  benchmark::DoNotOptimize(sums.data());
  state.counters["point_updates"] =
      benchmark::Counter(static_cast<double>(state.iterations()) *
                             static_cast<double>(packs * lanes * blow * rounds * points.size()),
                         benchmark::Counter::kIsRate);
}

void soil_law(benchmark::State& state) {
  measure(state, {});
}
void soil_density_hardening(benchmark::State& state) {
  measure(state, {.density_hardening = true});
}
void soil_strength_softening(benchmark::State& state) {
  measure(state, {.strength_softening = true});
}
void soil_strength_recovery(benchmark::State& state) {
  measure(state, {.strength_softening = true, .strength_recovery = true});
}
void soil_strength_rate(benchmark::State& state) {
  measure(state, {.strength_rate = true});
}
void soil_inertial_friction(benchmark::State& state) {
  measure(state, {.inertial_friction = true});
}
void soil_dilation(benchmark::State& state) {
  measure(state, {.dilation = true}, 0.03);
}
void soil_shear_energy(benchmark::State& state) {
  measure(state, {.shear_energy = true});
}
void soil_all_effects(benchmark::State& state) {
  measure(state, {true, true, true, true, true, true, true}, 0.03);
}

BENCHMARK(soil_law)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(soil_density_hardening)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(soil_strength_softening)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(soil_strength_recovery)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(soil_strength_rate)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(soil_inertial_friction)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(soil_dilation)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(soil_shear_energy)->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(soil_all_effects)->Arg(1)->Arg(2)->UseRealTime();

}  // namespace
}  // namespace tuft::sph

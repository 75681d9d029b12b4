/// Particle-steps per second of SPH infill on a settled, disordered bed: both presets, 1 and 2 threads, 300
/// 000 particles, and from 20 000 to 2 000 000. The argument of a benchmark is its number of threads; counter
/// `particle_steps` is the rate in real time, `bytes` the growth of the process' resident memory by the bed
/// over its particles.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "bench/resident_memory.h"
#include "core/parallel.h"
#include "sph_infill/sph_infill.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;
constexpr int settling_steps = 120;

/// Mixture of PHYSICS.md section 8, loose.
Material bench_material() {
  SoilFoamMaterial m;
  const double k0 = 1.5e6, b = 10, r = 1.2, alpha = 0.35, cohesion = 20e3;
  m.density = 977;
  for (int k = 0; k <= 40; ++k) {
    m.pressure.x.push_back(0.01 * k);
    m.pressure.y.push_back(k0 / b * std::expm1(b * 0.01 * k));
  }
  m.unloading = {{0, 1e6}, {r * k0, r * (k0 + b * 1e6)}};
  m.yield_a0 = cohesion * cohesion;
  m.yield_a1 = 2 * cohesion * alpha;
  m.yield_a2 = alpha * alpha;
  m.tension_cutoff = 20e3;
  Material material;
  material.name = "mixture";
  material.continuum = m;
  material.bulk_density = m.density;
  return material;
}

struct Preset {
  Kernel kernel;
  double smoothing_over_pitch;
};
constexpr Preset paper{Kernel::cubic_spline, 0.71}, accurate{Kernel::wendland_c2, 1.3};

/// side x side x 25 particles, thrown off their lattice by up to a seventh of the pitch, at rest under their
/// weight and held by a floor and four walls: without walls a small bed would go on spreading.
class Bed {
 public:
  Bed(const Preset& preset, int side) : half_(0.5 * side * pitch) {
    Turf turf;
    turf.layers = {{0, 25 * pitch}};
    Lattice lattice = make_lattice(turf, {{side * pitch, side * pitch}, 0}, pitch);
    std::mt19937_64 random(1);
    const auto thrown = [&](double& x) {
      x += pitch / 7 * (static_cast<double>(random() >> 11) * 0x1p-52 - 1);
    };
    for (auto* x : {&lattice.position.x, &lattice.position.y, &lattice.position.z})
      std::ranges::for_each(*x, thrown);
    // The stiff springs of floor and walls would shoot what is pushed into them through the bed.
    for (double& z : lattice.position.z) z = std::max(z, 0.5 * pitch);
    const double inside = half_ - 0.5 * pitch;
    for (auto* x : {&lattice.position.x, &lattice.position.y})
      for (double& value : *x) value = std::clamp(value, -inside, inside);
    const double before = resident_memory();
    SphSettings settings;
    settings.options.pitch = pitch;
    settings.options.kernel = preset.kernel;
    settings.options.smoothing_length = preset.smoothing_over_pitch * pitch;
    const std::vector<Material> materials{bench_material()};
    infill_ = std::make_unique<SphInfill>(lattice, materials, settings);
    stiffness_ = 10 * constrained_modulus(*materials[0].continuum, 100e3) * pitch;
    infill_->set_damping(2000);  // kept: what settles on goes on settling slowly
    advance(settling_steps);
    const double contact = 3 * sizeof(double);  // of the impulses given, which are not the infill's
    bytes_ = (resident_memory() - before) / static_cast<double>(lattice.position.size()) - contact;
  }
  /// Contact is found anew in each step: over several, its stiff springs would shake the bed.
  void advance(int steps) {
    for (int k = 0; k < steps; ++k) advance();
  }
  void advance() {
    const ParticleView p = infill_->particles();
    const double window = 0.4 * infill_->stable_step();
    if (contact_.linear.size() != p.size()) contact_.linear.assign(p.size(), 0);
    const auto pushed = [&](double height, double radius) {
      return window * stiffness_ * std::max(0.0, radius - height);
    };
    parallel_for(p.size(), [&](std::size_t i) {
      const double r = p.radius[i];
      contact_.linear.x[i] = pushed(half_ + p.x[i], r) - pushed(half_ - p.x[i], r);
      contact_.linear.y[i] = pushed(half_ + p.y[i], r) - pushed(half_ - p.y[i], r);
      contact_.linear.z[i] = pushed(p.z[i], r);
    });
    infill_->advance(window, 1, contact_);
  }
  [[nodiscard]] const SphInfill& infill() const { return *infill_; }
  [[nodiscard]] double bytes() const { return bytes_; }

 private:
  std::unique_ptr<SphInfill> infill_;
  ContactImpulses contact_;
  double half_, stiffness_ = 0, bytes_ = 0;  // half_: m, of its side
};

void measure(benchmark::State& state, const Preset& preset, int side) {
  // Settled once for both thread counts; one at a time, for the largest takes a gigabyte.
  static std::unique_ptr<Bed> bed;
  static std::pair<Kernel, int> is{Kernel::cubic_spline, 0};
  if (is != std::pair{preset.kernel, side}) {
    bed.reset();
    bed = std::make_unique<Bed>(preset, side);
    is = {preset.kernel, side};
  }
  set_threads(static_cast<int>(state.range(0)));
  const std::uint64_t before = bed->infill().particle_steps();
  constexpr int steps = 4;
  for (auto _ : state) bed->advance(steps);
  state.counters["particle_steps"] = benchmark::Counter(
      static_cast<double>(bed->infill().particle_steps() - before), benchmark::Counter::kIsRate);
  state.counters["neighbours"] = bed->infill().mean_neighbours();
  state.counters["bytes"] = bed->bytes();
}

void sph_paper(benchmark::State& state) {
  measure(state, paper, 110);
}
void sph_accurate(benchmark::State& state) {
  measure(state, accurate, 110);
}
void sph_paper_20k(benchmark::State& state) {
  measure(state, paper, 28);
}
void sph_paper_2m(benchmark::State& state) {
  measure(state, paper, 283);
}
void sph_accurate_20k(benchmark::State& state) {
  measure(state, accurate, 28);
}
void sph_accurate_2m(benchmark::State& state) {
  measure(state, accurate, 283);
}

/// All beds over the same steps: one that goes on settling gets quicker, and left to itself a small one would
/// be taken farther.
void over_the_same_steps(benchmark::internal::Benchmark* bench) {
  bench->Arg(1)->Arg(2)->Iterations(16)->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(sph_paper)->Apply(over_the_same_steps);
BENCHMARK(sph_accurate)->Apply(over_the_same_steps);
BENCHMARK(sph_paper_20k)->Apply(over_the_same_steps);
BENCHMARK(sph_paper_2m)->Apply(over_the_same_steps);
BENCHMARK(sph_accurate_20k)->Apply(over_the_same_steps);
BENCHMARK(sph_accurate_2m)->Apply(over_the_same_steps);

}  // namespace
}  // namespace tuft::sph

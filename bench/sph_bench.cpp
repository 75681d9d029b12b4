/// Particle-steps per second of SPH infill on a settled bed of 300 000 particles, both presets, 1 and 2
/// threads. The argument of a benchmark is its number of threads; counter `particle_steps` is the rate in
/// real time.
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <memory>

#include "core/parallel.h"
#include "sph_infill/sph_infill.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;
constexpr int settling_steps = 40;

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

/// 110 x 110 x 25 = 302 500 particles at rest under their weight, held by a floor.
class Bed {
 public:
  Bed(Kernel kernel, double smoothing_over_pitch) {
    Turf turf;
    turf.layers = {{0, 25 * pitch}};
    const Lattice lattice = make_lattice(turf, {{110 * pitch, 110 * pitch}, 0}, pitch);
    SphSettings settings;
    settings.options.pitch = pitch;
    settings.options.kernel = kernel;
    settings.options.smoothing_length = smoothing_over_pitch * pitch;
    const std::vector<Material> materials{bench_material()};
    infill_ = std::make_unique<SphInfill>(lattice, materials, settings);
    stiffness_ = 10 * constrained_modulus(*materials[0].continuum, 100e3) * pitch;
    infill_->set_damping(2000);
    for (int k = 0; k < settling_steps; ++k) advance(1);
    infill_->set_damping(0);
  }
  void advance(int substeps) {
    const ParticleView p = infill_->particles();
    const double window = 0.4 * infill_->stable_step() * substeps;
    contact_.linear.assign(p.size(), 0);
    for (std::size_t i = 0; i < p.size(); ++i)
      contact_.linear.z[i] = window * stiffness_ * std::max(0.0, p.radius[i] - p.z[i]);
    infill_->advance(window, substeps, contact_);
  }
  [[nodiscard]] const SphInfill& infill() const { return *infill_; }

 private:
  std::unique_ptr<SphInfill> infill_;
  ContactImpulses contact_;
  double stiffness_ = 0;
};

void measure(benchmark::State& state, Kernel kernel, double smoothing_over_pitch) {
  static std::map<Kernel, std::unique_ptr<Bed>> beds;  // settled once for both thread counts
  auto& bed = beds[kernel];
  if (!bed) bed = std::make_unique<Bed>(kernel, smoothing_over_pitch);
  set_threads(static_cast<int>(state.range(0)));
  const std::uint64_t before = bed->infill().particle_steps();
  constexpr int substeps = 4;
  for (auto _ : state) bed->advance(substeps);
  state.counters["particle_steps"] = benchmark::Counter(
      static_cast<double>(bed->infill().particle_steps() - before), benchmark::Counter::kIsRate);
  state.counters["neighbours"] = bed->infill().mean_neighbours();
}

void sph_paper(benchmark::State& state) {
  measure(state, Kernel::cubic_spline, 0.71);
}
void sph_accurate(benchmark::State& state) {
  measure(state, Kernel::wendland_c2, 1.3);
}

BENCHMARK(sph_paper)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(sph_accurate)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tuft::sph

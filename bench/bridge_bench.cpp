/// What the exchange with liggghts_host costs, as a share of the DEM step, on a settled bed of 20 000 and of
/// 100 000 grains. The argument of a benchmark is its number of threads in the driver; the host has one rank.
///
/// counter `share`: 1 - t1/tn, where tn is the time of n windows of one step (exchanged every step) and t1
/// that of one window of n steps (exchanged once), taken in turns on the same host. counter
/// `share_with_kicks`: of the windows of one step, all time outside LIGGGHTS' own steps: also what adds
/// gravity, contact forces and the energy sums. counter `share_of_processor`: as `share`, in processor time of
/// driver and host, where time that others take on a shared machine does not count, nor waiting for each other.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "core/parallel.h"
#include "dem_bridge/dem_infill.h"

namespace tuft::dem {
namespace {

constexpr int steps_per_batch = 20;
constexpr int settling_steps = 300;

/// Rubber grains of 2.0 to 4.25 mm (coarse graining 2.5) in a square tray as deep as turf infill.
class Bed {
 public:
  explicit Bed(double side) {
    std::vector<Material> materials(1);
    materials[0].name = "rubber";
    materials[0].grain = GrainMaterial{1150, 8e6, 0.45, 0.5, 0.6, 0.1, 0.0008, 0.0017};
    materials[0].bulk_density = 0.58 * 1150;
    materials[0].grain_shares = {{0, 1.0}};
    Turf turf;
    turf.layers = {{0, 0.050}};
    DemOptions options;
    options.coarse_graining = 2.5;
    PackingRequest request;
    request.size = {side, side};
    request.turf = &turf;
    request.materials = &materials;
    request.options = &options;
    const Grains grains = pack_grains(request);
    DemSettings settings;
    settings.options = options;
    settings.box = {Vec3(-0.6 * side, -0.6 * side, -0.02), Vec3(0.6 * side, 0.6 * side, 0.1)};
    half_ = 0.5 * side;
    infill_ = std::make_unique<DemInfill>(grains, materials, settings);
    infill_->set_damping(1000);
    for (int k = 0; k < settling_steps; ++k) advance(1);
  }

  /// One window under the walls' forces at its start; returns its wall time without what the walls cost.
  double advance(int substeps) {
    const double window = 0.8 * infill_->stable_step() * substeps;
    push_from_walls(window);
    const double processor = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    infill_->advance(window, substeps, contact_);
    processor_seconds_ += processor_seconds() - processor;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  [[nodiscard]] const DemInfill& infill() const { return *infill_; }
  /// Of driver and host in all windows since it was last asked.
  double take_processor_seconds() { return std::exchange(processor_seconds_, 0.0); }

 private:
  [[nodiscard]] double processor_seconds() const {
    clockid_t host_clock{};
    timespec driver{}, host{};
    ::clock_getcpuclockid(infill_->host_process(), &host_clock);
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &driver);
    ::clock_gettime(host_clock, &host);
    return static_cast<double>(driver.tv_sec + host.tv_sec) +
           1e-9 * static_cast<double>(driver.tv_nsec + host.tv_nsec);
  }
  void push_from_walls(double window) {
    constexpr double stiffness = 2e4;  // N/m
    const ParticleView p = infill_->particles();
    contact_.linear.assign(p.size(), 0);
    contact_.angular.assign(p.size(), 0);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto push = [&](double distance) {
        return window * stiffness * std::max(0.0, p.radius[i] - distance);
      };
      contact_.linear.set(i, {push(half_ + p.x[i]) - push(half_ - p.x[i]),
                              push(half_ + p.y[i]) - push(half_ - p.y[i]), push(p.z[i])});
    }
  }
  std::unique_ptr<DemInfill> infill_;
  ContactImpulses contact_;
  double half_ = 0;
  double processor_seconds_ = 0;
};

void measure(benchmark::State& state, double side) {
  static std::map<double, std::unique_ptr<Bed>> beds;  // settled once for both thread counts
  auto& bed = beds[side];
  if (!bed) bed = std::make_unique<Bed>(side);
  set_threads(static_cast<int>(state.range(0)));
  double exchanged = std::numeric_limits<double>::infinity(), plain = exchanged, kicks = 0, host = 0;
  double processor_exchanged = exchanged, processor_plain = exchanged;
  for (auto _ : state) {
    const double exchange_before = bed->infill().exchange_seconds(),
                 host_before = bed->infill().waiting_seconds();
    double batch = 0;
    bed->take_processor_seconds();
    for (int k = 0; k < steps_per_batch; ++k) batch += bed->advance(1);
    exchanged = std::min(exchanged, batch);
    processor_exchanged = std::min(processor_exchanged, bed->take_processor_seconds());
    kicks += bed->infill().exchange_seconds() - exchange_before;
    host += bed->infill().waiting_seconds() - host_before;
    plain = std::min(plain, bed->advance(steps_per_batch));
    processor_plain = std::min(processor_plain, bed->take_processor_seconds());
  }
  state.counters["share"] = 1 - plain / exchanged;
  state.counters["share_of_processor"] = 1 - processor_plain / processor_exchanged;
  state.counters["share_with_kicks"] = kicks / (kicks + host);
  state.counters["grains"] = static_cast<double>(bed->infill().particles().size());
  state.counters["coordination"] = 2.0 * static_cast<double>(bed->infill().overlaps().contacts) /
                                   static_cast<double>(bed->infill().particles().size());
  state.counters["particle_steps_per_second"] =
      static_cast<double>(bed->infill().particles().size()) * steps_per_batch / plain;
}

void bridge_overhead_20k(benchmark::State& state) {
  measure(state, 0.1096);
}
void bridge_overhead_100k(benchmark::State& state) {
  measure(state, 0.2450);
}

BENCHMARK(bridge_overhead_20k)->Arg(1)->Arg(2)->UseRealTime()->Iterations(20)->Unit(benchmark::kMillisecond);
BENCHMARK(bridge_overhead_100k)->Arg(1)->Arg(2)->UseRealTime()->Iterations(6)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tuft::dem

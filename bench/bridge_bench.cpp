/// What the exchange with liggghts_host costs, as a share of the DEM step: the same settled bed of 20 000 and
/// of 100 000 grains through the bridge, exchanged every step, and by LIGGGHTS alone with its own gravity and
/// walls, in turns. The argument of a benchmark is its number of threads in the driver; LIGGGHTS runs on one
/// core either way.
///
/// An iteration is a new pair of LIGGGHTS processes: where their memory comes to lie changes the speed of
/// either by as much as the exchange costs, for as long as they live. counter `share`: 1 - t_alone/t_bridged
/// in wall time, the median of a pair's turns and then of the pairs (`share_least`, `share_most`: of the
/// pairs); what the bench spends on the forces of the bridged bed's walls is not counted (in a run that is
/// the coupler's contact). counter `share_of_processor`: the same in processor time of driver and host, where
/// time that others take on a shared machine does not count, nor waiting for each other. counter `booked`: of
/// the bridged steps, the share of what a run books as exchange: copies of loads and state, and signals.
///
/// bridge_tcp_20k: the same bed with a host that listens at 127.0.0.1, in turns with one that shares memory.
/// counter `ratio`: of the wall times of a step, medians as above (`ratio_least`, `ratio_most`: of the
/// pairs); `added_ms`: the difference, ms a step.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bench/liggghts_alone_bed.h"
#include "bench/listening_host.h"
#include "core/parallel.h"
#include "dem_bridge/dem_infill.h"

namespace tuft::dem {
namespace {

constexpr int settling_steps = 300, resting_steps = 60, turns = 5;
constexpr double damping = 1000;  // 1/s

/// Rubber grains of 2.0 to 4.25 mm (coarse graining 2.5) in a square tray as deep as turf infill.
class Bed {
 public:
  explicit Bed(double side) {
    materials_[0].name = "rubber";
    materials_[0].grain = GrainMaterial{1150, 8e6, 0.45, 0.5, 0.6, 0.1, 0.0008, 0.0017};
    materials_[0].bulk_density = 0.58 * 1150;
    materials_[0].grain_shares = {{0, 1.0}};
    Turf turf;
    turf.layers = {{0, 0.050}};
    settings_.options.coarse_graining = 2.5;
    PackingRequest request;
    request.size = {side, side};
    request.turf = &turf;
    request.materials = &materials_;
    request.options = &settings_.options;
    settled_ = pack_grains(request);
    settings_.box = {Vec3(-0.6 * side, -0.6 * side, -0.02), Vec3(0.6 * side, 0.6 * side, 0.1)};
    half_ = 0.5 * side;
    bridge(settling_steps);
    for (std::size_t i = 0; i < settled_.size(); ++i)
      settled_.position.set(i, infill_->particles().position(i));
  }

  /// The settled bed in a new process each; their springs come to rest.
  void begin_pair() {
    alone_.reset();
    over_network_.reset();
    bridge(resting_steps);
    const std::span<const double> mass = infill_->particles().mass;
    alone_ = std::make_unique<bench::LiggghtsAloneBed>(settled_, materials_[0], settings_, half_, step());
    alone_->settle(resting_steps, damping * std::accumulate(mass.begin(), mass.end(), 0.0) /
                                      static_cast<double>(mass.size()));
  }

  /// The same, through shared memory and through a host that listens.
  void begin_network_pair() {
    alone_.reset();
    bridge(resting_steps);
    over_network_.reset();
    listener_ = std::make_unique<bench::ListeningHost>();
    over_network_ = start(listener_->endpoint());
    rest(*over_network_, resting_steps);
  }

  bench::Seconds advance(int steps) {
    bench::Seconds sum;
    for (int k = 0; k < steps; ++k) {
      const bench::Seconds one = advance(*infill_);
      sum.wall += one.wall;
      sum.processor += one.processor;
    }
    return sum;
  }
  /// s of wall time.
  double advance_over_network(int steps) {
    double sum = 0;
    for (int k = 0; k < steps; ++k) sum += advance(*over_network_).wall;
    return sum;
  }
  bench::Seconds advance_alone(int steps) { return alone_->advance(steps); }
  [[nodiscard]] const DemInfill& infill() const { return *infill_; }

 private:
  void bridge(int damped_steps) {
    infill_.reset();
    infill_ = start("");
    rest(*infill_, damped_steps);
  }
  [[nodiscard]] std::unique_ptr<DemInfill> start(const std::string& host) const {
    DemSettings settings = settings_;
    settings.options.host = host;
    return std::make_unique<DemInfill>(settled_, materials_, settings);
  }
  void rest(DemInfill& infill, int steps) {
    infill.set_damping(damping);
    for (int k = 0; k < steps; ++k) advance(infill);
    infill.set_damping(0);
  }
  /// One step under the walls' forces at its start; returns its time without what the walls cost.
  bench::Seconds advance(DemInfill& infill) {
    push_from_walls(infill, step());
    const double processor = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    infill.begin_window(step(), 1, false);  // as most windows are: energies are for records
    infill.advance(step(), 1, contact_);
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            processor_seconds() - processor};
  }
  [[nodiscard]] double step() const { return 0.8 * infill_->stable_step(); }
  [[nodiscard]] double processor_seconds() const {
    clockid_t host_clock{};
    timespec driver{}, host{};
    ::clock_getcpuclockid(infill_->host_process(), &host_clock);
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &driver);
    ::clock_gettime(host_clock, &host);
    return static_cast<double>(driver.tv_sec + host.tv_sec) +
           1e-9 * static_cast<double>(driver.tv_nsec + host.tv_nsec);
  }
  void push_from_walls(const DemInfill& infill, double window) {
    constexpr double stiffness = 2e4;  // N/m
    const ParticleView p = infill.particles();
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
  std::vector<Material> materials_{1};
  DemSettings settings_;
  Grains settled_;
  std::unique_ptr<DemInfill> infill_;
  std::unique_ptr<bench::ListeningHost> listener_;
  std::unique_ptr<DemInfill> over_network_;
  std::unique_ptr<bench::LiggghtsAloneBed> alone_;
  ContactImpulses contact_;
  double half_ = 0;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Settled once for all that is measured on it.
std::unique_ptr<Bed>& bed_of(double side) {
  static std::map<double, std::unique_ptr<Bed>> beds;
  auto& bed = beds[side];
  if (!bed) bed = std::make_unique<Bed>(side);
  return bed;
}

void measure(benchmark::State& state, double side, int steps) {
  auto& bed = bed_of(side);
  set_threads(static_cast<int>(state.range(0)));
  std::vector<double> wall, processor, bridged_times;
  double booked = 0, host = 0;
  for (auto _ : state) {
    bed->begin_pair();
    const DemInfill& infill = bed->infill();
    booked -= infill.exchange_seconds(), host -= infill.waiting_seconds();
    std::vector<double> wall_of_turns, processor_of_turns;
    for (int turn = 0; turn < turns; ++turn) {
      const bench::Seconds alone = bed->advance_alone(steps), bridged = bed->advance(steps);
      wall_of_turns.push_back(1 - alone.wall / bridged.wall);
      processor_of_turns.push_back(1 - alone.processor / bridged.processor);
      bridged_times.push_back(bridged.wall);
    }
    wall.push_back(median(wall_of_turns));
    processor.push_back(median(processor_of_turns));
    booked += infill.exchange_seconds(), host += infill.waiting_seconds();
  }
  const DemInfill& infill = bed->infill();
  const auto grains = static_cast<double>(infill.particles().size());
  state.counters["share"] = median(wall);
  state.counters["share_least"] = *std::min_element(wall.begin(), wall.end());
  state.counters["share_most"] = *std::max_element(wall.begin(), wall.end());
  state.counters["share_of_processor"] = median(processor);
  state.counters["booked"] = booked / (booked + host);
  state.counters["grains"] = grains;
  state.counters["coordination"] = 2.0 * static_cast<double>(infill.overlaps().contacts) / grains;
  state.counters["particle_steps_per_second"] = grains * steps / median(bridged_times);
}

void measure_network(benchmark::State& state, double side) {
  constexpr int short_turns = 51, steps = 10;  // what others take of the machine comes and goes
  auto& bed = bed_of(side);
  set_threads(static_cast<int>(state.range(0)));
  std::vector<double> ratio, added;
  for (auto _ : state) {
    bed->begin_network_pair();
    std::vector<double> ratio_of_turns, added_of_turns;
    for (int turn = 0; turn < short_turns; ++turn) {
      const double shared = bed->advance(steps).wall, network = bed->advance_over_network(steps);
      ratio_of_turns.push_back(network / shared);
      added_of_turns.push_back(1e3 * (network - shared) / steps);
    }
    ratio.push_back(median(ratio_of_turns));
    added.push_back(median(added_of_turns));
  }
  state.counters["ratio"] = median(ratio);
  state.counters["ratio_least"] = *std::min_element(ratio.begin(), ratio.end());
  state.counters["ratio_most"] = *std::max_element(ratio.begin(), ratio.end());
  state.counters["added_ms"] = median(added);
  state.counters["grains"] = static_cast<double>(bed->infill().particles().size());
}

constexpr double side_20k = 0.1096;  // m

void bridge_overhead_20k(benchmark::State& state) {
  measure(state, side_20k, 50);
}
void bridge_tcp_20k(benchmark::State& state) {
  measure_network(state, side_20k);
}
void bridge_overhead_100k(benchmark::State& state) {
  measure(state, 0.2450, 20);
}

BENCHMARK(bridge_overhead_20k)->Arg(1)->Arg(2)->UseRealTime()->Iterations(11)->Unit(benchmark::kMillisecond);
BENCHMARK(bridge_tcp_20k)->Arg(1)->Arg(2)->UseRealTime()->Iterations(5)->Unit(benchmark::kMillisecond);
BENCHMARK(bridge_overhead_100k)->Arg(1)->Arg(2)->UseRealTime()->Iterations(9)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tuft::dem

#include "coupler/coming_to_rest.h"

#include <algorithm>
#include <cmath>

namespace tuft::coupler {
namespace {

struct Stage {
  double damping;       ///< 1/s
  double acceleration;  ///< downwards, in g
  double tolerance;     ///< over the rest tolerance; 0: the stage lasts for `share`
  double share;         ///< of the shortest time
};
/// A grain falls no faster than g over the drag: under 600/s at 1 g with 16 mm/s, too slowly for voids to
/// fill. Hence the stage before it, with 490 mm/s. What is left then is the spring back from 5 g to 1 g, and
/// a few grains that fall yet: strong drag quiets the one, weak drag lets the others fall. Of 5700 grains, at
/// rest after 12, 10 and 8.5 ms in all with 300, 600 and 1500/s; of 50 000 after 18, 16 and 19.5 ms.
constexpr Stage of_placed[] = {{1000, 1, 0, 1.0 / 3}, {100, 5, 2, 0}, {600, 1, 1, 1}};
constexpr double tolerance_of_laid = 2;
constexpr Stage of_laid[] = {{1000, 1, 0, 1.0 / 3}, {600, 1, tolerance_of_laid, 1}};

constexpr double interval = 1e-4;             // s
constexpr std::uint64_t looked_at_every = 5;  // intervals

std::uint64_t intervals_in(double time) {
  return static_cast<std::uint64_t>(std::llround(time / interval));
}

}  // namespace

std::vector<double> numbers_of(const PackingReport& report) {
  std::vector<double> numbers = numbers_of(report.rest);
  numbers.insert(numbers.end(), {report.time, report.at_rest ? 1.0 : 0.0, report.moved, report.tolerance,
                                 report.laid ? 1.0 : 0.0});
  return numbers;
}

PackingReport packing_report_of(std::span<const double> n) {
  return {n[4], n[5] != 0, rest_of(n), n[6], n[7], n[8] != 0};
}

PackingReport come_to_rest(Simulation& simulation, const DemOptions& options, Bed bed,
                           const std::function<void(double)>& report) {
  const std::uint64_t least = std::max<std::uint64_t>(1, intervals_in(options.settle_time)),
                      most = std::max(least, intervals_in(options.settle_time_limit));
  PackingReport result;
  std::uint64_t done = 0;
  const std::span<const Stage> stages =
      bed == Bed::placed ? std::span<const Stage>(of_placed) : std::span<const Stage>(of_laid);
  for (const Stage& stage : stages) {
    simulation.set_damping(0, stage.damping);
    simulation.set_infill_acceleration(Vec3(0, 0, -9.81 * (stage.acceleration - 1)));
    const auto share = static_cast<std::uint64_t>(stage.share * static_cast<double>(least));
    for (std::uint64_t in_stage = 1; done < most; ++in_stage) {
      simulation.advance_interval(interval);
      ++done;
      report(static_cast<double>(done) / static_cast<double>(most));
      if (stage.tolerance == 0) {
        if (in_stage >= share) break;
        continue;
      }
      if (in_stage % looked_at_every != 0 || (stage.share > 0 && done < share)) continue;
      result.rest = measure_rest(simulation);
      if (is_at_rest(result.rest, stage.tolerance * options.rest_tolerance)) break;
    }
  }
  result.time = static_cast<double>(done) * interval;
  result.rest = measure_rest(simulation);
  result.tolerance = stages.back().tolerance * options.rest_tolerance;
  result.at_rest = is_at_rest(result.rest, result.tolerance);
  return result;
}

}  // namespace tuft::coupler

#include "rigs/run_remarks.h"

#include <fmt/format.h>

#include <algorithm>

#include "rigs/window_remarks.h"

namespace tuft::rigs {
namespace {

/// "4.2 % of their weight is borne by nothing, energy of motion 1e-05 m g d".
std::string describe(const coupler::RestState& rest) {
  return fmt::format("nothing bears {:.3g} % of their weight, energy of motion is {:.2g} of m g d",
                     100 * rest.unborne_weight, rest.kinetic_share);
}

}  // namespace

void add_remarks(const RunRequest& request, const std::vector<std::string>& remarks, RunSummary& summary) {
  for (const std::string& text : remarks) {
    if (std::ranges::count(summary.remarks, text) > 0) continue;
    summary.remarks.push_back(text);
    if (request.on_remark) request.on_remark(text);
  }
}

std::vector<std::string> remarks_on_window(const Scene& scene, const coupler::Simulation& simulation,
                                           double interval, const std::string& rows) {
  if (scene.numerics.coupling_window == 0) return {};
  const std::string remark =
      remark_on_windows(simulation.stable_steps(interval), scene.numerics, interval, rows);
  return remark.empty() ? std::vector<std::string>{} : std::vector{remark};
}

std::vector<std::string> remarks_on_packing(const Scene& scene, const coupler::PackingReport& packing) {
  std::vector<std::string> remarks;
  if (!packing.cache_trouble.empty()) remarks.push_back(packing.cache_trouble);
  if (!packing.laid)
    remarks.push_back(
        fmt::format("grains had not come to lie when their laying ended after infill.dem.settle_time_limit = "
                    "{:g} ms: the bed "
                    "yet sank or rose; raise it",
                    1e3 * scene.infill.dem.settle_time_limit));
  if (!packing.at_rest)
    remarks.push_back(
        fmt::format("grains were not at rest after {:.3g} ms of packing: {} ({:g} % count as rest, by "
                    "infill.dem.rest_tolerance); raise infill.dem.settle_time_limit",
                    1e3 * packing.time, describe(packing.rest), 100 * packing.tolerance));
  return remarks;
}

std::vector<std::string> remarks_on_rest(const Scene& scene, const RunState& state) {
  std::vector<std::string> remarks;
  const DemOptions& options = scene.infill.dem;
  if (state.packing) remarks = remarks_on_packing(scene, *state.packing);
  if (state.bed_released && !is_at_rest(state.bed_released->rest, options.rest_tolerance))
    remarks.push_back(fmt::format(
        "the bed was not at rest when the rig was released: {} (infill.dem.rest_tolerance is {:g}); "
        "raise numerics.settle_time_limit",
        describe(state.bed_released->rest), options.rest_tolerance));
  return remarks;
}

std::vector<std::string> remarks_on_overlaps(const Scene& scene, const dem::DemInfill& infill) {
  constexpr double worth_saying = 0.1;  // of the smaller radius: contact laws are of small overlaps
  std::vector<std::string> remarks;
  for (const auto& pair : infill.largest_overlaps()) {
    if (!(pair.largest_of_run > worth_saying)) continue;
    const std::string &a = scene.materials.at(static_cast<std::size_t>(pair.first)).name,
                      &b = scene.materials.at(static_cast<std::size_t>(pair.second)).name;
    remarks.push_back(fmt::format(
        "grains of {} and {} overlapped by up to {:.2g} of the smaller radius (over {:g}), where contact "
        "laws "
        "are extrapolated; raise grain.young_modulus, or reduce infill.dem.coarse_graining (a scene may stop "
        "at infill.dem.overlap_limit)",
        a, b, pair.largest_of_run, worth_saying));
  }
  return remarks;
}

}  // namespace tuft::rigs

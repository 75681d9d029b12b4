#include "rigs/grain_notes.h"

#include <fmt/format.h>

#include <optional>

#include "core/error.h"

namespace tuft::rigs {
namespace {

void add(std::map<std::string, Quantity>& notes, const std::string& name,
         const dem::DemInfill::OverlapStatistics& overlaps) {
  notes[name + "_mean"] = {overlaps.mean, "1"};
  notes[name + "_percentile_99"] = {overlaps.percentile_99, "1"};
  notes[name + "_largest"] = {overlaps.largest, "1"};
}

void add_bed(std::map<std::string, Quantity>& notes, const char* when,
             const std::optional<coupler::BedState>& bed) {
  if (!bed) return;
  notes[fmt::format("bed_{}_depth", when)] = {bed->depth, "m"};
  notes[fmt::format("bed_{}_bulk_density", when)] = {bed->bulk_density, "kg/m^3"};
  notes[fmt::format("bed_{}_porosity", when)] = {bed->porosity, "1"};
  notes[fmt::format("bed_{}_coordination", when)] = {bed->coordination, "1"};
  notes[fmt::format("bed_{}_rattlers", when)] = {bed->rest.rattlers, "1"};
  notes[fmt::format("bed_{}_unborne_weight", when)] = {bed->rest.unborne_weight, "1"};
  notes[fmt::format("bed_{}_unbalanced_force", when)] = {bed->rest.unbalanced_force, "1"};
  notes[fmt::format("bed_{}_kinetic_share", when)] = {bed->rest.kinetic_share, "1"};
  notes[fmt::format("bed_{}_speed_median", when)] = {bed->speed_median, "m/s"};
  notes[fmt::format("bed_{}_speed_percentile_99", when)] = {bed->speed_percentile_99, "m/s"};
  notes[fmt::format("bed_{}_speed_largest", when)] = {bed->speed_largest, "m/s"};
  notes[fmt::format("bed_{}_overlap_mean", when)] = {bed->overlap_mean, "1"};
  notes[fmt::format("bed_{}_overlap_percentile_99", when)] = {bed->overlap_percentile_99, "1"};
  notes[fmt::format("bed_{}_overlap_largest", when)] = {bed->overlap_largest, "1"};
}

}  // namespace

void add_bed_notes(const Scene& scene, const RunState& state, std::map<std::string, Quantity>& notes) {
  add_bed(notes, "placed", state.bed_placed);
  add_bed(notes, "released", state.bed_released);
  if (state.packing) {
    notes["packing_time"] = {state.packing->time, "s"};
    notes["packing_at_rest"] = {state.packing->at_rest ? 1.0 : 0.0, "1"};
    notes["packing_laid"] = {state.packing->laid ? 1.0 : 0.0, "1"};
    notes["packing_grains_moved"] = {state.packing->moved, "1"};
  }
  if (!state.bed_released) return;
  const std::uint64_t settled = state.settled > 0 ? state.settled : state.schedule.settle;
  notes["bed_settle_time"] = {static_cast<double>(settled) * state.schedule.interval, "s"};
  const bool at_rest = is_at_rest(state.bed_released->rest, scene.infill.dem.rest_tolerance);
  notes["bed_at_rest"] = {at_rest ? 1.0 : 0.0, "1"};
}

void add_grain_notes(const dem::DemInfill& infill, const std::vector<Material>& materials, bool host_lost,
                     std::map<std::string, Quantity>& notes) {
  notes["grain_step_of_rayleigh_time"] = {infill.rayleigh_share(), "1"};
  if (!host_lost) {
    const auto overlaps = infill.overlaps();
    add(notes, "grain_overlap", overlaps);
    notes["grain_contacts"] = {static_cast<double>(overlaps.contacts), "1"};
  }
  for (const auto& pair : host_lost ? infill.largest_overlaps() : infill.overlaps_by_pair()) {
    const std::string name =
        fmt::format("grain_overlap_{}_{}", materials.at(static_cast<std::size_t>(pair.first)).name,
                    materials.at(static_cast<std::size_t>(pair.second)).name);
    notes[name + "_largest_of_run"] = {pair.largest_of_run, "1"};
    if (host_lost) continue;
    add(notes, name, pair.now);
    notes[name + "_contacts"] = {static_cast<double>(pair.now.contacts), "1"};
  }
}

}  // namespace tuft::rigs

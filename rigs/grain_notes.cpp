#include "rigs/grain_notes.h"

#include "core/error.h"

namespace tuft::rigs {
namespace {

void add(std::map<std::string, Quantity>& notes, const std::string& name,
         const dem::DemInfill::OverlapStatistics& overlaps) {
  notes[name + "_mean"] = {overlaps.mean, "1"};
  notes[name + "_percentile_99"] = {overlaps.percentile_99, "1"};
  notes[name + "_largest"] = {overlaps.largest, "1"};
}

}  // namespace

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

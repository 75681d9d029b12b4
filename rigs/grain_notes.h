#pragma once
/// What a run with grains says of them in its summary.
#include <map>
#include <string>
#include <vector>

#include "core/scene.h"
#include "dem_bridge/dem_infill.h"
#include "rigs/run.h"
#include "rigs/run_state.h"

namespace tuft::rigs {

/// How the bed lay when it was placed and when the rig was released, and how it came to rest
/// (coupler/bed_state.h). Nothing of a continuum.
void add_bed_notes(const Scene& scene, const RunState& state, std::map<std::string, Quantity>& notes);

/// Overlap over the smaller radius: mean, 99th percentile and largest of all contacts as they are, and for
/// each pair of materials `grain_overlap_<a>_<b>_...`, with the largest of the run as far as it was looked at
/// (with each history row); the largest step over the smallest Rayleigh time. A host that is lost is not
/// asked: then only what is known without it is told.
void add_grain_notes(const dem::DemInfill& infill, const std::vector<Material>& materials, bool host_lost,
                     std::map<std::string, Quantity>& notes);

}  // namespace tuft::rigs

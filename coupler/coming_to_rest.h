#pragma once
/// Packed grains come to rest by dynamics, while strands stand still.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/scene.h"
#include "coupler/bed_state.h"
#include "coupler/simulation.h"

namespace tuft::coupler {

/// How a packing came about.
struct PackingReport {
  double time = 0;       ///< s of dynamics that it took
  bool at_rest = false;  ///< by `tolerance`
  RestState rest;        ///< in the end
  double moved = 0;      ///< grains that stuck between strands and were placed elsewhere in their layer
  double tolerance = 0;  ///< the share of weight unborne that counted as rest
  bool laid = true;      ///< false: laying ended (laying.h) while the bed yet sank or rose
  std::string cache_trouble{};  ///< a line on the cache's file, where it was of no use; empty: there was none
};
[[nodiscard]] std::vector<double> numbers_of(const PackingReport& report);
[[nodiscard]] PackingReport packing_report_of(std::span<const double> numbers);

/// How grains lie before: placed by geometry alone, or laid already (laying.h).
enum class Bed { placed, laid };

/// Stages: strong drag, in which what overlaps still parts slowly; for a bed that is only placed, several g
/// with light drag, until nearly all that weighs is borne; 1 g with strong drag, until the grains are at
/// rest: by options.rest_tolerance, of a laid bed by twice that, for it settles again as its strands are let
/// go. At least options.settle_time, at most options.settle_time_limit (whichever is longer). `report` gets
/// the share of that limit that is done. `moved` and `laid` of the result are left as they are made.
PackingReport come_to_rest(Simulation& simulation, const DemOptions& options, Bed bed,
                           const std::function<void(double)>& report);

}  // namespace tuft::coupler

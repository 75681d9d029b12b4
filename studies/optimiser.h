#pragma once
/// Minimising a function over the unit box without derivatives, by NLopt.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/calibration_file.h"

namespace tuft::studies {

struct SearchEnd {
  bool stopped = false;  ///< the function asked for it
  std::string reason;    ///< in words: "parameters change by less than 0.0001"
};

/// Value at a point of [0, 1]^n, finite; empty: stop.
using Objective = std::function<std::optional<double>(const std::vector<double>&)>;

/// Searches from `start`; the caller keeps the best point that it was asked for. A global algorithm spends
/// `global_share` of the evaluations over the whole box, BOBYQA the rest from its best point. A local search
/// begins anew from its best point, with the initial step, as long as that gains a thousandth: misfit has
/// corners in its curvature at the ends of ranges, on which a search may end early. Deterministic: the same
/// values give the same points.
[[nodiscard]] SearchEnd minimise(const OptimiserChoice& choice, const std::vector<double>& start,
                                 const Objective& objective);

}  // namespace tuft::studies

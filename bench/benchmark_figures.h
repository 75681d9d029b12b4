#pragma once
/// From Google Benchmark's JSON to figures.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/figure.h"

namespace tuft::bench {

/// Takes every measured repetition named `<figure>/<threads>[/...]`. The value is the user counter
/// `element_steps` of shells, `particle_steps` of SPH or `point_updates` of its law, rates of which the
/// largest counts, or `share` of the bridge, of which the median counts. Names that are not in the list of
/// figures are left out, so that a benchmark program may hold others for its own use. Throws
/// std::runtime_error for a figure without a value, or one that stopped with an error (with its words).
[[nodiscard]] Figures figures_of_benchmark(const nlohmann::json& report);

/// Names of all figures that benchmark programs are expected to give, with their suffixes /1 and /2.
[[nodiscard]] std::vector<std::string> benchmark_figure_names();

}  // namespace tuft::bench

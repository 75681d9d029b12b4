#pragma once
/// Results and cost of one or more runs as a table for the terminal.
#include <string>
#include <vector>

#include "rigs/run.h"

namespace tuft::app {

/// One column a run: results, conservation, cost.
[[nodiscard]] std::string summary_table(const std::vector<rigs::RunSummary>& summaries);

/// Names of all results that occur: a rig's main ones in the order a reader asks for them, then the rest by
/// name.
[[nodiscard]] std::vector<std::string> result_names(const std::vector<rigs::RunSummary>& summaries);

}  // namespace tuft::app

#pragma once
/// Results and cost of one or more runs as a table for the terminal.
#include <string>
#include <vector>

#include "rigs/run.h"

namespace tuft::app {

/// One column a run: results, conservation, cost.
[[nodiscard]] std::string summary_table(const std::vector<rigs::RunSummary>& summaries);

}  // namespace tuft::app

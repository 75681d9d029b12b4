#pragma once
/// The report: one self-contained HTML page from one or more runs.
#include <filesystem>
#include <string>
#include <vector>

#include "app/report_data.h"

namespace tuft::app {

/// The whole page.
[[nodiscard]] std::string report_page(const std::vector<RunData>& runs);

/// Reads the runs (folders of `compare` are expanded), writes the page to `file`. Throws InputError for a
/// folder that holds no run, RunError when the page cannot be written.
void write_report(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& file);

}  // namespace tuft::app

#pragma once
/// The sections of the report, each a function of the runs to HTML. Order on the page: as below.
#include <string>
#include <vector>

#include "app/report_data.h"

namespace tuft::app {

using Runs = std::vector<RunData>;

[[nodiscard]] std::string report_style();
[[nodiscard]] std::string report_script();
[[nodiscard]] std::string report_head(const Runs& runs);     ///< title, what was run, state of each run
[[nodiscard]] std::string report_results(const Runs& runs);  ///< table of results
/// What the runs say of themselves in words; empty if nothing.
[[nodiscard]] std::string report_remarks(const Runs& runs);
[[nodiscard]] std::string report_curves(const Runs& runs);    ///< acceleration, velocity, penetration
[[nodiscard]] std::string report_sections(const Runs& runs);  ///< side views at three instants
[[nodiscard]] std::string report_energy(const Runs& runs);    ///< balance, error, limits
[[nodiscard]] std::string report_cost(const Runs& runs);      ///< phases, rates, memory
[[nodiscard]] std::string report_effects(const Runs& runs);   ///< named effects and why
[[nodiscard]] std::string report_inputs(const Runs& runs);    ///< settings and materials

/// Runs of rigs that test the carpet alone have a page of their own: results, curves and energy in one.
[[nodiscard]] bool all_of_components(const Runs& runs);
[[nodiscard]] std::string describe_tension_rig(const Scene& scene);
[[nodiscard]] std::string report_tension(const Runs& runs);
[[nodiscard]] std::string report_tension_inputs(const Runs& runs);

/// Runs of rigs that test infill alone, the same.
[[nodiscard]] bool all_of_specimens(const Runs& runs);
[[nodiscard]] std::string describe_specimen_rig(const Scene& scene);
[[nodiscard]] std::string report_specimen(const Runs& runs);
/// Settings and materials of runs without a patch.
[[nodiscard]] std::string report_specimen_inputs(const Runs& runs);

/// CSS class of a run's colour: SPH and DEM keep theirs on every page where each occurs once.
[[nodiscard]] std::string run_style(const Runs& runs, std::size_t index);
/// Time zero of a run's curves: first touch, else release. s since release.
[[nodiscard]] double time_origin(const RunData& run);
/// Header row of a table with one column a run.
[[nodiscard]] std::vector<std::string> run_header(const std::string& first, const Runs& runs);

}  // namespace tuft::app

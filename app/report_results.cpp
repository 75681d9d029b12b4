/// Title, what was run, and the table of results.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "app/summary_table.h"

namespace tuft::app {
namespace {

std::string state_badge(const rigs::RunSummary& summary) {
  return fmt::format("<span class=\"state {0}\">{0}</span>", escape_html(summary.status));
}

std::string describe_rig(const Scene& scene) {
  const CleggRig& clegg = scene.rig.clegg;
  return fmt::format("Clegg hammer: {} kg, {} mm diameter, {} m/s at first contact", format_input(clegg.mass),
                     format_input(1e3 * clegg.diameter), format_input(clegg.speed));
}

std::string describe_turf(const Scene& scene, bool fibres) {
  std::string layers;
  for (const Layer& layer : scene.turf.layers) {
    if (!layers.empty()) layers += ", ";
    layers += fmt::format("{} mm {}", format_input(1e3 * layer.depth),
                          escape_html(scene.materials.at(static_cast<std::size_t>(layer.material)).name));
  }
  const CarpetDesign& carpet = scene.turf.carpet;
  const std::string pile =
      fibres && !carpet.mesh.file.empty() ? fmt::format("carpet from {}", escape_html(carpet.mesh.file))
      : fibres ? fmt::format("pile {} mm, gauge {} mm, stitch {} mm, {} strands a tuft",
                             format_input(1e3 * carpet.pile_length), format_input(1e3 * carpet.gauge),
                             format_input(1e3 * carpet.stitch_spacing), carpet.strands_per_tuft)
               : std::string("no fibres (effect switched off)");
  return fmt::format("{} × {} mm patch; infill from the bottom: {}; {}",
                     format_input(1e3 * scene.turf.size[0]), format_input(1e3 * scene.turf.size[1]), layers,
                     pile);
}

std::string describe_states(const Runs& runs) {
  std::string text;
  for (const RunData& run : runs) {
    text += fmt::format(
        "<p class=\"run\"><b>{}</b> {} {} {} in {}", escape_html(run.label), state_badge(run.summary),
        run.summary.status == "completed" ? "" : "·",
        run.scene && run.scene->rig.is_specimen()
            ? fmt::format("{} simulated", format_quantity(run.summary.simulated_time, "s"))
            : fmt::format("simulated to {} after release,", format_quantity(run.summary.simulated_time, "s")),
        format_duration(run.summary.wall_s));
    if (!run.summary.error.empty())
      text += fmt::format("<br><span class=\"error\">{}</span>", escape_html(run.summary.error));
    if (!run.unreadable.empty())
      text += fmt::format("<br><span class=\"error\">No curves and frames: {}</span>",
                          escape_html(run.unreadable));
    text += "</p>\n";
  }
  return text;
}

/// How a run compares with the first: only where there are exactly two.
std::string difference(double first, double second) {
  if (!std::isfinite(first) || !std::isfinite(second) || first == 0) return not_available;
  const double relative = (second - first) / std::abs(first);
  if (std::abs(relative) < 5e-4) return "0 %";
  return fmt::format("{}{} %", relative < 0 ? "−" : "+", format_significant(std::abs(100 * relative), 2));
}

std::vector<std::string> result_row(const Runs& runs, const std::string& name, std::vector<double>& values) {
  std::string unit;
  double largest = 0;
  for (const RunData& run : runs) {
    const auto found = run.summary.results.find(name);
    values.push_back(found == run.summary.results.end() ? std::nan("") : found->second.value);
    if (found != run.summary.results.end()) unit = found->second.unit;
    if (std::isfinite(values.back())) largest = std::max(largest, std::abs(values.back()));
  }
  const DisplayUnit shown = display_unit(unit, largest);
  std::vector<std::string> row{
      readable_name(name) + (shown.unit.empty() ? "" : fmt::format(" <i>[{}]</i>", escape_html(shown.unit)))};
  for (const double value : values)
    row.push_back(std::isfinite(value) ? format_significant(shown.factor * value, 3) : not_available);
  return row;
}

}  // namespace

std::string report_head(const Runs& runs) {
  if (runs.empty()) return "<h1>No run</h1>\n";
  const RunData& first = runs.front();
  std::set<std::string> versions;
  for (const RunData& run : runs) versions.insert(run.summary.version);
  std::string text = fmt::format("<header>\n<h1>{}</h1>\n", escape_html(first.summary.scene_name));
  if (first.scene && first.scene->rig.is_component()) {
    text += fmt::format("<dl>\n<dt>Rig</dt><dd>{}</dd>\n", describe_tension_rig(*first.scene));
  } else if (first.scene && first.scene->rig.is_specimen()) {
    text += "<dl>\n";
    for (const RunData& run : runs)
      if (run.scene && run.scene->rig.is_specimen())
        text += fmt::format("<dt>Rig</dt><dd>{}</dd>\n", describe_specimen_rig(*run.scene));
  } else if (first.scene) {
    text += fmt::format("<dl>\n<dt>Rig</dt><dd>{}</dd>\n<dt>Turf</dt><dd>{}</dd>\n",
                        describe_rig(*first.scene), describe_turf(*first.scene, has_fibres(first)));
  } else {
    text += fmt::format("<dl>\n<dt>Rig</dt><dd>{}</dd>\n", escape_html(first.summary.rig));
  }
  std::string all;
  for (const std::string& version : versions) all += (all.empty() ? "" : ", ") + version;
  text += fmt::format("<dt>Program</dt><dd>tuft {}</dd>\n</dl>\n", escape_html(all));
  return text + describe_states(runs) + "</header>\n";
}

std::string report_results(const Runs& runs) {
  std::vector<rigs::RunSummary> summaries;
  for (const RunData& run : runs) summaries.push_back(run.summary);
  const std::vector<std::string> names = result_names(summaries);
  if (names.empty())
    return html_section("results", "Results",
                        "<p class=\"missing\">No result was measured before the run ended.</p>\n");
  const bool pair = runs.size() == 2;
  HtmlTable table{"results-table", "", run_header("", runs), {}, false};
  if (pair)
    table.header.push_back(
        fmt::format("{} against {}", escape_html(runs[1].label), escape_html(runs[0].label)));
  for (const std::string& name : names) {
    std::vector<double> values;
    std::vector<std::string> row = result_row(runs, name, values);
    if (pair) row.push_back(difference(values[0], values[1]));
    table.rows.push_back(std::move(row));
  }
  return html_section("results", "Results", table.html());
}

}  // namespace tuft::app

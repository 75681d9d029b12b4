/// Where the energy of the impact goes, and how well the balance closes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "app/svg_plot.h"

namespace tuft::app {
namespace {

constexpr double momentum_limit = 1e-9;  // impulses given and received, relative: rounding and nothing else

struct Term {
  std::string column, label, style;
};

/// Terms in the order of the legend; colours stay with the term on every page.
const std::vector<Term>& terms() {
  static const std::vector<Term> all{{"kinetic_bodies", "missile, kinetic", "e0"},
                                     {"stored_infill", "infill, stored", "e1"},
                                     {"dissipated_infill", "infill, dissipated", "e2"},
                                     {"kinetic_infill", "infill, kinetic", "e3"},
                                     {"strain_carpet", "carpet, strain", "e4"},
                                     {"kinetic_carpet", "carpet, kinetic", "e5"},
                                     {"contact_friction", "contact, friction", "e6"},
                                     {"contact_damping", "contact, damping", "e7"},
                                     {"contact_elastic", "contact, elastic", "e8"},
                                     {"gravity_potential", "gravity", "e9"},
                                     {"hourglass", "hourglass", "e10"},
                                     {"eroded", "failed shells", "e13"},
                                     {"damping", "mass damping", "e11"},
                                     {"expelled", "infill that left", "e14"},
                                     {"conditioning", "let go by spheres", "e15"},
                                     {"external_work", "external work", "e12"}};
  return all;
}

std::size_t row_at(const std::vector<double>& time, double at) {
  const auto found = std::lower_bound(time.begin(), time.end(), at - 1e-12);
  return found == time.end() ? 0 : static_cast<std::size_t>(found - time.begin());
}

/// First row with the missile in motion: its energy has entered the books, nothing has been spent yet.
std::size_t row_of_release(const TimeTable& energy) {
  std::size_t row = row_at(energy.time, 0);
  if (!energy.has("kinetic_bodies")) return row;
  const std::vector<double>& missile = energy.at("kinetic_bodies");
  while (row + 1 < missile.size() && missile[row] <= 0) ++row;
  return row;
}

/// Change since the release, J. The missile's own term stays absolute: it is what there is to spend.
std::vector<double> since_release(const TimeTable& energy, const std::string& column) {
  std::vector<double> values = energy.at(column);
  const double start = column == "kinetic_bodies" || values.empty() ? 0 : values[row_of_release(energy)];
  for (double& value : values) value -= start;
  return values;
}

double largest_after(std::size_t first, const std::vector<double>& values) {
  double largest = 0;
  for (std::size_t i = first; i < values.size(); ++i) largest = std::max(largest, std::abs(values[i]));
  return largest;
}

Plot balance_plot(const RunData& run, std::size_t index, std::string& small) {
  Plot plot{fmt::format("energy-{}", index),
            run.touch_time ? "time since first touch [ms]" : "time since release [ms]",
            "energy [J]",
            {},
            {},
            {}};
  std::map<std::string, std::vector<double>> values;
  const std::size_t release = row_of_release(run.energy);
  double scale = 0;
  for (const Term& term : terms()) {
    if (!run.energy.has(term.column)) continue;
    values[term.column] = since_release(run.energy, term.column);
    scale = std::max(scale, largest_after(release, values[term.column]));
  }
  for (const Term& term : terms()) {
    if (!values.contains(term.column)) continue;
    const double largest = largest_after(release, values[term.column]);
    if (largest < 0.01 * scale) {
      small +=
          fmt::format("{}{} ({} J)", small.empty() ? "" : ", ", term.label, format_significant(largest, 2));
      continue;
    }
    Series series{term.label, term.style, {}, values[term.column], false, false};
    series.y.erase(series.y.begin(), series.y.begin() + static_cast<std::ptrdiff_t>(release));
    for (std::size_t row = release; row < run.energy.time.size(); ++row)
      series.x.push_back(1e3 * (run.energy.time[row] - time_origin(run)));
    plot.series.push_back(std::move(series));
  }
  if (!run.energy.time.empty()) {
    const double end = 1e3 * (run.energy.time.back() - time_origin(run));
    plot.x_range = {std::max(1e3 * (0 - time_origin(run)), -0.05 * std::abs(end)), end};
    if (plot.x_range->second <= plot.x_range->first) plot.x_range.reset();
  }
  return plot;
}

std::string error_plot(const Runs& runs) {
  Plot plot{"energy-error", "time since first touch [ms]", "energy error [%]", {}, {}, {}, 1000, 220};
  double largest = 0, limit = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].energy.has("error")) continue;
    Series series{runs[i].label, run_style(runs, i), {}, {}, false, false};
    for (std::size_t row = 0; row < runs[i].energy.time.size(); ++row) {
      series.x.push_back(1e3 * (runs[i].energy.time[row] - time_origin(runs[i])));
      series.y.push_back(100 * runs[i].energy.at("error")[row]);
      largest = std::max(largest, std::abs(series.y.back()));
    }
    plot.series.push_back(std::move(series));
    if (runs[i].scene) limit = std::max(limit, 100 * runs[i].scene->numerics.energy_error_limit);
  }
  // The limit is drawn where it does not flatten the curves; the table below states it in any case.
  if (limit > 0 && limit < 4 * largest)
    plot.horizontal_lines.emplace_back(limit, fmt::format("limit {:g} %", limit));
  return svg_plot(plot);
}

std::string within(double value, double limit) {
  if (!std::isfinite(value)) return not_available;
  return value <= limit ? "<span class=\"good\">within</span>" : "<span class=\"bad\">above</span>";
}

std::string limits_table(const Runs& runs) {
  HtmlTable table{"conservation-table", "", {"Largest over the run", "Limit"}, {}, false};
  std::vector<std::string> energy{"Energy error, relative", not_available},
      momentum{"Momentum error of the exchanges, relative", format_significant(momentum_limit, 1)};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    table.header.push_back(run_header("", runs)[i + 1]);
    const double limit = runs[i].scene ? runs[i].scene->numerics.energy_error_limit : std::nan("");
    if (std::isfinite(limit)) energy[1] = format_percent(limit);
    energy.push_back(fmt::format("{} {}", format_percent(runs[i].summary.energy_error),
                                 std::isfinite(limit) ? within(runs[i].summary.energy_error, limit) : ""));
    momentum.push_back(fmt::format("{} {}", format_significant(runs[i].summary.momentum_error, 2),
                                   within(runs[i].summary.momentum_error, momentum_limit)));
  }
  table.rows = {energy, momentum};
  return table.html();
}

}  // namespace

std::string report_energy(const Runs& runs) {
  std::string text = limits_table(runs) + error_plot(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::string small;
    const Plot plot = balance_plot(runs[i], i, small);
    text += fmt::format("<h3>{}</h3>\n{}", escape_html(runs[i].label), svg_plot(plot));
    if (!small.empty())
      text += fmt::format(
          "<p class=\"note\">Below 1 % of the largest term and not drawn (largest change): {}.</p>\n", small);
  }
  text +=
      "<p class=\"note\">The missile’s kinetic energy is shown as it is, all other terms as their change "
      "since "
      "the release. Stored in the infill: elastic energy of the continuum (SPH) or of the contacts between "
      "grains "
      "(DEM). Dissipated in it: plastic and viscous work (SPH), friction and damping between grains "
      "(DEM).</p>\n";
  return html_section("energy", "Energy balance", text);
}

}  // namespace tuft::app

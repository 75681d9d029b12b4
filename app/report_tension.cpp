/// The report of tension rigs: results by rate, stress against strain, the energy balance.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "app/svg_plot.h"

namespace tuft::app {
namespace {

/// Rows of one test, as indices into a run's histories.
std::vector<std::size_t> rows_of_test(const RunData& run, std::size_t test) {
  std::vector<std::size_t> rows;
  if (!run.history.has("test")) return rows;
  const std::vector<double>& tests = run.history.at("test");
  for (std::size_t row = 0; row < tests.size(); ++row)
    if (static_cast<std::size_t>(tests[row]) == test) rows.push_back(row);
  return rows;
}

const std::vector<double>& rates_of(const RunData& run) {
  return run.scene->rig.tension.rates;
}

std::string test_label(const Runs& runs, const RunData& run, double rate) {
  return fmt::format("{:g} 1/s{}", rate, runs.size() > 1 ? ", " + run.label : "");
}

/// One curve a test; colours go on from run to run.
Plot plot_of_tests(const Runs& runs, const std::string& id, const std::string& y_label,
                   const std::string& column, double factor, bool of_energy) {
  Plot plot{id, "engineering strain [%]", y_label, {}, {}, {}};
  std::size_t colour = 0;
  for (const RunData& run : runs) {
    if (!run.scene) continue;
    const TimeTable& table = of_energy ? run.energy : run.history;
    if (!table.has(column) || !run.history.has("strain")) continue;
    for (std::size_t test = 0; test < rates_of(run).size(); ++test) {
      Series series{
          test_label(runs, run, rates_of(run)[test]), fmt::format("c{}", colour++ % 6), {}, {}, false, false};
      for (const std::size_t row : rows_of_test(run, test)) {
        if (row >= table.time.size()) continue;
        series.x.push_back(100 * run.history.at("strain")[row]);
        series.y.push_back(factor * table.at(column)[row]);
      }
      if (!series.x.empty()) plot.series.push_back(std::move(series));
    }
  }
  return plot;
}

std::string cell(const RunData& run, const std::string& name) {
  const auto found = run.summary.results.find(name);
  if (found == run.summary.results.end()) return "–";
  const rigs::Quantity& q = found->second;
  return q.unit == "1" ? format_percent(q.value) : format_quantity(q.value, q.unit);
}

std::string results_by_rate(const Runs& runs) {
  HtmlTable table{"tension-table",
                  "",
                  {"Strain rate", "Initial modulus", "Stress at 5 %", "at 10 %", "at 20 %", "Largest",
                   "at strain", "Failed at strain", "under stress"},
                  {},
                  false};
  for (const RunData& run : runs) {
    if (!run.scene) continue;
    for (const double rate : rates_of(run)) {
      std::vector<std::string> row{escape_html(test_label(runs, run, rate))};
      for (const char* name :
           {"initial_modulus", "stress_at_05_percent", "stress_at_10_percent", "stress_at_20_percent",
            "peak_stress", "strain_at_peak", "strain_at_failure", "stress_at_failure"})
        row.push_back(cell(run, fmt::format("rate_{:g}_{}", rate, name)));
      table.rows.push_back(std::move(row));
    }
  }
  return table.html() +
         "<p class=\"note\">Engineering stress (force over the section as cut) and engineering strain "
         "(elongation "
         "over the gauge length). Initial modulus: secant between 0.05 % and 0.25 % strain. Failure: the "
         "last row "
         "before a shell fails; – where none did.</p>\n";
}

std::string describe_material(const ShellMaterial& material) {
  std::string text =
      fmt::format("E {}, ν {}, density {} kg/m³", format_quantity(material.young_modulus, "Pa", 4),
                  format_input(material.poisson_ratio), format_input(material.density));
  if (material.orthotropic())
    text +=
        fmt::format(", across the stitch E {}, G {}", format_quantity(material.across_young_modulus, "Pa", 4),
                    format_quantity(material.shear_modulus, "Pa", 4));
  for (const PronyTerm& term : material.relaxation)
    text += fmt::format("; relaxing: G {} at {} 1/s", format_quantity(term.modulus, "Pa", 4),
                        format_significant(term.decay, 4));
  return text;
}

}  // namespace

bool all_of_components(const Runs& runs) {
  return !runs.empty() && std::all_of(runs.begin(), runs.end(), [](const RunData& run) {
    return run.scene && run.scene->rig.is_component();
  });
}

std::string describe_tension_rig(const Scene& scene) {
  const TensionRig& rig = scene.rig.tension;
  std::string lengths;
  for (const double length : rig.gauge_lengths)
    lengths += fmt::format("{}{}", lengths.empty() ? "" : ", ", format_input(1e3 * length));
  const bool strand = scene.rig.type == "strand_tension";
  const std::string what = strand ? std::string("one strand")
                                  : fmt::format("strip of backing cut {} the stitch",
                                                rig.direction == StripDirection::along ? "along" : "across");
  return fmt::format("Tension of {}, {} mm wide, {} mm between grips that {}", what,
                     format_input(1e3 * rig.width), lengths,
                     rig.grips == StripGrips::hold_width ? "hold the width" : "let the ends contract");
}

std::string report_tension(const Runs& runs) {
  std::string note =
      "<p class=\"note\">True stress: engineering stress × (1 + strain), as if the volume stayed.";
  if (std::any_of(runs.begin(), runs.end(),
                  [](const RunData& run) { return run.scene->rig.tension.mass_factor > 1; }))
    note +=
        " The density was raised (rig.mass_factor) for longer steps; the kinetic share below says what that "
        "did.";
  return html_section("results", "Results", results_by_rate(runs)) +
         html_section("curves", "Stress against strain",
                      svg_plot(plot_of_tests(runs, "curve-stress", "engineering stress [MPa]", "stress", 1e-6,
                                             false)) +
                          svg_plot(plot_of_tests(runs, "curve-true-stress", "true stress [MPa]",
                                                 "true_stress", 1e-6, false)) +
                          note + "</p>\n") +
         html_section(
             "energy", "Energy balance",
             svg_plot(
                 plot_of_tests(runs, "energy-work", "work of the grip [mJ]", "external_work", 1e3, true)) +
                 svg_plot(plot_of_tests(runs, "energy-error", "energy error [%]", "error", 100, true)));
}

std::string report_tension_inputs(const Runs& runs) {
  HtmlTable table{"materials-table", "", {"Run", "Material", "Shells"}, {}, true};
  HtmlTable notes{"notes-table", "", {"Measured by the run", ""}, {}, false};
  for (const RunData& run : runs) {
    const bool strand = run.scene->rig.type == "strand_tension";
    const CarpetDesign& carpet = run.scene->turf.carpet;
    const ShellSection& section = strand ? carpet.fibre_section : carpet.backing_section;
    table.rows.push_back(
        {escape_html(run.label), describe_material(strand ? carpet.fibre : carpet.backing),
         fmt::format("{}, {} through the thickness of {}",
                     section.element == ElementKind::one_point ? "one point" : "2 × 2 points",
                     section.thickness_points,
                     format_quantity(strand ? carpet.strand_thickness : carpet.backing_thickness, "m"))});
    for (const auto& [name, quantity] : run.summary.notes)
      notes.rows.push_back(
          {escape_html(readable_name(name)), escape_html(format_quantity(quantity.value, quantity.unit))});
    notes.rows.push_back({"Energy error", format_percent(run.summary.energy_error)});
    notes.rows.push_back({"Momentum error", format_significant(run.summary.momentum_error, 2)});
  }
  return html_section("inputs", "Settings and material",
                      table.html() + notes.html() +
                          "<p class=\"note\">All inputs with every default written out are in "
                          "<code>scene.toml</code> in each run’s folder.</p>\n");
}

}  // namespace tuft::app

/// The report of oedometer, direct shear and pull-out: results by load, cycle or speed, curves, the
/// Mohr-Coulomb line, energies.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "app/svg_plot.h"

namespace tuft::app {
namespace {

const SpecimenRig& rig_of(const RunData& run) {
  return run.scene->rig.specimen;
}

bool is_ring(const RunData& run) {
  return run.scene->rig.type == "oedometer";
}

Runs of_type(const Runs& runs, const char* type) {
  Runs chosen;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(chosen),
               [type](const RunData& run) { return run.scene->rig.type == type; });
  return chosen;
}

/// What tells a test from others, in labels and in names of results.
struct TestName {
  std::string label, prefix;
};

std::vector<TestName> tests_of(const RunData& run) {
  std::vector<TestName> names;
  if (is_ring(run))
    for (const double force : rig_of(run).preloads)
      names.push_back({fmt::format("{:g} N", force), fmt::format("preload_{:g}_", force)});
  else if (run.scene->rig.has_strand())
    for (const double speed : rig_of(run).speeds)
      names.push_back({fmt::format("{:g} mm/s", 1e3 * speed), fmt::format("speed_{:g}_mm_s_", 1e3 * speed)});
  else
    for (const double stress : rig_of(run).normal_stresses)
      names.push_back(
          {fmt::format("{:g} kPa", 1e-3 * stress), fmt::format("normal_{:g}_kpa_", 1e-3 * stress)});
  return names;
}

std::string label_of(const Runs& runs, const RunData& run, const TestName& test) {
  return runs.size() > 1 ? run.label + ", " + test.label : test.label;
}

std::string cell(const std::map<std::string, rigs::Quantity>& values, const std::string& name) {
  const auto found = values.find(name);
  if (found == values.end()) return "–";
  const rigs::Quantity& q = found->second;
  return q.unit == "1" ? format_percent(q.value) : format_quantity(q.value, q.unit);
}

/// A column of one table over a column of another, one curve a test. Of one run each test has a colour; of
/// several each run has, and every second test is dashed.
struct Axis {
  std::string column;
  double factor;
};

/// Rows of a test that are drawn.
enum class Rows { all, shearing, drawing };

bool is_drawn(const TimeTable& history, std::size_t row, Rows rows) {
  if (rows == Rows::shearing) return history.at("shearing")[row] != 0;
  return rows == Rows::all || history.at("phase")[row] == 2;
}

Plot plot_of_tests(const Runs& runs, const std::string& id, const std::string& x_label, const Axis& x,
                   const std::string& y_label, const Axis& y, bool y_of_energy, Rows rows) {
  Plot plot{id, x_label, y_label, {}, {}, {}};
  const bool several = runs.size() > 1;
  for (std::size_t number = 0; number < runs.size(); ++number) {
    const RunData& run = runs[number];
    const TimeTable& table = y_of_energy ? run.energy : run.history;
    const auto names = tests_of(run);
    for (std::size_t test = 0; test < names.size(); ++test) {
      Series series{
          label_of(runs, run, names[test]), fmt::format("c{}", (several ? number : test) % 6), {}, {}, false,
          several && test % 2 == 1};
      if (!table.has(y.column) || !run.history.has(x.column) || !run.history.has("test")) continue;
      for (std::size_t row = 0; row < std::min(run.history.time.size(), table.time.size()); ++row) {
        if (static_cast<std::size_t>(run.history.at("test")[row]) != test) continue;
        if (!is_drawn(run.history, row, rows)) continue;
        series.x.push_back(x.factor * run.history.at(x.column)[row]);
        series.y.push_back(y.factor * table.at(y.column)[row]);
      }
      if (!series.x.empty()) plot.series.push_back(std::move(series));
    }
  }
  return plot;
}

std::string ring_results(const Runs& runs) {
  HtmlTable table{"oedometer-table",
                  "",
                  {"Test", "Cycle", "Strain at preload", "Loading modulus", "Unloading modulus", "Loop loss",
                   "Residual strain"},
                  {},
                  false};
  HtmlTable first{
      "first-loading-table", "", {"Test", "Modulus 100–600 kPa", "Unloading over loading"}, {}, false};
  for (const RunData& run : runs)
    for (const TestName& test : tests_of(run)) {
      const std::string label = escape_html(label_of(runs, run, test));
      for (int cycle = 1; cycle <= rig_of(run).cycles; ++cycle) {
        const std::string of = fmt::format("{}cycle_{}_", test.prefix, cycle);
        std::vector<std::string> row{label, fmt::format("{}", cycle)};
        for (const char* name :
             {"strain_at_preload", "loading_modulus", "unloading_modulus", "loss", "residual_strain"})
          row.push_back(cell(run.summary.results, of + name));
        table.rows.push_back(std::move(row));
      }
      const auto ratio = run.summary.results.find(test.prefix + "unloading_over_loading");
      first.rows.push_back(
          {label, cell(run.summary.results, test.prefix + "modulus_100_to_600_kpa"),
           ratio == run.summary.results.end() ? "–" : format_significant(ratio->second.value, 3)});
    }
  return table.html() + "<h3>First loading</h3>\n" + first.html() +
         "<p class=\"note\">Stress: force on the upper plate over the ring’s area. Strain: compression over "
         "the height "
         "as placed, of grains over that under the plate as it first bears the seating force. Moduli: "
         "secants between 10 % and 90 % of the cycle’s largest stress. Loop loss: share "
         "of the "
         "loading’s work that unloading does not give back. – where a branch was not passed.</p>\n";
}

std::string ring_curves(const Runs& runs) {
  return svg_plot(plot_of_tests(runs, "curve-stress-strain", "axial strain [%]", {"strain", 100},
                                "axial stress [kPa]", {"stress", 1e-3}, false, Rows::all)) +
         svg_plot(plot_of_tests(runs, "curve-force", "compression [mm]", {"compression", 1e3},
                                "force on the plate [N]", {"force", 1}, false, Rows::all)) +
         svg_plot(plot_of_tests(runs, "curve-inertia", "time since the test began [ms]", {"test_time", 1e3},
                                "force not balanced [N]", {"inertia_force", 1}, false, Rows::all)) +
         "<p class=\"note\">Force not balanced: of plates, ring and weight; what accelerates the specimen. "
         "It must stay "
         "small beside the force on the plate.</p>\n";
}

std::string box_results(const Runs& runs) {
  HtmlTable table{"shear-table",
                  "",
                  {"Test", "Yield", "On the remaining area", "Stress on the plane", "Largest shear stress",
                   "at strain", "Plate rose"},
                  {},
                  false};
  HtmlTable line{"line-table", "", {"Run", "Cohesion", "Friction angle", "Largest misfit"}, {}, false};
  for (const RunData& run : runs) {
    for (const TestName& test : tests_of(run)) {
      std::vector<std::string> row{escape_html(label_of(runs, run, test))};
      for (const char* name : {"yield_stress", "yield_stress_on_remaining_area", "stress_on_plane",
                               "peak_stress", "strain_at_peak", "height_change"})
        row.push_back(cell(run.summary.results, test.prefix + name));
      table.rows.push_back(std::move(row));
    }
    for (const auto& [prefix, what] : {std::pair{"", ""}, {"remaining_area_", ", on the remaining area"}})
      line.rows.push_back({escape_html(run.label) + what,
                           cell(run.summary.results, std::string(prefix) + "cohesion"),
                           cell(run.summary.results, std::string(prefix) + "friction_angle"),
                           cell(run.summary.results, std::string(prefix) + "line_misfit")});
  }
  std::string note;
  if (!runs.empty())
    note = fmt::format(
        "Yield: mean over the last 0.5 % of strain before {:g} %, strain being displacement over the "
        "specimen’s {}. "
        "Stresses are forces over the box’s area as built, as ASTM D3080 has them; on the remaining area: of "
        "both "
        "shear and normal load over the part of the plane where the halves still face each other.",
        100 * rig_of(runs.front()).yield_strain,
        rig_of(runs.front()).strain_basis == ShearStrainBasis::length ? "length" : "height");
  return table.html() + "<h3>Mohr-Coulomb line through the yields</h3>\n" + line.html() +
         "<p class=\"note\">" + note + "</p>\n";
}

/// Yields as crosses, and the line through them.
std::string mohr_coulomb_plot(const Runs& runs) {
  Plot plot{"curve-mohr-coulomb", "normal stress [kPa]", "shear stress at yield [kPa]", {}, {}, {}};
  double widest = 0;
  for (const RunData& run : runs)
    for (const double stress : rig_of(run).normal_stresses) widest = std::max(widest, 1.15e-3 * stress);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto& results = runs[i].summary.results;
    const std::string style = fmt::format("c{}", i % 6);
    const auto names = tests_of(runs[i]);
    double highest = 0;
    bool first = true;
    for (const TestName& name : names)
      if (const auto found = results.find(name.prefix + "yield_stress"); found != results.end())
        highest = std::max(highest, 1e-3 * found->second.value);
    for (std::size_t test = 0; test < names.size(); ++test) {
      const auto found = results.find(names[test].prefix + "yield_stress");
      if (found == results.end()) continue;
      const double x = 1e-3 * rig_of(runs[i]).normal_stresses[test], y = 1e-3 * found->second.value;
      const double dx = 0.01 * widest, dy = 0.03 * highest;
      Series cross{first ? runs[i].label + ", yields" : "", style, {}, {}, false, false};
      first = false;
      cross.x = {x - dx, x + dx, x, x, x};  // by way of the middle
      cross.y = {y, y, y, y - dy, y + dy};
      plot.series.push_back(std::move(cross));
    }
    const auto cohesion = results.find("cohesion"), angle = results.find("friction_angle");
    if (cohesion == results.end() || angle == results.end()) continue;
    const double c = 1e-3 * cohesion->second.value,
                 slope = std::tan(angle->second.value * std::numbers::pi / 180);
    plot.series.push_back(
        {runs[i].label + ", line", style, {0, widest}, {c, c + slope * widest}, false, true});
  }
  plot.x_range = {0, widest};
  return svg_plot(plot);
}

std::string box_curves(const Runs& runs) {
  return svg_plot(plot_of_tests(runs, "curve-shear", "displacement of the lower half [mm]",
                                {"displacement", 1e3}, "shear stress [kPa]", {"shear_stress", 1e-3}, false,
                                Rows::shearing)) +
         mohr_coulomb_plot(runs) +
         svg_plot(plot_of_tests(runs, "curve-height", "displacement of the lower half [mm]",
                                {"displacement", 1e3}, "rise of the upper plate [mm]", {"height_change", 1e3},
                                false, Rows::shearing));
}

std::string pull_results(const Runs& runs) {
  HtmlTable table{"pull-out-table",
                  "",
                  {"Test", "Largest force", "at", "Steady force", "Stress of platens", "Pressure on strand",
                   "F / 2μσwL, platens", "F / 2μσwL, strand"},
                  {},
                  false};
  for (const RunData& run : runs)
    for (const TestName& test : tests_of(run)) {
      std::vector<std::string> row{escape_html(label_of(runs, run, test))};
      for (const char* name :
           {"peak_force", "displacement_at_peak", "steady_force", "normal_stress", "strand_pressure"})
        row.push_back(cell(run.summary.results, test.prefix + name));
      for (const char* name : {"force_over_strip_formula", "force_over_friction_on_strand"}) {
        const auto found = run.summary.results.find(test.prefix + name);
        row.push_back(found == run.summary.results.end() ? "–" : format_significant(found->second.value, 3));
      }
      table.rows.push_back(std::move(row));
    }
  return table.html() +
         "<p class=\"note\">Steady: mean over the second half of the travel. The last two columns compare "
         "with friction "
         "on both faces of a strip, F = 2 μ σ w L, with the stress between the platens for σ, and with the "
         "normal forces that really press on the strand; L is what is still embedded.</p>\n";
}

std::string pull_curves(const Runs& runs) {
  return svg_plot(plot_of_tests(runs, "curve-pull", "displacement of the grip [mm]", {"displacement", 1e3},
                                "force [N]", {"force", 1}, false, Rows::drawing)) +
         svg_plot(plot_of_tests(runs, "curve-strand-pressure", "displacement of the grip [mm]",
                                {"displacement", 1e3}, "pressure on the strand [kPa]",
                                {"strand_pressure", 1e-3}, false, Rows::drawing)) +
         svg_plot(plot_of_tests(runs, "curve-platens", "time since the test began [ms]", {"test_time", 1e3},
                                "stress of the platens [kPa]", {"normal_stress", 1e-3}, false, Rows::all));
}

/// Terms of the ledger that a specimen has, over the time of each test.
std::string energies(const Runs& runs) {
  const auto of = [&](const char* id, const char* label, const char* column, double factor) {
    return svg_plot(plot_of_tests(runs, id, "time since the test began [ms]", {"test_time", 1e3}, label,
                                  {column, factor}, true, Rows::all));
  };
  return of("energy-work", "work of plate, box or grip [J]", "external_work", 1) +
         of("energy-stored", "stored in the infill [J]", "stored_infill", 1) +
         of("energy-dissipated", "dissipated in the infill [J]", "dissipated_infill", 1) +
         of("energy-error", "energy error [%]", "error", 100);
}

}  // namespace

bool all_of_specimens(const Runs& runs) {
  return !runs.empty() && std::all_of(runs.begin(), runs.end(), [](const RunData& run) {
    return run.scene && run.scene->rig.is_specimen();
  });
}

std::string describe_specimen_rig(const Scene& scene) {
  const SpecimenRig& rig = scene.rig.specimen;
  const std::string faster =
      rig.speed_factor > 1 ? fmt::format(", run {} times faster", format_input(rig.speed_factor)) : "";
  const std::string& name = scene.materials.at(static_cast<std::size_t>(rig.material)).name;
  if (scene.rig.type == "oedometer")
    return fmt::format("Oedometer: {} in a ring of {} mm, {} mm high; plate at {} mm/s{}; {} cycles",
                       escape_html(name), format_input(1e3 * rig.diameter), format_input(1e3 * rig.height),
                       format_input(1e3 * rig.speed), faster, rig.cycles);
  if (scene.rig.has_strand()) {
    std::string speeds;
    for (const double speed : rig.speeds) speeds += (speeds.empty() ? "" : ", ") + format_input(1e3 * speed);
    return fmt::format(
        "Pull-out: strand of {} mm in {}, box of {} × {} mm, {} mm high, platens at {} kPa; grip at {} "
        "mm/s{}",
        format_input(1e3 * scene.turf.carpet.strand_width), escape_html(name),
        format_input(1e3 * rig.size[0]), format_input(1e3 * rig.size[1]), format_input(1e3 * rig.height),
        format_input(1e-3 * rig.normal_stress), speeds,
        rig.run_speed > 0 ? fmt::format(", run at {} mm/s", format_input(1e3 * rig.run_speed)) : "");
  }
  return fmt::format("Direct shear: {} in a box of {} × {} mm, {} mm high; lower half at {} mm/s{}",
                     escape_html(name), format_input(1e3 * rig.size[0]), format_input(1e3 * rig.size[1]),
                     format_input(1e3 * rig.height), format_input(1e3 * rig.speed), faster);
}

std::string report_specimen(const Runs& runs) {
  std::string text;
  const Runs rings = of_type(runs, "oedometer"), boxes = of_type(runs, "direct_shear"),
             pulls = of_type(runs, "pull_out");
  if (!rings.empty()) {
    text += html_section("results", "Compression", ring_results(rings));
    text += html_section("curves", "Stress against strain", ring_curves(rings));
  }
  if (!boxes.empty()) {
    text += html_section("shear-results", "Direct shear", box_results(boxes));
    text += html_section("shear-curves", "Shear stress against displacement", box_curves(boxes));
  }
  if (!pulls.empty()) {
    text += html_section("pull-out-results", "Pull-out", pull_results(pulls));
    text += html_section("pull-out-curves", "Force against displacement", pull_curves(pulls));
  }
  return text + html_section("energy", "Energy balance", energies(runs));
}

}  // namespace tuft::app

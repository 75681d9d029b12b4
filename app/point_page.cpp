#include "app/point_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "app/svg_plot.h"
#include "sph_infill/path_results.h"

namespace tuft::app {
namespace {

using sph::PathRow;
using Value = std::function<double(const PathRow&)>;

constexpr std::string_view kind_words[] = {"isotropic",  "oedometric",   "triaxial",         "simple shear",
                                           "pure shear", "direct shear", "velocity gradient"};

const PathRow& last_row(const PointRun& run) {
  return run.record.rows.back();
}

/// One curve a segment, each from where the one before ended.
Plot plot_of_path(const PointRun& run, const std::string& id, const std::string& x_label,
                  const std::string& y_label, const Value& x, const Value& y) {
  Plot plot{id, x_label, y_label, {}, {}, {}};
  const auto& rows = run.record.rows;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (plot.series.empty() || rows[k].segment != rows[k - 1].segment) {
      const PathSegment& segment = run.test.segments[rows[k].segment - 1];
      const PathRow& start = rows[segment.fresh && rows[k].segment > 1 ? k : k - 1];
      plot.series.push_back(
          {fmt::format("{} {}", rows[k].segment, kind_words[static_cast<std::size_t>(segment.kind)]),
           fmt::format("c{}", (rows[k].segment - 1) % 6),
           {x(start)},
           {y(start)},
           false,
           false});
    }
    plot.series.back().x.push_back(x(rows[k]));
    plot.series.back().y.push_back(y(rows[k]));
  }
  return plot;
}

double largest(const PointRun& run, const Value& value) {
  double most = 0;
  for (const PathRow& row : run.record.rows) most = std::max(most, value(row));
  return most;
}

Plot compression_plot(const PointRun& run) {
  const Value e = [](const PathRow&r) { return 100 * r.state.compression; },
              p = [](const PathRow&r) { return 1e-3 * r.state.pressure; };
  Plot plot = plot_of_path(run, "curve-compression", "compression ln(ρ/ρ0) [%]", "pressure [kPa]", e, p);
  Series virgin{"first loading P(e)", "e10", {}, {}, true, true};
  const double end = 0.01 * largest(run, e);
  for (int k = 0; k <= 200 && end > 0; ++k) {
    virgin.x.push_back(0.5 * k * end);
    virgin.y.push_back(1e-3 * run.law.virgin(end * k / 200).value);
  }
  plot.series.push_back(std::move(virgin));
  return plot;
}

/// q at yield over pressure, for one state.
Series yield_curve(const PointRun& run, const PathRow& row, double low, double high, const std::string& label,
                   bool dashed) {
  Series curve{label, "e10", {}, {}, true, dashed};
  for (int k = 0; k <= 200; ++k) {
    const double p = low + (high - low) * k / 200;
    curve.x.push_back(1e-3 * p);
    curve.y.push_back(1e-3 * std::sqrt(3 * sph::yield_limit(run.law, row.state, p)));
  }
  return curve;
}

Plot stress_path_plot(const PointRun& run) {
  Plot plot = plot_of_path(
      run, "curve-yield", "pressure p [kPa]", "q = √(3 J2) [kPa]",
      [](const PathRow& r) { return 1e-3 * r.state.pressure; },
      [](const PathRow& r) { return 1e-3 * r.q(); });
  const double high = 1.1 * largest(run, [](const PathRow& r) { return r.state.pressure; });
  const double low = -largest(run, [](const PathRow& r) { return -r.state.pressure; });
  if (high > low) {
    plot.series.push_back(yield_curve(run, run.record.rows.front(), low, high, "yield at the start", true));
    plot.series.push_back(
        yield_curve(run, last_row(run), low, high, "yield at the end, without rate", false));
  }
  return plot;
}

bool is_direct(const PointRun& run, const PathRow& row) {
  return row.segment > 0 && run.test.segments[row.segment - 1].kind == PathKind::direct_shear;
}

bool has_shear(const PointRun& run) {
  return largest(run, [](const PathRow& r) { return std::abs(r.strain.xy) + std::abs(r.strain.zx); }) > 0;
}

std::string curves(const PointRun& run) {
  std::string text = svg_plot(compression_plot(run)) + svg_plot(stress_path_plot(run));
  text += svg_plot(plot_of_path(
      run, "curve-axial", "strain along z, compression [%]", "stress along z, compression [kPa]",
      [](const PathRow& r) { return -100 * r.strain.zz; },
      [](const PathRow& r) { return -1e-3 * r.stress().zz; }));
  if (has_shear(run))
    text += svg_plot(plot_of_path(
        run, "curve-shear", "shear strain [%]", "shear stress [kPa]",
        [&](const PathRow& r) { return 200 * (is_direct(run, r) ? r.strain.zx : r.strain.xy); },
        [&](const PathRow& r) { return 1e-3 * sph::shear_stress(run.test, r); }));
  return html_section(
      "curves", "Paths",
      text +
          "<p class=\"note\">Strains are logarithmic, shear strain is the tangent (twice the tensor's). "
          "Compression is positive. The yield surfaces are those of the state at the start and at the end "
          "of the test, for any pressure.</p>\n");
}

std::string state_curves(const PointRun& run) {
  const auto along = [](const PathRow& r) { return r.time; };
  std::string text;
  text += svg_plot(plot_of_path(run, "curve-modulus", "time [s]", "unloading modulus K [MPa]", along,
                                [](const PathRow& r) { return 1e-6 * r.state.bulk_modulus; }));
  text += svg_plot(plot_of_path(run, "curve-plastic", "time [s]", "plastic compression [%]", along,
                                [](const PathRow& r) { return 100 * r.state.plastic_compression; }));
  if (run.law.effects.strength_softening)
    text += svg_plot(plot_of_path(run, "curve-lost", "time [s]", "lost share of strength [%]", along,
                                  [](const PathRow& r) { return 100 * r.state.lost_strength; }));
  return html_section("state", "State", text);
}

std::string energy_curves(const PointRun& run) {
  Plot plot{"curve-energy", "time [s]", "energy [kJ/m³]", {}, {}, {}};
  const auto add = [&](const std::string& label, const std::string& style, const Value& value) {
    Series series{label, style, {}, {}, false, false};
    for (const PathRow& row : run.record.rows) {
      series.x.push_back(row.time);
      series.y.push_back(1e-3 * value(row));
    }
    plot.series.push_back(std::move(series));
  };
  add("work σ : D", "c0", [](const PathRow& r) { return r.work; });
  add("dissipated", "c1", [](const PathRow& r) { return r.dissipated; });
  add("stored in the state", "c2", [](const PathRow& r) { return r.stored; });
  std::string note = fmt::format(
      "Per volume of the reference state. Work − dissipated − stored is at most {} "
      "of the sum of all works",
      format_percent(energy_gap(run)));
  note +=
      run.law.effects.shear_energy
          ? ": an error of the step, and of taking the volume as constant within what is stored."
          : ": an error of the step, and what the deviator gains and loses with the shear modulus (effect "
            "shear_energy off).";
  return html_section("energy", "Energy", svg_plot(plot) + "<p class=\"note\">" + note + "</p>\n");
}

std::string measures_table(const PointRun& run) {
  if (run.test.measures.empty()) return "";
  HtmlTable table{"measures-table", "", {"Measure", ""}, {}, false};
  const auto results = sph::path_results(run.test, run.record);
  for (const PointMeasure& measure : run.test.measures) {
    const auto found = std::find_if(results.begin(), results.end(), [&](const sph::PathResult& result) {
      return result.name == measure.name;
    });
    table.rows.push_back({escape_html(measure.name), found == results.end()
                                                         ? "not reached"
                                                         : format_quantity(found->value, found->unit)});
  }
  return table.html();
}

std::string segments_table(const PointRun& run) {
  HtmlTable table{"segments-table",
                  "",
                  {"Segment", "Ends at", "Compression", "Pressure", "q", "Stress along z", "Shear stress",
                   "K", "Yields at q"},
                  {},
                  false};
  const auto& rows = run.record.rows;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k + 1 < rows.size() && rows[k + 1].segment == rows[k].segment) continue;
    const PathRow& r = rows[k];
    std::string name = "start";
    std::string end = "–";
    if (r.segment > 0) {
      const PathSegment& segment = run.test.segments[r.segment - 1];
      name = fmt::format("<span class=\"key c{}\"></span>{} {}", (r.segment - 1) % 6, r.segment,
                         kind_words[static_cast<std::size_t>(segment.kind)]);
      if (segment.strain) end = fmt::format("strain {}", format_percent(*segment.strain));
      if (segment.stress) end = format_quantity(*segment.stress, "Pa");
      if (segment.duration) end = format_quantity(*segment.duration, "s");
    }
    table.rows.push_back(
        {name, end, format_percent(r.state.compression), format_quantity(r.state.pressure, "Pa"),
         format_quantity(r.q(), "Pa"), format_quantity(-r.stress().zz, "Pa"),
         format_quantity(sph::shear_stress(run.test, r), "Pa"), format_quantity(r.state.bulk_modulus, "Pa"),
         format_quantity(std::sqrt(3.0) * r.yield, "Pa")});
  }
  return html_section("results", "Ends of the segments", table.html() + measures_table(run));
}

std::string effects_table(const PointRun& run) {
  HtmlTable table{"effects-table", "", {"Effect", "", "Why"}, {}, true};
  for (const EffectDecision& effect : run.effects)
    table.rows.push_back({escape_html(readable_name(effect.name)),
                          effect.on ? "<b>on</b>" : "<span class=\"off\">off</span>",
                          escape_html(effect.why)});
  return html_section("effects", "Effects", table.html());
}

std::string head(const PointRun& run) {
  const Material& material = run.test.tested();
  std::string text =
      fmt::format("<h1>{}</h1>\n<dl>\n<dt>Material</dt><dd>{}, {} kg/m³ in the reference state</dd>\n",
                  escape_html(run.test.name), escape_html(material.name), format_input(run.law.density));
  text += fmt::format("<dt>Test</dt><dd>one material point, {} segments, steps of at most {} strain</dd>\n",
                      run.test.segments.size(), format_input(run.test.step));
  if (run.test.residual_compression > 0)
    text += fmt::format("<dt>Before</dt><dd>pressed to a compression of {} and released to {}</dd>\n",
                        format_percent(run.record.rows.front().state.largest_compression),
                        format_percent(run.test.residual_compression));
  text +=
      fmt::format("<dt>State</dt><dd><span class=\"state {0}\">{0}</span> {1} updates in {2}</dd>\n</dl>\n",
                  run.error.empty() ? "completed" : "failed", format_count(run.record.steps),
                  format_duration(run.wall_seconds));
  if (!run.error.empty()) text += fmt::format("<p class=\"error\">{}</p>\n", escape_html(run.error));
  return text;
}

}  // namespace

double energy_gap(const PointRun& run) {
  return run.record.work_size > 0 ? run.record.largest_energy_gap / run.record.work_size : 0;
}

std::string point_page(const PointRun& run) {
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
             "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{} · "
             "tuft</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n",
             escape_html(run.test.name), report_style()) +
         head(run) + curves(run) + segments_table(run) + state_curves(run) + energy_curves(run) +
         effects_table(run) +
         "<p class=\"note\">All inputs with every default written out are in <code>point.toml</code> beside "
         "this page, all rows in <code>path.csv</code>; where each material number comes from is said beside "
         "it in the material files.</p>\n</main>\n<script>" +
         report_script() + "</script>\n</body>\n</html>\n";
}

}  // namespace tuft::app

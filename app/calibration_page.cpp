#include "app/calibration_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/calibration_summary.h"
#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "app/svg_plot.h"

namespace tuft::app {
namespace {

using studies::CalibrationResult;
using studies::Evaluation;
using studies::Identifiability;
using studies::ModelCurve;
using studies::Parameter;
using studies::Problem;
using studies::Target;
using studies::TargetForm;

constexpr const char* chart_style = R"css(
#target-chart .track { stroke:var(--rule); } #target-chart .wanted { fill:var(--c2); opacity:.28; }
#target-chart .mark { stroke-width:2; } #target-chart .start { fill:var(--page); stroke:var(--soft); }
#targets-table td,#parameters-table td { white-space:nowrap; padding-left:16px; }
#target-chart .met { fill:var(--good); stroke:var(--good); } #target-chart .missed { fill:var(--bad); stroke:var(--bad); }
)css";

std::string met_mark(bool met) {
  return met ? "<span class=\"good\">met</span>" : "<span class=\"bad\">not met</span>";
}

std::string head(const Problem& problem, const CalibrationResult& result) {
  std::string text = fmt::format("<h1>Calibration {}</h1>\n<dl>\n<dt>File</dt><dd>{}</dd>\n",
                                 escape_html(problem.file.name), escape_html(problem.file.file));
  text += fmt::format(
      "<dt>State</dt><dd><span class=\"state {0}\">{0}</span> {1} evaluations in {2}; the search ended: "
      "{3}</dd>\n",
      result.status, format_count(result.evaluations), format_duration(result.wall_seconds),
      escape_html(result.end_reason));
  text += fmt::format(
      "<dt>Misfit</dt><dd>{} at the start, {} fitted, of which {} is distance from the start</dd>\n",
      format_significant(result.start.misfit), format_significant(result.fitted.misfit),
      format_significant(result.fitted.misfit - result.fitted.target_misfit));
  text += fmt::format("<dt>Outcome</dt><dd>{}</dd>\n</dl>\n", escape_html(verdict(problem, result)));
  if (result.failed > 0)
    text += fmt::format(
        "<p class=\"error\">{} of {} evaluations failed and counted as a misfit of {} a target.</p>\n",
        result.failed, result.evaluations, format_input(problem.file.optimiser.failure_misfit));
  return text;
}

std::string targets_section(const Problem& problem, const CalibrationResult& result) {
  HtmlTable table{"targets-table", "", {"Target", "Wanted", "Start", "Fit", "", "Misfit"}, {}, false};
  HtmlTable sources{"sources-table", "", {"Target", "Weight", "Where it comes from"}, {}, true};
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    const Target& target = problem.targets[t];
    const auto &start = result.start.targets[t], &fitted = result.fitted.targets[t];
    table.rows.push_back(
        {escape_html(target.name()), wanted(target), measured(target, start), measured(target, fitted),
         met_mark(studies::is_inside(target, fitted)),
         fmt::format("{} → {}", format_significant(start.misfit, 2), format_significant(fitted.misfit, 2))});
    sources.rows.push_back(
        {escape_html(target.name()), format_input(target.weight), escape_html(target.provenance)});
  }
  return html_section("targets", "Targets", target_chart(problem, result) + table.html() + sources.html());
}

std::string determined_text(const CalibrationResult& result, std::size_t i) {
  if (!result.identifiability) return "not measured";
  const Identifiability& found = *result.identifiability;
  if (!std::isfinite(found.alone[i])) return "<span class=\"bad\">no target sees it</span>";
  if (!std::isfinite(found.together[i])) return "<span class=\"bad\">only with others</span>";
  const std::string off = format_percent(found.together[i], 2);
  if (found.together[i] > 1) return "<span class=\"bad\">not, it could be anywhere</span>";
  return found.together[i] > studies::ill_determined
             ? fmt::format("<span class=\"bad\">poorly, ± {} of its range</span>", off)
             : fmt::format("<span class=\"good\">± {} of its range</span>", off);
}

/// Keys; with the material where there are several.
std::string parameter_name(const Problem& problem, const Parameter& parameter) {
  return escape_html(problem.materials.size() == 1 ? parameter.key : parameter.name());
}

std::string parameters_section(const Problem& problem, const CalibrationResult& result) {
  HtmlTable table{"parameters-table",
                  "",
                  {"Parameter", "Start", "Fit", "Bounds", "", "Determined by the targets"},
                  {},
                  false};
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    const Parameter& p = problem.parameters[i];
    const std::string bound = bound_text(result, i);
    table.rows.push_back({parameter_name(problem, p), parameter_text(p, result.start.values[i]),
                          parameter_text(p, result.fitted.values[i]), bounds_text(p),
                          bound.empty() ? "" : "<span class=\"bad\">" + bound + "</span>",
                          determined_text(result, i)});
  }
  return html_section(
      "parameters", "Parameters",
      (problem.materials.size() == 1
           ? fmt::format("<p>Of material {}.</p>\n", escape_html(problem.materials[0].name))
           : "") +
          table.html() +
          "<p class=\"note\">The last column takes each target as known to one tolerance (a range: to half "
          "of its "
          "width) and says how far the parameter could then be off, the others free, as a share of its "
          "range between the bounds.</p>\n");
}

std::string search_section(const Problem& problem, const CalibrationResult& result) {
  Plot plot{"search-plot", "evaluation [1]", "misfit, decimal logarithm [1]", {}, {}, {}};
  Series each{"each evaluation", "c0", {}, {}, true, false},
      least{"least so far", "c0", {}, {}, false, false};
  const auto logarithm = [](double misfit) { return std::log10(std::max(misfit, 1e-12)); };
  for (std::size_t k = 0; k < result.search.size(); ++k) {
    for (Series* series : {&each, &least}) series->x.push_back(static_cast<double>(k + 1));
    each.y.push_back(logarithm(result.search[k].misfit));
    least.y.push_back(logarithm(result.search[k].least));
  }
  plot.series = {each, least};
  static constexpr const char* algorithms[] = {"BOBYQA", "SBPLX", "COBYLA", "CRS2, then BOBYQA",
                                               "DIRECT-L, then BOBYQA"};
  return html_section(
      "search", "Search",
      svg_plot(plot) +
          fmt::format("<p class=\"note\">{} (NLopt), parameters scaled to [0, 1] between their bounds. The "
                      "misfit is that of the targets and {} times the squared distance from the start.</p>\n",
                      algorithms[static_cast<std::size_t>(problem.file.optimiser.algorithm)],
                      format_input(problem.file.regularisation)));
}

/// Factor and unit in which an axis is drawn.
DisplayUnit axis_unit(const std::string& unit) {
  if (unit == "1") return {100, "%"};
  return unit == "Pa" ? DisplayUnit{1e-3, "kPa"} : DisplayUnit{1, unit};
}

void add_curve(Plot& plot, const ModelCurve& curve, const std::string& label, const std::string& style,
               bool dashed) {
  const double fx = axis_unit(curve.x_unit).factor, fy = axis_unit(curve.y_unit).factor;
  Series series{label, style, {}, {}, false, dashed};
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    series.x.push_back(fx * curve.x[i]);
    series.y.push_back(fy * curve.y[i]);
  }
  plot.series.push_back(std::move(series));
}

/// Curves of one model, those with the same axes in one plot.
std::string model_plots(const Problem& problem, const CalibrationResult& result, std::size_t model) {
  if (result.start.outcomes.empty() || result.fitted.outcomes.empty()) return "";
  std::vector<Plot> plots;
  const auto plot_for = [&](const ModelCurve& curve) -> Plot& {
    const std::string x = fmt::format("{} [{}]", curve.x_label, axis_unit(curve.x_unit).unit),
                      y = fmt::format("{} [{}]", curve.y_label, axis_unit(curve.y_unit).unit);
    for (Plot& plot : plots)
      if (plot.x_label == x && plot.y_label == y) return plot;
    plots.push_back({fmt::format("curves-{}-{}", model, plots.size()), x, y, {}, {}, {}});
    return plots.back();
  };
  std::size_t colour = 0;
  for (const ModelCurve& curve : result.fitted.outcomes[model].curves) {
    Plot& plot = plot_for(curve);
    const std::string style = fmt::format("c{}", colour++ % 6);
    for (const ModelCurve& before : result.start.outcomes[model].curves)
      if (before.name == curve.name) add_curve(plot, before, "", style, true);
    add_curve(plot, curve, curve.name, style, false);
    for (const Target& target : problem.targets)
      if (target.form == TargetForm::curve && target.model == model && target.quantity == curve.name)
        add_curve(plot, {"", target.x_unit, target.unit, "", "", target.x, target.y},
                  "target of " + curve.name, "e0", false);
  }
  std::string text;
  for (const Plot& plot : plots) text += svg_plot(plot);
  return text;
}

std::string curves_section(const Problem& problem, const CalibrationResult& result) {
  std::string text;
  for (std::size_t m = 0; m < problem.models.size(); ++m)
    text +=
        fmt::format("<h3>{} ({})</h3>\n", escape_html(problem.model_names[m]), problem.models[m]->kind()) +
        model_plots(problem, result, m);
  return html_section("curves", "Curves of the models",
                      text + "<p class=\"note\">Solid: the fit. Dashed: the start.</p>\n");
}

/// The combination that the targets see least, in words.
std::string weakest_text(const Problem& problem, const Identifiability& found) {
  std::string parts;
  const std::vector<std::string> names = short_names(problem);
  for (Eigen::Index i = 0; i < found.weakest.size(); ++i) {
    if (std::abs(found.weakest[i]) < 0.1) continue;
    parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", format_significant(found.weakest[i], 2),
                         names[static_cast<std::size_t>(i)]);
  }
  if (!std::isfinite(found.weakest_change))
    return fmt::format(
        "The targets do not see a change of the parameters in the proportions {}: there the start "
        "decides, through the regularisation.",
        escape_html(parts));
  return fmt::format(
      "Worst seen is a change of the parameters in the proportions {}: the targets change by one tolerance "
      "only when it is {} of the range.",
      escape_html(parts), format_percent(found.weakest_change, 2));
}

std::vector<std::string> parameter_names(const Problem& problem, const std::string& first) {
  std::vector<std::string> names{first};
  for (const std::string& name : short_names(problem)) names.push_back(escape_html(name));
  return names;
}

std::string sensitivity_table(const Problem& problem, const Identifiability& found) {
  HtmlTable table{"sensitivity-table", "", parameter_names(problem, "Target"), {}, false};
  Eigen::Index row = 0;
  for (const Target& target : problem.targets) {
    const auto rows = target.form == TargetForm::curve ? static_cast<Eigen::Index>(target.x.size()) : 1;
    std::vector<std::string> cells{escape_html(target.name())};
    for (Eigen::Index i = 0; i < found.sensitivity.cols(); ++i) {
      double sum = 0;
      for (Eigen::Index k = row; k < row + rows; ++k)
        sum += found.sensitivity(k, i) * found.sensitivity(k, i);
      cells.push_back(format_significant(rows == 1 ? found.sensitivity(row, i) : std::sqrt(sum), 2));
    }
    table.rows.push_back(std::move(cells));
    row += rows;
  }
  return "<h3>Change of each target, in tolerances, over the whole range of a parameter</h3>\n" +
         table.html();
}

std::string correlation_table(const Problem& problem, const Identifiability& found) {
  HtmlTable table{"correlation-table", "", parameter_names(problem, ""), {}, false};
  const std::vector<std::string> names = short_names(problem);
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    std::vector<std::string> cells{escape_html(names[i])};
    for (std::size_t j = 0; j < problem.parameters.size(); ++j)
      cells.push_back(fmt::format(
          "{:.2f}", found.correlation(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j))));
    table.rows.push_back(std::move(cells));
  }
  const char* title = found.determined ? "Correlation of the parameters under targets known to one tolerance"
                                       : "Correlation under such targets and the regularisation";
  return fmt::format("<h3>{}</h3>\n", title) + table.html();
}

std::string identifiability_section(const Problem& problem, const CalibrationResult& result) {
  if (!result.identifiability)
    return html_section("identifiability", "What the targets determine",
                        fmt::format("<p class=\"missing\">Not measured: {}.</p>\n",
                                    escape_html(result.not_identified.empty() ? "the calibration was stopped"
                                                                              : result.not_identified)));
  const Identifiability& found = *result.identifiability;
  return html_section(
      "identifiability", "What the targets determine",
      fmt::format("<p>{}</p>\n", weakest_text(problem, found)) + sensitivity_table(problem, found) +
          correlation_table(problem, found) +
          fmt::format(
              "<p class=\"note\">Central differences at the fit, steps of {} of a parameter's range. "
              "This is local: it says nothing of other fits far away. Inside a range a target does not "
              "pull at all; it is counted here as if its middle were known to half its "
              "width.</p>\n",
              format_percent(studies::difference_step)));
}

std::string cost_section(const Problem& problem, const CalibrationResult& result) {
  HtmlTable table{"cost-table", "", {"Model", "Kind", "One evaluation"}, {}, false};
  for (std::size_t m = 0; m < problem.models.size(); ++m)
    table.rows.push_back({escape_html(problem.model_names[m]), problem.models[m]->kind(),
                          format_duration(result.seconds_per_model[m])});
  return html_section(
      "cost", "Cost",
      table.html() +
          fmt::format("<p class=\"note\">{} evaluations, {} of them there from an earlier run into this "
                      "folder; {} in all now.</p>\n",
                      format_count(result.evaluations), format_count(result.reused),
                      format_duration(result.wall_seconds)));
}

std::string failures_section(const CalibrationResult& result) {
  if (result.errors.empty()) return "";
  std::string items;
  for (const std::string& error : result.errors)
    items += fmt::format("<p class=\"error\">{}</p>\n", escape_html(error));
  return html_section("failures", "Why evaluations failed", items);
}

}  // namespace

std::string calibration_page(const Problem& problem, const CalibrationResult& result) {
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
             "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{} · "
             "tuft</title>\n<style>{}{}</style>\n</head>\n<body>\n<main>\n",
             escape_html(problem.file.name), report_style(), chart_style) +
         head(problem, result) + targets_section(problem, result) + parameters_section(problem, result) +
         curves_section(problem, result) + search_section(problem, result) +
         identifiability_section(problem, result) + cost_section(problem, result) + failures_section(result) +
         "<p class=\"note\">The fitted materials are the files in <code>materials</code> beside this page, "
         "complete "
         "and ready to be used; each changed number says so. All evaluations are in "
         "<code>evaluations.csv</code>.</p>\n</main>\n<script>" +
         report_script() + "</script>\n</body>\n</html>\n";
}

}  // namespace tuft::app

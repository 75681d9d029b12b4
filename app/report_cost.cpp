/// What the run cost, and where.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "core/timers.h"

namespace tuft::app {
namespace {

double seconds_of(const rigs::RunSummary& summary, const std::string& phase) {
  const auto found = summary.cost.find(phase);
  return found == summary.cost.end() ? 0 : found->second;
}

/// Phases in the program's order, then any that it did not know when this was built.
std::vector<std::string> phases_of(const Runs& runs) {
  std::vector<std::string> order(phase_names.begin(), phase_names.end());
  for (const RunData& run : runs)
    for (const auto& [phase, seconds] : run.summary.cost)
      if (std::find(order.begin(), order.end(), phase) == order.end()) order.push_back(phase);
  std::erase_if(order, [&](const std::string& phase) {
    return std::all_of(runs.begin(), runs.end(),
                       [&](const RunData& run) { return seconds_of(run.summary, phase) <= 0; });
  });
  return order;
}

/// A phase keeps its colour on every page.
std::size_t colour_of(const std::string& phase) {
  const auto found = std::find(phase_names.begin(), phase_names.end(), phase);
  return found == phase_names.end() ? 0 : static_cast<std::size_t>(found - phase_names.begin());
}

double total_of(const rigs::RunSummary& summary) {
  double total = 0;
  for (const auto& [phase, seconds] : summary.cost) total += seconds;
  return total;
}

/// Share of the coupled step (everything that is done every window) that a group of phases takes.
double step_share(const rigs::RunSummary& summary, const std::vector<std::string>& group) {
  double part = 0, step = 0;
  for (const char* phase : {"search", "contact", "carpet", "infill", "exchange", "waiting", "rig", "ledger"})
    step += seconds_of(summary, phase);
  for (const std::string& phase : group) part += seconds_of(summary, phase);
  return step > 0 ? part / step : 0;
}

std::string phase_table(const Runs& runs, const std::vector<std::string>& phases) {
  HtmlTable table{"cost-table", "", {"Phase"}, {}, false};
  for (std::size_t i = 0; i < runs.size(); ++i) {
    table.header.push_back(run_header("", runs)[i + 1]);
    table.header.push_back("share");
  }
  const auto row_of = [&](const std::string& name, const auto& seconds) {
    std::vector<std::string> row{name};
    for (const RunData& run : runs) {
      const double total = total_of(run.summary);
      if (seconds(run.summary) <= 0) {
        row.insert(row.end(), {"–", "–"});
        continue;
      }
      row.push_back(format_duration(seconds(run.summary)));
      row.push_back(total > 0 ? fmt::format("{:.1f} %", 100 * seconds(run.summary) / total) : not_available);
    }
    return row;
  };
  for (std::size_t p = 0; p < phases.size(); ++p) {
    const std::string name = fmt::format("<span class=\"key p{}\"></span>{}", colour_of(phases[p]),
                                         escape_html(readable_name(phases[p])));
    table.rows.push_back(
        row_of(name, [&](const rigs::RunSummary& summary) { return seconds_of(summary, phases[p]); }));
  }
  table.rows.push_back(
      row_of("<b>Sum of phases</b>", [](const rigs::RunSummary& summary) { return total_of(summary); }));
  return table.html();
}

std::string stacked_bars(const Runs& runs, const std::vector<std::string>& phases) {
  double longest = 0;
  for (const RunData& run : runs) longest = std::max(longest, total_of(run.summary));
  if (longest <= 0) return {};
  constexpr double left = 150, width = 720, bar = 26, gap = 14;
  std::string text = fmt::format(
      "<figure class=\"plot\" id=\"cost-bars\">\n<svg viewBox=\"0 0 1000 {:.0f}\" role=\"img\" "
      "aria-label=\"wall time by phase\">\n",
      static_cast<double>(runs.size()) * (bar + gap) + 6);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const double y = static_cast<double>(i) * (bar + gap) + 4;
    double x = left;
    text += fmt::format("<text class=\"end label\" x=\"{:.0f}\" y=\"{:.1f}\">{}</text>\n", left - 10,
                        y + 0.68 * bar, escape_html(runs[i].label));
    for (std::size_t p = 0; p < phases.size(); ++p) {
      const double length = width * seconds_of(runs[i].summary, phases[p]) / longest;
      if (length < 0.05) continue;
      text += fmt::format(
          "<rect class=\"p{}\" x=\"{:.2f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{:.0f}\"><title>{}: "
          "{}</title></rect>\n",
          colour_of(phases[p]), x, y, length, bar, escape_html(readable_name(phases[p])),
          format_duration(seconds_of(runs[i].summary, phases[p])));
      x += length;
    }
    text += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 8, y + 0.68 * bar,
                        format_duration(total_of(runs[i].summary)));
  }
  return text + "</svg>\n</figure>\n";
}

std::string rates_table(const Runs& runs) {
  HtmlTable table{"rates-table", "", run_header("", runs), {}, false};
  const auto add = [&](const std::string& name, const auto& text) {
    std::vector<std::string> row{name};
    for (const RunData& run : runs) row.push_back(text(run.summary));
    table.rows.push_back(std::move(row));
  };
  using Summary = rigs::RunSummary;
  add("Wall time", [](const Summary& s) { return format_duration(s.wall_s); });
  add("Wall time per simulated ms", [](const Summary& s) {
    return s.simulated_time > 0 ? format_duration(1e-3 * s.wall_s / s.simulated_time) : not_available;
  });
  add("Peak memory", [](const Summary& s) { return format_bytes(s.peak_memory_bytes); });
  add("Particles", [](const Summary& s) { return format_count(s.particles); });
  add("Shell elements", [](const Summary& s) { return format_count(s.shells); });
  add("Coupling windows", [](const Summary& s) { return format_count(s.steps); });
  add("Particle-steps", [](const Summary& s) { return format_rate(s.particle_steps_per_s); });
  add("Element-steps", [](const Summary& s) { return format_rate(s.element_steps_per_s); });
  add("Contact and search, share of step", [](const Summary& s) {
    return format_percent(step_share(s, {"search", "contact"}));
  });
  add("Exchange, share of step",
      [](const Summary& s) { return format_percent(step_share(s, {"exchange"})); });
  add("Waiting, share of step", [](const Summary& s) { return format_percent(step_share(s, {"waiting"})); });
  return table.html();
}

}  // namespace

std::string report_cost(const Runs& runs) {
  const std::vector<std::string> phases = phases_of(runs);
  return html_section(
      "cost", "Cost",
      stacked_bars(runs, phases) + "<div class=\"columns\">\n" + phase_table(runs, phases) +
          rates_table(runs) +
          "</div>\n<p class=\"note\">Wall-clock times on the machine that ran it. In DEM the infill’s "
          "steps are LIGGGHTS’ own; exchange and waiting are what its process of its own adds.</p>\n");
}

}  // namespace tuft::app

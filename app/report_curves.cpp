/// Acceleration, velocity and penetration against time since first touch.
#include <fmt/format.h>

#include <algorithm>

#include "app/html.h"
#include "app/report_sections.h"
#include "app/svg_plot.h"

namespace tuft::app {
namespace {

constexpr double standard_gravity = 9.80665;  // m/s^2, ISO 80000-3
constexpr double release_tolerance = 1e-9;    // s

/// Each curve begins behind the release: the row of that moment still shows the settled turf without the
/// missile.
void add_series(Plot& plot, const Runs& runs, const std::string& column, double factor, bool faint,
                const std::string& suffix) {
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].history.has(column)) continue;
    Series series{runs[i].label + suffix, run_style(runs, i), {}, {}, faint, false};
    const TimeTable& history = runs[i].history;
    for (std::size_t row = 0; row < history.time.size(); ++row) {
      if (history.time[row] <= release_tolerance) continue;
      series.x.push_back(1e3 * (history.time[row] - time_origin(runs[i])));
      series.y.push_back(factor * history.at(column)[row]);
    }
    plot.series.push_back(std::move(series));
  }
}

/// From shortly before the touch to the end of the longest run, ms.
std::pair<double, double> shown_range(const Runs& runs) {
  double end = 1;
  for (const RunData& run : runs)
    if (!run.history.time.empty()) end = std::max(end, 1e3 * (run.history.time.back() - time_origin(run)));
  return {-0.05 * end, end};
}

}  // namespace

std::string report_curves(const Runs& runs) {
  const bool touched =
      std::any_of(runs.begin(), runs.end(), [](const RunData& run) { return run.touch_time.has_value(); });
  const std::string time_label = touched ? "time since first touch [ms]" : "time since release [ms]";
  std::string cutoff;
  if (!runs.empty() && runs.front().scene)
    cutoff = fmt::format("{:.0f} Hz low-pass", runs.front().scene->rig.clegg.filter_cutoff);

  Plot acceleration{"curve-acceleration", time_label, "acceleration [g]", {}, shown_range(runs), {}};
  add_series(acceleration, runs, "acceleration", 1 / standard_gravity, true, ", raw");
  add_series(acceleration, runs, "acceleration_filtered", 1 / standard_gravity, false, "");
  Plot velocity{"curve-velocity", time_label, "velocity, upward [m/s]", {}, shown_range(runs), {}};
  add_series(velocity, runs, "velocity", 1, false, "");
  Plot penetration{"curve-penetration", time_label, "penetration [mm]", {}, shown_range(runs), {}};
  add_series(penetration, runs, "penetration", 1e3, false, "");

  std::string text = svg_plot(acceleration) + svg_plot(velocity) + svg_plot(penetration);
  std::string note = "<p class=\"note\">Positive acceleration decelerates the falling missile";
  if (!cutoff.empty())
    note += fmt::format("; bold curves after the rig's filter ({}), pale ones as computed", cutoff);
  if (touched && !runs.empty() && runs.front().scene)
    note += fmt::format(". Time zero: contact force stays over {:g} N from there to its peak",
                        runs.front().scene->rig.clegg.touch_force);
  for (const RunData& run : runs)
    if (touched && !run.touch_time)
      note += fmt::format(". {} never touched: its time zero is the release", escape_html(run.label));
  return html_section("curves", "The drop", text + note + ".</p>\n");
}

}  // namespace tuft::app

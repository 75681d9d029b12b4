/// Section through the impact at three instants.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "app/section_view.h"

namespace tuft::app {
namespace {

constexpr std::size_t most_dots = 6000;  // a panel; keeps three panels of the largest scenes below a megabyte

struct Instant {
  std::string name;
  double time;  ///< s since release
};

/// The last frame at or before a time: "just before touch" must not show the touch itself.
double frame_at_or_before(const std::vector<double>& times, double time) {
  const auto after = std::upper_bound(times.begin(), times.end(), time + 1e-12);
  return after == times.begin() ? times.front() : *std::prev(after);
}

std::vector<Instant> instants(const RunData& run) {
  if (run.frame_times.empty()) return {};
  std::vector<Instant> chosen;
  if (run.touch_time) {
    const double time = frame_at_or_before(run.frame_times, *run.touch_time);
    chosen.push_back({time > 0 ? "before touch" : "settled, before the release", time});
  }
  if (const auto peak = peak_time(run); peak && run.touch_time)
    chosen.push_back({"peak deceleration", *peak});
  const bool rebounds = run.history.has("velocity") && !run.history.at("velocity").empty() &&
                        run.history.at("velocity").back() > 0;
  chosen.push_back({rebounds ? "end, rebounding" : "end", run.frame_times.back()});
  return chosen;
}

std::string panels(const RunData& run, std::size_t index, const SectionFrame& frame) {
  std::string text = fmt::format("<h3>{}</h3>\n<div class=\"panels\">\n", escape_html(run.label));
  std::size_t panel = 0;
  for (const Instant& instant : instants(run)) {
    const std::optional<Section> section = run.section(instant.time);
    if (!section) continue;
    text +=
        "<figure>\n" + section_svg(*section, frame, fmt::format("section-{}-{}", index, panel++), most_dots);
    const double since = section->time - time_origin(run);
    std::string caption = fmt::format("{}{} ms, {}", since < 0 ? "−" : "",
                                      fmt::format("{:.2f}", std::abs(1e3 * since)), instant.name);
    if (section->dots.size() > most_dots)
      caption += fmt::format("; 1 in {} particles drawn", (section->dots.size() + most_dots - 1) / most_dots);
    text += fmt::format("<figcaption>{}</figcaption>\n</figure>\n", caption);
  }
  return panel > 0 ? text + "</div>\n" : std::string();
}

std::string material_key(const Scene& scene, const SectionFrame& frame, bool fibres) {
  std::string text = "<p class=\"legend\">";
  for (const auto& [material, style] : frame.material_style)
    text += fmt::format(
        "<span><svg class=\"swatch\" width=\"14\" height=\"12\" aria-hidden=\"true\"><g class=\"{}\"><circle "
        "cx=\"6\" cy=\"6\" r=\"5\"/></g></svg>{}</span> ",
        style, escape_html(scene.materials.at(static_cast<std::size_t>(material)).name));
  if (fibres)
    text +=
        "<span><svg class=\"swatch\" width=\"26\" height=\"10\" aria-hidden=\"true\"><path class=\"strand\" "
        "stroke-width=\"2\" d=\"M1 5H25\"/></svg>fibres</span>";
  return text + "</p>\n";
}

}  // namespace

std::string report_sections(const Runs& runs) {
  std::string text, note;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!runs[i].scene) continue;
    const SectionFrame frame = make_section_frame(*runs[i].scene);
    const std::string drawn = panels(runs[i], i, frame);
    if (drawn.empty()) continue;
    if (text.empty()) text += material_key(*runs[i].scene, frame, has_fibres(runs[i]));
    text += drawn;
    if (const auto any = runs[i].section(runs[i].frame_times.back()))
      note += fmt::format(" {}: {} mm of particles{}.", escape_html(runs[i].label),
                          format_significant(1e3 * any->particle_slice, 2),
                          any->facet_slice > 0 ? fmt::format(", {} mm of backing and roots of fibres",
                                                             format_significant(1e3 * any->facet_slice, 2))
                                               : "");
  }
  if (text.empty())
    text = "<p class=\"missing\">No frame was recorded.</p>\n";
  else
    text += fmt::format(
        "<p class=\"note\">Slices around the plane through the missile’s axis, seen along y; times since "
        "first touch, of the nearest recorded frame. Thickness of the slices:{}</p>\n",
        note);
  return html_section("sections", "Section through the impact", text);
}

}  // namespace tuft::app

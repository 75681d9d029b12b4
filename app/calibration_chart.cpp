#include <fmt/format.h>

#include <algorithm>

#include "app/calibration_page.h"
#include "app/calibration_summary.h"
#include "app/html.h"

namespace tuft::app {
namespace {

using studies::Target;
using studies::TargetForm;
using studies::TargetOutcome;

// viewBox units. The bar takes the middle half of the track.
constexpr double width = 1000, row_height = 34, track_left = 330, track_right = 790, bar_share = 0.5;

double bar_left() {
  return track_left + 0.5 * (1 - bar_share) * (track_right - track_left);
}
double bar_width() {
  return bar_share * (track_right - track_left);
}

/// What a target takes for right.
std::pair<double, double> ends_of(const Target& target) {
  return target.form == TargetForm::range
             ? std::pair{target.low, target.high}
             : std::pair{target.number - target.tolerance, target.number + target.tolerance};
}

std::string mark(const Target& target, const TargetOutcome& outcome, double y, const char* style) {
  if (!outcome.measured) return "";
  const auto [low, high] = ends_of(target);
  const double x = bar_left() + (outcome.value - low) / (high - low) * bar_width();
  if (x > track_left && x < track_right)
    return fmt::format("<circle class=\"mark {}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5.5\"/>", style, x, y);
  const double tip = x <= track_left ? track_left : track_right, back = x <= track_left ? 9 : -9;
  return fmt::format("<path class=\"mark {}\" d=\"M{:.1f} {:.1f}l{:.1f} -5.5v11z\"/>", style, tip, y, back);
}

std::string row(const Target& target, const TargetOutcome& start, const TargetOutcome& fitted, double y) {
  const bool met = studies::is_inside(target, fitted);
  std::string text =
      fmt::format("<text x=\"0\" y=\"{:.1f}\" class=\"label\">{}</text>", y + 4, escape_html(target.name()));
  text += fmt::format(
      "<line class=\"track\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/><rect class=\"wanted\" "
      "x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"14\" rx=\"2\"/>",
      track_left, track_right, y, y, bar_left(), y - 7, bar_width());
  text += mark(target, start, y, "start") + mark(target, fitted, y, met ? "met" : "missed");
  text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{} → {}</text>", track_right + 16, y + 4,
                      escape_html(measured(target, start)), escape_html(measured(target, fitted)));
  return text + "\n";
}

}  // namespace

std::string target_chart(const studies::Problem& problem, const studies::CalibrationResult& result) {
  std::string rows;
  double y = 0.5 * row_height;
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    if (problem.targets[t].form == TargetForm::curve) continue;
    rows += row(problem.targets[t], result.start.targets[t], result.fitted.targets[t], y);
    y += row_height;
  }
  if (rows.empty()) return "";
  return fmt::format(
      "<figure class=\"plot\" id=\"target-chart\">\n<p class=\"legend\"><span>bar: what is wanted</span>"
      "<span>○ start</span><span>● fit</span><span>▶ beyond the track</span></p>\n"
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"targets, start and fit\">\n{}</svg>\n"
      "</figure>\n",
      width, y - 0.5 * row_height, rows);
}

}  // namespace tuft::app

#include "app/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/html.h"

namespace tuft::app {
namespace {

constexpr double margin_left = 70, margin_right = 14, margin_top = 10, margin_bottom = 44;

struct Axis {
  double low = 0, high = 1, pixel_low = 0, pixel_high = 1;
  [[nodiscard]] double pixel(double value) const {
    return pixel_low + (value - low) / (high - low) * (pixel_high - pixel_low);
  }
};

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool empty() const { return low > high; }
};

Range x_range_of(const Plot& plot) {
  Range range;
  if (plot.x_range) return {plot.x_range->first, plot.x_range->second};
  for (const Series& series : plot.series)
    for (const double x : series.x) range.include(x);
  return range;
}

/// Set by the bold curves: a raw spike may leave the frame, the curve that counts may not. Faint ones get up
/// to a third more room.
Range y_range_of(const Plot& plot, const Range& x_range) {
  Range bold, faint;
  for (const Series& series : plot.series)
    for (std::size_t i = 0; i < series.x.size(); ++i)
      if (series.x[i] >= x_range.low && series.x[i] <= x_range.high)
        (series.faint ? faint : bold).include(series.y[i]);
  for (const auto& [value, label] : plot.horizontal_lines) bold.include(value);
  if (bold.empty() || faint.empty()) return bold.empty() ? faint : bold;
  const double room = (bold.high - bold.low) / 3;
  return {std::min(bold.low, std::max(faint.low, bold.low - room)),
          std::max(bold.high, std::min(faint.high, bold.high + room))};
}

/// Widens to whole ticks, so that the axis ends on numbers.
void widen_to_ticks(Range& range, int ticks) {
  if (range.high - range.low <= 1e-300 + 1e-12 * std::abs(range.high)) {
    const double pad = range.high == 0 ? 1 : 0.5 * std::abs(range.high);
    range.low -= pad;
    range.high += pad;
  }
  const std::vector<double> positions = round_ticks(range.low, range.high, ticks);
  const double step = positions.size() > 1 ? positions[1] - positions[0] : 1;
  range.low = step * std::floor(range.low / step + 1e-9);
  range.high = step * std::ceil(range.high / step - 1e-9);
}

std::string tick_label(double value, double step) {
  if (std::abs(value) < 1e-9 * step) return "0";
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  // A true minus sign; scientific only where fixed notation would be longer than the axis is wide.
  std::string text = decimals > 5 || std::abs(value) >= 1e6 ? fmt::format("{:.2g}", value)
                                                            : fmt::format("{:.{}f}", value, decimals);
  if (text[0] == '-') text.replace(0, 1, "−");
  return text;
}

std::string axes(const Plot& plot, const Axis& x, const Axis& y) {
  std::string text = "<g class=\"axis\">\n";
  const std::vector<double> x_ticks = round_ticks(x.low, x.high, 10), y_ticks = round_ticks(y.low, y.high, 6);
  const double x_step = x_ticks.size() > 1 ? x_ticks[1] - x_ticks[0] : 1,
               y_step = y_ticks.size() > 1 ? y_ticks[1] - y_ticks[0] : 1;
  for (const double value : y_ticks) {
    const double at = y.pixel(value);
    text += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                        std::abs(value) < 1e-9 * y_step ? "zero" : "grid", x.pixel_low, x.pixel_high, at, at);
    text += fmt::format("<text class=\"end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x.pixel_low - 7, at + 4,
                        tick_label(value, y_step));
  }
  for (const double value : x_ticks) {
    const double at = x.pixel(value);
    text += fmt::format("<line class=\"tick\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>",
                        at, y.pixel_low, y.pixel_low + 5);
    text += fmt::format("<text class=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", at, y.pixel_low + 18,
                        tick_label(value, x_step));
  }
  text += fmt::format("<line class=\"frame\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>\n",
                      x.pixel_low, x.pixel_high, y.pixel_low, y.pixel_low);
  text += fmt::format("<text class=\"middle label\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                      0.5 * (x.pixel_low + x.pixel_high), plot.height - 8, escape_html(plot.x_label));
  text +=
      fmt::format("<text class=\"middle label\" transform=\"translate(14 {:.1f}) rotate(-90)\">{}</text>\n",
                  0.5 * (y.pixel_low + y.pixel_high), escape_html(plot.y_label));
  return text + "</g>\n";
}

/// One polyline per unbroken stretch of finite points.
std::string curve(const Series& series, const Axis& x, const Axis& y) {
  const Series thin = thinned(series, x.low, x.high, 700);
  std::string text, points;
  const auto finish = [&] {
    if (!points.empty()) {
      points.pop_back();
      text += fmt::format("<polyline class=\"{}{}{}\"{} points=\"{}\"/>\n", series.style,
                          series.faint ? " faint" : "", series.dashed ? " dashed" : "",
                          series.faint ? "" : fmt::format(" data-label=\"{}\"", escape_html(series.label)),
                          points);
    }
    points.clear();
  };
  for (std::size_t i = 0; i < thin.x.size(); ++i) {
    if (std::isfinite(thin.x[i]) && std::isfinite(thin.y[i]))
      points += fmt::format("{:.1f},{:.1f} ", x.pixel(thin.x[i]), y.pixel(thin.y[i]));
    else
      finish();
  }
  finish();
  return text;
}

std::string legend(const Plot& plot) {
  std::string text = "<p class=\"legend\">";
  for (const bool faint : {false, true})
    for (const Series& series : plot.series)
      if (series.faint == faint && !series.label.empty())
        text += fmt::format(
            "<span><svg class=\"swatch\" width=\"26\" height=\"10\" aria-hidden=\"true\"><line "
            "class=\"{}{}{}\" x1=\"1\" x2=\"25\" y1=\"5\" y2=\"5\"/></svg>{}</span> ",
            series.style, series.faint ? " faint" : "", series.dashed ? " dashed" : "",
            escape_html(series.label));
  return text + "</p>\n";
}

/// What stands in brackets in an axis' label.
std::string unit_of(const std::string& label) {
  const std::size_t open = label.rfind('['), close = label.rfind(']');
  return open == std::string::npos || close < open ? "" : label.substr(open + 1, close - open - 1);
}

}  // namespace

std::vector<double> round_ticks(double low, double high, int most) {
  if (!std::isfinite(low) || !std::isfinite(high) || high <= low || most < 1) return {low};
  const double raw = (high - low) / most;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * (1 - 1e-9)) {
      step = factor * power;
      break;
    }
  }
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    ticks.push_back(k * step);
  return ticks;
}

Series thinned(const Series& series, double x_low, double x_high, std::size_t columns) {
  Series result = series;
  result.x.clear();
  result.y.clear();
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i)
    if (series.x[i] >= x_low && series.x[i] <= x_high) inside.push_back(i);
  const std::size_t bin = std::max<std::size_t>(1, inside.size() / std::max<std::size_t>(1, columns));
  for (std::size_t start = 0; start < inside.size(); start += bin) {
    const std::size_t end = std::min(inside.size(), start + bin);
    std::vector<std::size_t> kept;
    if (bin <= 2) {
      kept.assign(inside.begin() + static_cast<std::ptrdiff_t>(start),
                  inside.begin() + static_cast<std::ptrdiff_t>(end));
    } else {
      const auto smaller = [&](std::size_t a, std::size_t b) { return series.y[a] < series.y[b]; };
      const auto [lowest, highest] =
          std::minmax_element(inside.begin() + static_cast<std::ptrdiff_t>(start),
                              inside.begin() + static_cast<std::ptrdiff_t>(end), smaller);
      kept = {inside[start], *lowest, *highest, inside[end - 1]};
      std::sort(kept.begin(), kept.end());
      kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    }
    for (const std::size_t i : kept) {
      result.x.push_back(series.x[i]);
      result.y.push_back(series.y[i]);
    }
  }
  return result;
}

std::string svg_plot(const Plot& plot) {
  const Range x_range = x_range_of(plot);
  Range y_range = y_range_of(plot, x_range);
  if (x_range.empty() || x_range.high <= x_range.low || y_range.empty())
    return fmt::format("<p class=\"missing\" id=\"{}\">Not recorded: {}.</p>\n", plot.id,
                       escape_html(plot.y_label));
  widen_to_ticks(y_range, 6);
  const Axis x{x_range.low, x_range.high, margin_left, plot.width - margin_right};
  const Axis y{y_range.low, y_range.high, plot.height - margin_bottom, margin_top};
  std::string text = fmt::format("<figure class=\"plot\" id=\"{}\">\n{}", plot.id, legend(plot));
  text += fmt::format(
      "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{} against {}\" data-x=\"{:.6g} {:.6g} "
      "{:.1f} {:.1f}\" data-y=\"{:.6g} {:.6g} {:.1f} {:.1f}\" data-unit=\"{}\">\n",
      plot.width, plot.height, escape_html(plot.y_label), escape_html(plot.x_label), x.low, x.high,
      x.pixel_low, x.pixel_high, y.low, y.high, y.pixel_low, y.pixel_high,
      escape_html(unit_of(plot.x_label)));
  text += axes(plot, x, y);
  text += fmt::format(
      "<svg x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" viewBox=\"{0:.1f} {1:.1f} "
      "{2:.1f} {3:.1f}\">\n",
      x.pixel_low, y.pixel_high, x.pixel_high - x.pixel_low, y.pixel_low - y.pixel_high);
  for (const bool faint : {true, false})
    for (const Series& series : plot.series)
      if (series.faint == faint) text += curve(series, x, y);
  for (const auto& [value, label] : plot.horizontal_lines) {
    const double at = y.pixel(value);
    text += fmt::format(
        "<line class=\"limit\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/><text class=\"limit "
        "end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
        x.pixel_low, x.pixel_high, at, at, x.pixel_high - 6, at > y.pixel_high + 20 ? at - 5 : at + 14,
        escape_html(label));
  }
  return text + "</svg>\n</svg>\n</figure>\n";
}

}  // namespace tuft::app

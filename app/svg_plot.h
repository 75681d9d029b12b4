#pragma once
/// Line plots as inline SVG: axes with units, ticks on round numbers, no script needed to read them.
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tuft::app {

struct Series {
  std::string label;
  std::string style;         ///< CSS class that gives the colour: "c0", "c1", ...
  std::vector<double> x, y;  ///< same length, in the axis' units
  bool faint = false;        ///< thin and pale, not in the read-out
  bool dashed = false;
};

struct Plot {
  std::string id;
  std::string x_label, y_label;  ///< with unit: "time since first touch [ms]"
  std::vector<Series> series;
  std::optional<std::pair<double, double>> x_range;
  std::vector<std::pair<double, std::string>> horizontal_lines;  ///< limits: value and label
  double width = 1000, height = 300;                             ///< viewBox units
};

/// The plot with its legend. Points that are not finite are left out; x outside the range is cut off.
[[nodiscard]] std::string svg_plot(const Plot& plot);

/// Round tick positions covering [low, high] in steps of 1, 2 or 5 times a power of ten; at most `most` + 1
/// of them.
[[nodiscard]] std::vector<double> round_ticks(double low, double high, int most);

/// At most about 2 x `columns` points that keep every extreme: the first, smallest, largest and last of each
/// bin.
[[nodiscard]] Series thinned(const Series& series, double x_low, double x_high, std::size_t columns);

}  // namespace tuft::app

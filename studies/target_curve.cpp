#include "studies/target_curve.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "core/error.h"
#include "core/nearest_name.h"
#include "core/scene_files.h"
#include "core/units.h"

namespace tuft::studies {
namespace {

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells;
  std::istringstream stream(line + ",");
  for (std::string cell; std::getline(stream, cell, ',');) {
    const std::size_t first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

std::size_t column_of(const CalibrationFile& calibration, const std::vector<std::string>& names,
                      const std::string& wanted, std::size_t otherwise, const std::string& path,
                      const std::string& file) {
  if (wanted.empty()) return otherwise;
  const auto found = std::ranges::find(names, wanted);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const auto nearest = nearest_name(wanted, names);
  calibration.places.fail(
      path, nearest ? fmt::format("no such column in {}; did you mean \"{}\"?", file, *nearest)
                    : fmt::format("no such column in {}; there are {}", file, fmt::join(names, ", ")));
}

double number_of(const std::string& cell, const std::string& file, std::size_t line) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    throw_input_error("{}:{}: \"{}\": a number is needed", file, line, cell);
  return value;
}

/// Columns of a file, as written.
void read_columns(const CalibrationFile& calibration, const TargetCurve& given, const std::string& path,
                  std::vector<double>& x, std::vector<double>& y) {
  const auto file = file_beside(calibration, given.file, path + ".curve.file");
  std::istringstream text(read_text_file(file));
  std::string line;
  std::getline(text, line);
  const auto names = cells_of(line);
  const std::size_t x_at = column_of(calibration, names, given.x_column, 0, path + ".curve.x_column",
                                     file.string()),
                    y_at = column_of(calibration, names, given.y_column, 1, path + ".curve.y_column",
                                     file.string());
  for (std::size_t number = 2; std::getline(text, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const auto cells = cells_of(line);
    if (cells.size() <= std::max(x_at, y_at))
      throw_input_error("{}:{}: {} columns, where {} are needed", file.string(), number, cells.size(),
                        std::max(x_at, y_at) + 1);
    x.push_back(number_of(cells[x_at], file.string(), number));
    y.push_back(number_of(cells[y_at], file.string(), number));
  }
}

void convert(const CalibrationFile& calibration, std::vector<double>& values, const std::string& unit,
             const std::string& si_unit, const std::string& path) {
  double factor = 1;
  try {
    factor = unit_factor(unit, si_unit);
  } catch (const InputError& error) {
    calibration.places.fail(path, error.what());
  }
  for (double& value : values) value = scale_by_unit(value, factor);
}

}  // namespace

void resolve_curve(const CalibrationFile& calibration, const TargetCurve& given, const std::string& path,
                   const std::vector<ModelCurve>& curves, Target& target) {
  const auto found = std::ranges::find(curves, target.quantity, &ModelCurve::name);
  if (found == curves.end()) {
    std::vector<std::string> known;
    for (const ModelCurve& curve : curves) known.push_back(curve.name);
    const auto nearest = nearest_name(target.quantity, known);
    calibration.places.fail(
        path + ".quantity",
        nearest ? fmt::format("no such curve of this model; did you mean \"{}\"?", *nearest)
                : fmt::format("no such curve of this model; there are {}", fmt::join(known, ", ")));
  }
  target.form = TargetForm::curve;
  target.unit = found->y_unit;
  target.x_unit = found->x_unit;
  target.tolerance = given.tolerance;
  if (given.file.empty()) {
    for (const Given& x : given.x) target.x.push_back(given_in(x, "1"));
    for (const Given& y : given.y) target.y.push_back(given_in(y, "1"));
  } else {
    read_columns(calibration, given, path, target.x, target.y);
  }
  convert(calibration, target.x, given.x_unit, found->x_unit, path + ".curve.x_unit");
  convert(calibration, target.y, given.y_unit, found->y_unit, path + ".curve.y_unit");
  if (target.x.empty() || std::ranges::all_of(target.y, [](double y) { return y == 0; }))
    calibration.places.fail(path + ".curve", "needs points, and one whose y is not 0");
}

}  // namespace tuft::studies

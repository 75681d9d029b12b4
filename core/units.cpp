#include "core/units.h"

#include <udunits2.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/scene_reader.h"

namespace tuft {
namespace {

struct UnitDeleter {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, UnitDeleter>;

struct ConverterDeleter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using Converter = std::unique_ptr<cv_converter, ConverterDeleter>;

ut_system* unit_system() {
  static ut_system* const system = [] {
    ut_set_error_message_handler(ut_ignore);
    ut_system* read = ut_read_xml(nullptr);
    if (read == nullptr)
      throw_run_error("the table of units of UDUNITS-2 is missing: install libudunits2-data");
    return read;
  }();
  return system;
}

Unit parse_unit(std::string_view text) {
  return Unit(ut_parse(unit_system(), std::string(text).c_str(), UT_UTF8));
}

struct DimensionWords {
  std::string_view unit, words, example;
};
constexpr std::array<DimensionWords, 12> dimensions{{
    {"m", "a length", "5 mm"},
    {"kg", "a mass", "2.25 kg"},
    {"s", "a time", "10 ms"},
    {"m/s", "a speed", "2.85 m/s"},
    {"s/m", "an inverse speed", "300 s/m"},
    {"Pa", "a pressure or modulus", "100 kPa"},
    {"Pa^2", "a squared pressure", "100 kPa^2"},
    {"kg/m^3", "a density", "440 kg/m^3"},
    {"rad", "an angle", "10 degree"},
    {"degree", "an angle", "10 degree"},
    {"1", "a share", "20 %"},
    {"Hz", "a frequency or rate", "1000 Hz"},
}};

const DimensionWords* find_dimension(std::string_view si_unit) {
  for (const DimensionWords& dimension : dimensions)
    if (dimension.unit == si_unit) return &dimension;
  return nullptr;
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

}  // namespace

std::string dimension_in_words(std::string_view si_unit) {
  const DimensionWords* found = find_dimension(si_unit);
  return found != nullptr ? fmt::format("{} ({})", found->words, si_unit)
                          : fmt::format("a quantity in {}", si_unit);
}

std::string example_quantity(std::string_view si_unit) {
  const DimensionWords* found = find_dimension(si_unit);
  return found != nullptr ? std::string(found->example) : fmt::format("1 {}", si_unit);
}

double unit_factor(std::string_view unit, std::string_view si_unit) {
  if (unit == si_unit) return 1.0;
  const Unit given = parse_unit(unit);
  if (!given)
    throw_input_error("\"{}\" is not a unit; write for example \"{}\"", unit, example_quantity(si_unit));
  const Unit wanted = parse_unit(si_unit);
  const Converter converter(ut_get_converter(given.get(), wanted.get()));
  if (!converter)
    throw_input_error("\"{}\" is not the unit of {}; write for example \"{}\"", unit,
                      dimension_in_words(si_unit), example_quantity(si_unit));
  const double at_zero = cv_convert_double(converter.get(), 0.0);
  const double factor = cv_convert_double(converter.get(), 1.0);
  const double at_two = cv_convert_double(converter.get(), 2.0);
  if (at_zero != 0.0 || !(std::abs(at_two - 2 * factor) <= 1e-12 * std::abs(at_two)))
    throw_input_error("\"{}\" is not a plain multiple of {}; give the value in {}", unit, si_unit, si_unit);
  // Rounding inside the library: "g/cm^3" comes out as 1000 and an ulp.
  const double whole = std::round(factor);
  return std::abs(factor - whole) < 1e-13 * factor ? whole : factor;
}

double scale_by_unit(double value, double factor) {
  const double inverse = std::round(1.0 / factor);
  if (factor < 1.0 && std::isfinite(inverse) && std::abs(inverse * factor - 1.0) < 1e-13)
    return value / inverse;
  return value * factor;
}

double quantity_from_text(std::string_view text, std::string_view si_unit) {
  const std::string_view trimmed = trim(text);
  double value = 0;
  const char* begin = trimmed.data() + (trimmed.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, trimmed.data() + trimmed.size(), value);
  if (error == std::errc::result_out_of_range) throw_input_error("is too large or too small for a number");
  if (error != std::errc())
    throw_input_error("does not begin with a number; {} is needed, for example \"{}\"",
                      dimension_in_words(si_unit), example_quantity(si_unit));
  if (!std::isfinite(value)) throw_input_error("must be a finite number");
  const std::string_view unit = trim(trimmed.substr(static_cast<std::size_t>(end - trimmed.data())));
  if (unit.empty())
    throw_input_error("has no unit; {} is needed, for example \"{} {}\"", dimension_in_words(si_unit),
                      trimmed, si_unit);
  const double scaled = scale_by_unit(value, unit_factor(unit, si_unit));
  if (!std::isfinite(scaled)) throw_input_error("is too large");
  return scaled;
}

double parse_quantity(const std::string& text, const std::string& si_unit) {
  return quantity_from_text(text, si_unit);
}

}  // namespace tuft

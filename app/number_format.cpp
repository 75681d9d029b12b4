#include "app/number_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace tuft::app {

std::string format_significant(double value, int digits) {
  if (!std::isfinite(value)) return not_available;
  if (value == 0) return "0";
  // Rounding first, so that 9.996 counts as 10.0 and not as 9.996 with one digit too many.
  const double rounded = std::stod(fmt::format("{:.{}e}", value, digits - 1));
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(rounded))));
  if (exponent < -4 || exponent >= 6) {
    const std::string mantissa = fmt::format("{:.{}f}", rounded / std::pow(10.0, exponent), digits - 1);
    return fmt::format("{}e{}", mantissa, exponent);
  }
  return fmt::format("{:.{}f}", rounded, std::max(0, digits - 1 - exponent));
}

std::string format_input(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : not_available;
}

std::string format_count(std::uint64_t value) {
  const std::string digits = fmt::format("{}", value);
  std::string grouped;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) grouped += ' ';
    grouped += digits[i];
  }
  return grouped;
}

std::string format_duration(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0) return not_available;
  if (seconds == 0) return "0 s";
  if (seconds < 0.9995) return format_significant(1e3 * seconds, 3) + " ms";
  if (seconds < 99.95) return format_significant(seconds, 3) + " s";
  const auto whole = static_cast<std::uint64_t>(std::llround(seconds));
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  const std::uint64_t minutes = (whole + 30) / 60;
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

std::string format_bytes(std::uint64_t bytes) {
  const double value = static_cast<double>(bytes);
  if (value < 1e3) return fmt::format("{} bytes", bytes);
  if (value < 999.5e3) return format_significant(value / 1e3, 3) + " kB";
  if (value < 999.5e6) return format_significant(value / 1e6, 3) + " MB";
  return format_significant(value / 1e9, 3) + " GB";
}

std::string format_rate(double per_second) {
  if (!std::isfinite(per_second)) return not_available;
  if (per_second <= 0) return "0/s";
  if (per_second >= 999.5e3) return format_significant(per_second / 1e6, 3) + " million/s";
  // Three digits are what a wall-clock rate is good for.
  const double rounded = std::stod(fmt::format("{:.2e}", per_second));
  return rounded >= 100 ? format_count(static_cast<std::uint64_t>(rounded)) + "/s"
                        : format_significant(rounded, 3) + "/s";
}

std::string format_percent(double fraction, int digits) {
  if (!std::isfinite(fraction)) return not_available;
  return format_significant(100 * fraction, digits) + " %";
}

DisplayUnit display_unit(const std::string& si_unit, double magnitude) {
  const double size = std::abs(magnitude);
  if (si_unit == "1" || si_unit == "-") return {1, ""};
  if (si_unit == "m" && size < 1) return {1e3, "mm"};
  if (si_unit == "s" && size < 1e-3 && size > 0) return {1e6, "µs"};
  if (si_unit == "s" && size < 1) return {1e3, "ms"};
  if (si_unit == "Pa" && size >= 1e6) return {1e-6, "MPa"};
  if (si_unit == "Pa" && size >= 1e3) return {1e-3, "kPa"};
  if (si_unit == "N/m" && size >= 1e3) return {1e-3, "kN/m"};
  if (si_unit == "N" && size >= 1e4) return {1e-3, "kN"};
  return {1, si_unit};
}

std::string format_quantity(double value, const std::string& si_unit, int digits) {
  if (!std::isfinite(value)) return not_available;
  const DisplayUnit shown = display_unit(si_unit, value);
  // Numbers of things are not measurements: all their digits count.
  const bool is_count = shown.unit.empty() && value >= 0 && value < 1e15 && value == std::floor(value);
  if (is_count) return format_count(static_cast<std::uint64_t>(value));
  const std::string number = format_significant(shown.factor * value, digits);
  return shown.unit.empty() ? number : number + " " + shown.unit;
}

std::string readable_name(const std::string& name) {
  static const std::map<std::string, std::string> own{{"peak_g", "Peak deceleration"},
                                                      {"peak_g_raw", "Peak deceleration, raw"},
                                                      {"max_penetration", "Largest penetration"},
                                                      {"separated", "Left the turf again (1: yes)"},
                                                      {"contact", "Contact"},
                                                      {"search", "Contact search"},
                                                      {"infill", "Infill steps"},
                                                      {"carpet", "Carpet steps"},
                                                      {"waiting", "Waiting for the infill's host"},
                                                      {"exchange", "Exchange with the host"},
                                                      {"rig", "Rig"},
                                                      {"ledger", "Energy ledger"},
                                                      {"record", "Recording"}};
  if (const auto found = own.find(name); found != own.end()) return found->second;
  std::string text = name;
  std::replace(text.begin(), text.end(), '_', ' ');
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string upper_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace tuft::app

#pragma once
/// Numbers as people read them: significant digits, sensible prefixes, never "nan".
#include <cstdint>
#include <string>

namespace tuft::app {

/// Shown where a value was never measured or is not finite.
inline constexpr const char* not_available = "n/a";

/// `digits` significant digits; fixed notation from 1e-4 to 1e6, "1.2e-10" outside it.
[[nodiscard]] std::string format_significant(double value, int digits = 3);
/// An input as its author wrote it: no digits added, "2.25".
[[nodiscard]] std::string format_input(double value);
/// 12400 -> "12 400".
[[nodiscard]] std::string format_count(std::uint64_t value);
/// Seconds of wall time: "850 ms", "12.3 s", "4 min 05 s", "2 h 10 min".
[[nodiscard]] std::string format_duration(double seconds);
/// Decimal prefixes: "312 MB".
[[nodiscard]] std::string format_bytes(std::uint64_t bytes);
/// "1.42 million/s", "35 400/s".
[[nodiscard]] std::string format_rate(double per_second);
/// A fraction as "1.23 %".
[[nodiscard]] std::string format_percent(double fraction, int digits = 3);

/// The unit a quantity of this size is shown in, and the factor to it: ("m", 0.0137) -> (1000, "mm").
struct DisplayUnit {
  double factor = 1;
  std::string unit;
};
[[nodiscard]] DisplayUnit display_unit(const std::string& si_unit, double magnitude);
/// Value and unit: "13.7 mm".
[[nodiscard]] std::string format_quantity(double value, const std::string& si_unit, int digits = 3);

/// "time_of_peak" -> "Time of peak"; the names of rig results have words of their own.
[[nodiscard]] std::string readable_name(const std::string& name);
/// "sph" -> "SPH".
[[nodiscard]] std::string upper_case(std::string text);

}  // namespace tuft::app

#pragma once
/// Quantities as text ("2 mm") and their SI values, by UDUNITS-2.
#include <string>
#include <string_view>

namespace tuft {

/// Value of `text` in `si_unit`. Accepts any unit of the same dimension that is a plain multiple. Throws
/// InputError that says what is wrong and what to write, without a place: no number, not finite, no unit,
/// unknown unit, another dimension, a unit with an offset (degree Celsius).
[[nodiscard]] double quantity_from_text(std::string_view text, std::string_view si_unit);

/// Factor from `unit` to `si_unit`; throws as above.
[[nodiscard]] double unit_factor(std::string_view unit, std::string_view si_unit);

/// value x factor, rounded once where the factor is the inverse of a whole number: "7 mm" gives the same bits
/// as 0.007.
[[nodiscard]] double scale_by_unit(double value, double factor);

/// "a length" for "m": for messages.
[[nodiscard]] std::string dimension_in_words(std::string_view si_unit);

/// "5 mm" for "m": a quantity of the right kind, for messages.
[[nodiscard]] std::string example_quantity(std::string_view si_unit);

}  // namespace tuft

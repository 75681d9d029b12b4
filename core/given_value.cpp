#include "core/given_value.h"

#include <cmath>

#include "core/error.h"
#include "core/units.h"

namespace tuft {

double given_in(const Given& given, std::string_view of_unit) {
  const std::string_view unit = of_unit == "deg" ? "degree" : of_unit;  // as results name it, and UDUNITS
  const auto fail = [&](std::string_view problem) {
    throw_bad_key(given.place.where, given.place.key, given.place.value, problem);
  };
  if (!given.quoted) {
    if (unit != "1")
      fail(fmt::format("a plain number; {} with its unit in quotes is needed, for example \"{}\"",
                       dimension_in_words(unit), example_quantity(unit)));
    if (!std::isfinite(given.number)) fail("must be a finite number");
    return given.number;
  }
  try {
    return quantity_from_text(given.text, unit);
  } catch (const InputError& error) {
    fail(error.what());
  }
  return 0;
}

std::string given_text(const Given& given) {
  if (!given.quoted)
    throw_bad_key(given.place.where, given.place.key, given.place.value, "text in quotes is needed");
  return given.text;
}

}  // namespace tuft

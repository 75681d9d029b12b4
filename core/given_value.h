#pragma once
/// A value as it was written, where its unit is known only later: of a parameter from the key that it names,
/// of a target from the result that it speaks of.
#include <string>
#include <string_view>

#include "core/scene_places.h"

namespace tuft {

struct Given {
  std::string text;  ///< without quotes; empty: left out
  bool quoted = false;
  double number = 0;  ///< where it was a plain number
  Place place;        ///< for messages

  [[nodiscard]] bool is_given() const { return quoted || !place.where.empty(); }
};

/// Value in a unit: of unit "1" a plain number or a quantity like "20 %", else a quantity with its unit.
/// Throws InputError with the value's place.
[[nodiscard]] double given_in(const Given& given, std::string_view unit);

/// A text in quotes. Throws InputError with its place.
[[nodiscard]] std::string given_text(const Given& given);

}  // namespace tuft

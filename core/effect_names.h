#pragma once
/// The effects that a scene can switch, in the order in which they are listed.
#include <array>
#include <string_view>

namespace tuft {

inline constexpr std::array<std::string_view, 7> effect_names{
    "fibres",          "friction_rate",  "artificial_viscosity", "tension_cutoff", "rolling_resistance",
    "overlap_release", "contact_damping"};

}  // namespace tuft

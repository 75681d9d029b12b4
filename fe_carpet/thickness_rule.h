#pragma once
/// Integration through the thickness of a shell.
#include <array>

namespace tuft::fe {

/// Gauss-Legendre points on [-1, 1] with weights that add up to 1.
template <int Points>
struct ThicknessRule {
  std::array<double, Points> height, weight;
};

template <int Points>
[[nodiscard]] constexpr ThicknessRule<Points> thickness_rule() {
  static_assert(Points >= 2 && Points <= 5);
  if constexpr (Points == 2) return {{-0.57735026918962576, 0.57735026918962576}, {0.5, 0.5}};
  if constexpr (Points == 3)
    return {{-0.77459666924148338, 0, 0.77459666924148338}, {5.0 / 18, 8.0 / 18, 5.0 / 18}};
  if constexpr (Points == 4) {
    constexpr double outer = 0.86113631159405258, inner = 0.33998104358485626;
    constexpr double outer_weight = 0.17392742256872692, inner_weight = 0.32607257743127308;
    return {{-outer, -inner, inner, outer}, {outer_weight, inner_weight, inner_weight, outer_weight}};
  }
  if constexpr (Points == 5) {
    constexpr double outer = 0.90617984593866399, inner = 0.53846931010568309;
    constexpr double outer_weight = 0.11846344252809454, inner_weight = 0.23931433524968324;
    return {{-outer, -inner, 0, inner, outer},
            {outer_weight, inner_weight, 64.0 / 225, inner_weight, outer_weight}};
  }
}

}  // namespace tuft::fe

#pragma once
/// The named effects of the soil law, as a value that templates take: what is off is not compiled in.
#include <type_traits>
#include <utility>

namespace tuft::sph {

struct SoilEffects {
  bool density_hardening = false;
  bool strength_softening = false;
  bool strength_recovery = false;  ///< with strength_softening only
  bool strength_rate = false;
  bool dilation = false;
  bool shear_energy = false;
  bool inertial_friction = false;
  bool operator==(const SoilEffects&) const = default;
};

template <SoilEffects effects>
using SoilEffectsConstant = std::integral_constant<SoilEffects, effects>;

namespace detail {

inline constexpr unsigned soil_effect_count = 7;

constexpr unsigned code_of(const SoilEffects& e) {
  return unsigned{e.density_hardening} | unsigned{e.strength_softening} << 1 |
         unsigned{e.strength_recovery && e.strength_softening} << 2 | unsigned{e.strength_rate} << 3 |
         unsigned{e.dilation} << 4 | unsigned{e.shear_energy} << 5 | unsigned{e.inertial_friction} << 6;
}
constexpr SoilEffects effects_of(unsigned code) {
  const auto bit = [code](unsigned b) { return (code >> b & 1U) != 0; };
  return {bit(0), bit(1), bit(1) && bit(2), bit(3), bit(4), bit(5), bit(6)};
}

}  // namespace detail

/// Calls body(SoilEffectsConstant<...>) with the effects as a type: one branch for all that the body does.
template <class Body>
void with_soil_effects(const SoilEffects& effects, Body&& body) {
  const unsigned code = detail::code_of(effects);
  [&]<unsigned... codes>(std::integer_sequence<unsigned, codes...>) {
    (void)((codes == code && (body(SoilEffectsConstant<detail::effects_of(codes)>{}), true)) || ...);
  }
  (std::make_integer_sequence<unsigned, 1U << detail::soil_effect_count>{});
}

}  // namespace tuft::sph

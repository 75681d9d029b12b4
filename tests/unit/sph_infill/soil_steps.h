#pragma once
/// Steps of a point of soil, and what it bears.
#include <cmath>

#include "sph_infill/soil_update.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph::test {

inline StrainStep compress(double strain, double dt = 0) {
  return {{-strain / 3, -strain / 3, -strain / 3, 0, 0, 0}, {}, dt};
}
/// Shear at constant volume by an engineering strain.
inline StrainStep shear(double gamma, double dt = 0) {
  return {{0, 0, 0, 0.5 * gamma, 0, 0}, {}, dt};
}

inline void go_to(const SoilLaw& law, SoilState& state, double target, int steps) {
  const double strain = (target - state.compression) / steps;
  for (int k = 0; k < steps; ++k) update_soil(law, compress(strain), state);
}

inline double root_j2(const SoilState& state) {
  return std::sqrt(0.5 * double_dot(state.deviator, state.deviator));
}

/// Shear stress reached by shearing far.
inline double strength(const SoilLaw& law, SoilState state, double rate = 0) {
  for (int k = 0; k < 200; ++k) update_soil(law, shear(1e-3, rate > 0 ? 1e-3 / rate : 0), state);
  return root_j2(state);
}

inline constexpr SoilEffects hardening{.density_hardening = true}, softening{.strength_softening = true},
    recovery{.strength_softening = true, .strength_recovery = true}, rate{.strength_rate = true},
    inertial{.inertial_friction = true}, dilation{.dilation = true}, shear_energy{.shear_energy = true};

}  // namespace tuft::sph::test

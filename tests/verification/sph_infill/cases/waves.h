#pragma once
/// Oedometric (P) waves in an elastic bar on lateral rollers.
#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph::test {

struct BarSizes {
  int rows = 60;          ///< particles along the bar; 5 x 5 across
  double length = 0.12;   ///< m
  bool half_row = false;  ///< as beds of scenes are: rows have shares, the wall is a spring of half a row
};

struct ModeResult {
  double speed = 0;    ///< over sqrt((K + 4G/3)/rho)
  double quarter = 0;  ///< the same from the first zero crossing
};

/// The first mode of a free-free bar, v_z = V cos(pi z/L), has the period 2 L/c. Rollers (springs to the
/// initial x and y of every particle) keep it in uniaxial strain, in tension as in compression.
[[nodiscard]] ModeResult free_bar_mode(const Numerics& numerics, const BarSizes& sizes);

struct PulseResult {
  double speed = 0;           ///< between two stations inside the bar, over sqrt((K + 4G/3)/rho)
  double wall_velocity = 0;   ///< peak after reflection at the wall over peak before: -1
  double free_velocity = 0;   ///< the same at the free end: +1
  double wall_stress = 0;     ///< stress likewise: +1
  double free_stress = 0;     ///< -1
  double doubled_stress = 0;  ///< largest stress near the wall over the incident peak: 2
  double wall_force = 0;      ///< largest force on the wall over its area and the incident peak of stress: 2
  double energy_error = 0;    ///< over the energy put in
};

/// A Gaussian pulse of velocity in the middle of a bar between a wall and a free end: it parts into two that
/// run to the ends, are reflected and meet again. `width`: the pulse's standard deviation over the bar's
/// length.
[[nodiscard]] PulseResult reflected_pulse(const Numerics& numerics, const BarSizes& sizes,
                                          double width = 0.04);

}  // namespace tuft::sph::test

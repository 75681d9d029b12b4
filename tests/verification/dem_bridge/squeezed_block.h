#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bridge_scene.h"

namespace tuft::dem::test {

/// A block of grains in a box that squeezes it by a sixth and lets go, energies asked for in every window:
/// the largest excess of energy in sum, relative to what was dissipated.
inline double created_by_squeezing(const DemSettings& settings, const Material& material,
                                   double steps_of_stability) {
  ShakenBlock block(5);
  block.materials = {material};
  DemInfill infill(block.grains, block.materials, settings);
  const double window = steps_of_stability * infill.stable_step(), width = block.half_width, period = 1.5e-3;
  double start = 0, created = 0;
  for (int k = 0; k * window < period; ++k) {
    block.half_width = width * (1 - 0.075 * (1 - std::cos(2 * std::numbers::pi * k * window / period)));
    infill.begin_window(window, 1, true);
    infill.advance(window, 1, block.confine(infill, window));
    const InfillEnergy energy = infill.energy();
    const double sum =
        energy.kinetic + energy.stored + energy.dissipated + energy.damping - energy.contact_work;
    if (k == 0) start = sum;
    created = std::max(created, sum - start);
  }
  EXPECT_GT(infill.energy().dissipated, 1e-5) << "hardly squeezed";
  return created / infill.energy().dissipated;
}

}  // namespace tuft::dem::test

#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bridge_scene.h"
#include "core/error.h"

namespace tuft::dem::test {

/// A block of grains in a box that squeezes it by twice `share` of its width and lets go, energies asked for
/// in every window: the largest excess of energy in sum, relative to what was dissipated. Block: ShakenBlock
/// or of its kind.
template <class Block>
double created_by_squeezing(Block block, const DemSettings& settings, double steps_of_stability,
                            double share = 0.075, double period = 1.5e-3) {
  DemInfill infill(block.grains, block.materials, settings);
  const double window = steps_of_stability * infill.stable_step(), width = block.half_width;
  double start = 0, created = 0;
  for (int k = 0; k * window < period; ++k) {
    block.half_width = width * (1 - share * (1 - std::cos(2 * std::numbers::pi * k * window / period)));
    try {
      infill.begin_window(window, 1, true);
      infill.advance(window, 1, block.confine(infill, window));
    } catch (const RunError&) {
      break;  // a grain was shot out; the balance has shown it before
    }
    const InfillEnergy e = infill.energy();
    const double sum =
        e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping + e.expelled - e.contact_work;
    if (k == 0) start = sum;
    created = std::max(created, sum - start);
  }
  EXPECT_GT(infill.energy().dissipated, 1e-5) << "hardly squeezed";
  return created / infill.energy().dissipated;
}

inline double created_by_squeezing(const DemSettings& settings, const Material& material,
                                   double steps_of_stability) {
  ShakenBlock block(5);
  block.materials = {material};
  return created_by_squeezing(block, settings, steps_of_stability);
}

}  // namespace tuft::dem::test

#pragma once
/// Grains poured between bodies of the coupler: where they start, and how they come to rest.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/verification/coupler/grain_case.h"

namespace tuft::coupler {

/// Adds `count` grains on a loose cubic lattice with random shifts, from the height `low` upwards, at the
/// places of the lattice for which `inside(x, y)` holds of the shifted centre.
template <class Inside>
void add_loose(GrainCase& setup, double radius, double density, const std::array<int, 2>& across, int count,
               double pitch, double low, std::uint64_t seed, const Inside& inside) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> shift(-0.5, 0.5);
  const double room = pitch - 2 * radius;
  for (int n = 0, added = 0; added < count; ++n) {
    const int layer = n / (across[0] * across[1]), in_layer = n % (across[0] * across[1]);
    const int i = in_layer % across[0], j = in_layer / across[0];
    const double dx = shift(random), dy = shift(random), dz = shift(random);
    const double x = (i - 0.5 * (across[0] - 1)) * pitch + room * dx,
                 y = (j - 0.5 * (across[1] - 1)) * pitch + room * dy;
    if (!inside(x, y)) continue;
    dem::test::add_grain(setup.grains, Vec3(x, y, low + (layer + 0.5) * pitch + room * dz), radius, density);
    ++added;
  }
}

inline void settle(Simulation& s, double damping, double time) {
  s.set_damping(0, damping);
  for (int k = 0; k < std::lround(time / 1e-3); ++k) s.advance_interval(1e-3);
}

}  // namespace tuft::coupler

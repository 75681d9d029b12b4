#pragma once
/// Bodies that touch nothing.
#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph::test {

struct DiscSizes {
  int radius = 7, thickness = 3;  ///< particles
  double turns = 10;
  double speed = 0.1;    ///< of the rim over that of pressure waves
  double pitch = 0.002;  ///< m
};

struct DiscResult {
  double radius = 0;  ///< root of the mean square distance from the axis, over that at first, at the end
  double energy_error = 0;       ///< of the total, over the kinetic energy at first
  double kinetic = 0;            ///< kinetic plus stored energy at the end over the kinetic energy at first
  double angular_momentum = 0;   ///< over that at first
  double smallest_distance = 0;  ///< between particles at the end, over the pitch
  double out_of_shape = 0;  ///< largest distance of a particle from its place on the turned disc, over pitch
};

/// A soft elastic disc spun about its axis without gravity: its centrifugal load stretches it by a few
/// thousandths at once, and it breathes about that state.
[[nodiscard]] DiscResult spinning_disc(const Numerics& numerics, const DiscSizes& sizes);

/// Largest change of shape of a disordered slab in free fall over a height of `drop` times its own depth,
/// over the pitch.
[[nodiscard]] double falling_slab(const Numerics& numerics, double drop, bool cohesion);

}  // namespace tuft::sph::test

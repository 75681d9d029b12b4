#pragma once
/// A block drawn apart until it separates: does it, or do its particles clump (tensile instability)?
#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph::test {

struct DrawnCase {
  SoilFoamMaterial material = mixture_material();
  bool tension_cutoff = true;
  double speed = 2;    ///< m/s of either grip: well under the speed of sound, 50 m/s
  double stretch = 1;  ///< of the whole block, when it ends
  double jitter = 0.02;
  double pitch = 0.002;  ///< m
  double step = 0.8;     ///< of the largest
};

struct DrawnResult {
  double smallest_distance = 0;  ///< between particles over the pitch, the smallest over the run
  double close = 0;              ///< largest share of particles with another nearer than half a pitch
  double clumped = 0;            ///< the same at the end
  double widest_gap = 0;  ///< along the block at the end, between neighbouring particles' heights, over pitch
  double energy_error = 0;  ///< over the work of the grips
  double tension = 0;       ///< Pa, largest mean tension over the cross-section
};

/// 8 x 8 x 16 particles without gravity; the outermost two rows at either end are held by springs to grips
/// that part at constant speed.
[[nodiscard]] DrawnResult drawn_block(const Numerics& numerics, const DrawnCase& which);

}  // namespace tuft::sph::test

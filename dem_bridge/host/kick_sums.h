#pragma once
/// What the host sums up over the grains and clumps of one kick.
#include <array>
#include <cmath>

#include "core/vector.h"

namespace tuft::dem {

struct KickSums {
  std::array<double, 3> received{}, scale{};  ///< N s, of contact impulses, and of their absolute values
  double kinetic = 0, pair_work = 0, contact_work = 0, damping_work = 0;  ///< J

  void receive(const Vec3& impulse) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double component = impulse[static_cast<Eigen::Index>(c)];
      received[c] += component;
      scale[c] += std::abs(component);
    }
  }
};

}  // namespace tuft::dem

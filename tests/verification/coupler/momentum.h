#pragma once
#include "coupler/simulation.h"

namespace tuft::coupler {

/// kg m/s, of carpet and infill.
inline Vec3 momentum(const Simulation& s) {
  Vec3 sum(0, 0, 0);
  const fe::NodeView n = s.carpet().nodes();
  for (std::size_t i = 0; i < n.x.size(); ++i) sum += n.mass[i] * Vec3(n.vx[i], n.vy[i], n.vz[i]);
  const ParticleView p = s.infill().particles();
  for (std::size_t i = 0; i < p.size(); ++i) sum += p.mass[i] * p.velocity(i);
  return sum;
}

}  // namespace tuft::coupler

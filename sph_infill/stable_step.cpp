#include "sph_infill/stable_step.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include "core/vector.h"
#include "sph_infill/particle_packs.h"

namespace tuft::sph {
namespace {

/// Points of a cubic lattice of pitch 1 around one, and B times the kernel's slopes towards them.
struct LatticeStencil {
  std::vector<Vec3> at, slope;

  /// Squared length of what a row of it sees of the wave exp(i k.x).
  [[nodiscard]] double seen(const Vec3& k) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t j = 0; j < at.size(); ++j) sum += std::sin(k.dot(at[j])) * slope[j];
    return sum.squaredNorm();
  }
  [[nodiscard]] double length_squared() const {
    double sum = 0;
    for (const Vec3& s : slope) sum += s.squaredNorm();
    return sum;
  }
};

LatticeStencil stencil_of(const SphOptions& options, double pitch) {
  LatticeStencil stencil;
  const double support = 2 * options.smoothing_length / pitch;
  const int n = static_cast<int>(support);
  double moment = 0;  // B = 1/moment: a cubic lattice is isotropic
  with_kernel(options, [&](const auto kernel) {
    for (int x = -n; x <= n; ++x)
      for (int y = -n; y <= n; ++y)
        for (int z = -n; z <= n; ++z) {
          const Vec3 at(x, y, z);
          const double squared = at.squaredNorm();
          if (squared == 0 || squared >= support * support) continue;
          const double slope = -kernel.slope_over_distance(squared * pitch * pitch);
          moment += slope * x * x;
          stencil.at.push_back(at);
          stencil.slope.push_back(slope * at);
        }
  });
  for (Vec3& s : stencil.slope) s /= moment;
  return stencil;
}

}  // namespace

double wave_coherence(const SphOptions& options, double pitch) {
  const LatticeStencil stencil = stencil_of(options, pitch);
  if (stencil.at.empty()) return 1;  // no neighbours, no waves
  // The largest of a grid over the wave vectors that differ, then uphill from there.
  constexpr int steps = 16;
  double step = std::numbers::pi / steps, largest = 0;
  Vec3 best = Vec3::Zero();
  const auto look = [&](const Vec3& k) {
    const double seen = stencil.seen(k);
    if (seen <= largest) return false;
    largest = seen, best = k;
    return true;
  };
  for (int x = 0; x <= steps; ++x)
    for (int y = 0; y <= x; ++y)
      for (int z = 0; z <= y; ++z) look(step * Vec3(x, y, z));
  for (step /= 2; step > 1e-3; step /= 2)
    for (bool higher = true; higher;) {
      higher = false;
      for (int axis = 0; axis < 3; ++axis)
        for (const double by : {-step, step}) higher = look(best + by * Vec3::Unit(axis)) || higher;
    }
  return std::sqrt(largest / stencil.length_squared());
}

StepLimit make_step_limit(const SphOptions& options, double pitch, bool artificial_viscosity,
                          bool zero_energy_control) {
  StepLimit limit{options.smoothing_length};
  const double coherence = wave_coherence(options, pitch);
  limit.coherence_squared = coherence * coherence;
  limit.lattice_volume = pitch * pitch * pitch;
  if (artificial_viscosity) {
    limit.viscosity_linear = options.viscosity_linear;
    limit.viscosity_quadratic = options.viscosity_quadratic;
  }
  if (zero_energy_control) limit.zero_energy_viscosity = options.zero_energy_viscosity;
  return limit;
}

}  // namespace tuft::sph

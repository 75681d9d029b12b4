#include "sph_infill/stable_step.h"

#include <numbers>
#include <vector>

#include "core/vector.h"
#include "sph_infill/particle_packs.h"

namespace tuft::sph {
namespace {

/// Points of a cubic lattice around one. Lengths over the pitch.
struct LatticeStencil {
  struct Point {
    Vec3 at, slope;     ///< its place, and V B g towards it
    double weight = 0;  ///< V s, s = -(dW/dr / r)
  };
  std::vector<Point> points;
  double smoothing_length = 0;

  [[nodiscard]] double length_squared() const {
    double sum = 0;
    for (const Point& p : points) sum += p.slope.squaredNorm();
    return sum;
  }
};

LatticeStencil stencil_of(const SphOptions& options, double pitch) {
  LatticeStencil stencil;
  stencil.smoothing_length = options.smoothing_length / pitch;
  const double support = 2 * stencil.smoothing_length;
  const int n = static_cast<int>(support);
  double moment = 0;  // 1/B: a cubic lattice is isotropic
  with_kernel(options, [&](const auto kernel) {
    for (int x = -n; x <= n; ++x)
      for (int y = -n; y <= n; ++y)
        for (int z = -n; z <= n; ++z) {
          const Vec3 at(x, y, z);
          const double squared = at.squaredNorm();
          if (squared == 0 || squared >= support * support) continue;
          const double weight = -kernel.slope_over_distance(squared * pitch * pitch) * std::pow(pitch, 5);
          moment += weight * x * x;
          stencil.points.push_back({at, Vec3::Zero(), weight});
        }
  });
  for (LatticeStencil::Point& p : stencil.points) p.slope = p.weight / moment * p.at;
  return stencil;
}

/// What becomes of the wave exp(i k.x): frequency and rate of damping, over c/pitch.
struct Wave {
  double frequency_squared = 0, damping = 0;
  /// Over pitch/c: omega^2 dt^2 + 2 c dt = 4.
  [[nodiscard]] double longest_step() const {
    return 4 / (damping + std::sqrt(damping * damping + 4 * frequency_squared));
  }
};

/// Viscous forces as in kick_pass.cpp, on a wave along k, of matter that moves along what a row sees of it.
Wave wave_of(const LatticeStencil& stencil, const Vec3& k, double alpha, double zeta) {
  Vec3 seen = Vec3::Zero(), weighed = Vec3::Zero();
  Mat3 viscous = Mat3::Zero();
  double spread = 0;
  const double h = stencil.smoothing_length;
  for (const LatticeStencil::Point& p : stencil.points) {
    const double phase = k.dot(p.at), part = 1 - std::cos(phase);
    seen += std::sin(phase) * p.slope;
    weighed += std::sin(phase) * p.weight * p.at;
    spread += p.weight * part;
    viscous += p.weight * part / (p.at.squaredNorm() + 0.01 * h * h) * p.at * p.at.transpose();
  }
  Wave wave{seen.squaredNorm(), 0};
  const Vec3 along = wave.frequency_squared > 0 ? Vec3(seen.normalized()) : Vec3(k.normalized());
  wave.damping = alpha * h * along.dot(viscous * along) + zeta * h * (2 * spread - seen.dot(weighed));
  return wave;
}

/// The largest value(k) of the wave vectors that differ: of a grid, then uphill from there.
template <class Value>
double largest_of_waves(Value&& value) {
  constexpr int steps = 16;
  double step = std::numbers::pi / steps, largest = 0;
  Vec3 best = Vec3::Zero();
  const auto look = [&](const Vec3& k) {
    const double found = value(k);
    if (!(found > largest)) return false;
    largest = found, best = k;
    return true;
  };
  for (int x = 1; x <= steps; ++x)
    for (int y = 0; y <= x; ++y)
      for (int z = 0; z <= y; ++z) look(step * Vec3(x, y, z));
  for (step /= 2; step > 1e-3; step /= 2)
    for (bool higher = true; higher;) {
      higher = false;
      for (int axis = 0; axis < 3; ++axis)
        for (const double by : {-step, step}) higher = look(best + by * Vec3::Unit(axis)) || higher;
    }
  return largest;
}

}  // namespace

LatticeWaves lattice_waves(const SphOptions& options, double pitch, double alpha, double zeta) {
  const LatticeStencil stencil = stencil_of(options, pitch);
  if (stencil.points.empty()) return {};  // no neighbours, no waves
  const double frequency =
      std::sqrt(largest_of_waves([&](const Vec3& k) { return wave_of(stencil, k, 0, 0).frequency_squared; }));
  LatticeWaves waves{frequency / std::sqrt(stencil.length_squared()), 0};
  if (alpha == 0 && zeta == 0) return waves;
  const double step = 1 / largest_of_waves([&](const Vec3& k) {
                        return 1 / wave_of(stencil, k, alpha, zeta).longest_step();
                      });
  const double share = 0.5 * step * frequency;  // sqrt(1 + xi^2) - xi
  waves.damping = (1 - share * share) / (2 * share);
  return waves;
}

StepLimit make_step_limit(const SphOptions& options, double pitch, bool artificial_viscosity,
                          bool zero_energy_control) {
  StepLimit limit{options.smoothing_length};
  if (artificial_viscosity) {
    limit.viscosity_linear = options.viscosity_linear;
    limit.viscosity_quadratic = options.viscosity_quadratic;
  }
  if (zero_energy_control) limit.zero_energy_viscosity = options.zero_energy_viscosity;
  const LatticeWaves waves =
      lattice_waves(options, pitch, limit.viscosity_linear, limit.zero_energy_viscosity);
  limit.coherence_squared = waves.coherence * waves.coherence;
  limit.damping_inside = waves.damping;
  if (limit.viscosity_quadratic > 0) limit.damping_per_alpha = lattice_waves(options, pitch, 1, 0).damping;
  limit.lattice_volume = pitch * pitch * pitch;
  return limit;
}

}  // namespace tuft::sph

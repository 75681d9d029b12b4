#pragma once
/// What the verification cases share: numerics to vary, contact with Coulomb friction, the energy ledger.
///
/// A case is a function from its sizes and numerics to what was measured. Tests hold the measured against
/// bounds, tests/validation/sph_infill tabulates it at more pitches and numerics.
#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph::test {

/// What the measurements vary.
struct Numerics {
  Preset preset = Preset::accurate;
  double alpha = 0.3;  ///< linear artificial viscosity; its quadratic term is 2 alpha; 0: off
  double zeta = 0;     ///< control of zero-energy modes; 0: off
};

inline void PrintTo(const Numerics& n, std::ostream* os) {
  PrintTo(n.preset, os);
  *os << " alpha " << n.alpha << " zeta " << n.zeta;
}

inline SphSettings settings_of(const Numerics& numerics, double pitch, const Vec3& gravity) {
  SphSettings settings;
  settings.options = options_of(numerics.preset, pitch);
  settings.options.viscosity_linear = numerics.alpha;
  settings.options.viscosity_quadratic = 2 * numerics.alpha;
  settings.options.zero_energy_viscosity = numerics.zeta;
  settings.artificial_viscosity = numerics.alpha > 0;
  settings.zero_energy_control = numerics.zeta > 0;
  settings.gravity = gravity;
  return settings;
}

/// Numerics, and what holds rows: springs of half a row with rows that strain shares of their cells, as beds
/// of scenes do, or stiff springs and whole cells.
struct RowNumerics {
  Numerics numerics;
  bool half_rows = false;
};

inline void PrintTo(const RowNumerics& n, std::ostream* os) {
  PrintTo(n.numerics, os);
  *os << (n.half_rows ? " half rows" : "");
}

/// block() as those numerics have it.
inline Lattice block_of(const RowNumerics& rows, int nx, int ny, int nz, double pitch) {
  if (!rows.half_rows) return block(nx, ny, nz, pitch);
  Turf turf;
  turf.layers = {{0, nz * pitch}};
  return make_bed(turf, {{nx * pitch, ny * pitch}, 0}, settings_of(rows.numerics, pitch, {0, 0, 0}).options);
}

/// A wall with Coulomb friction: the impulse along it takes what sliding there is, up to friction times the
/// impulse across it.
struct FrictionPlane {
  PenaltyPlane plane;
  double friction = 0;

  double push(const ParticleView& p, double window, ContactImpulses& impulses) const {
    double stored = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double overlap = p.radius[i] - plane.normal.dot(p.position(i) - plane.point);
      if (overlap <= 0) continue;
      const Vec3 velocity = p.velocity(i);
      const double speed = plane.normal.dot(velocity);
      const double dashpot = 2 * plane.damping_ratio * std::sqrt(plane.stiffness * p.mass[i]);
      const double across = std::max(0.0, window * (plane.stiffness * overlap - dashpot * speed));
      const Vec3 sliding = velocity - speed * plane.normal;
      const double slip = sliding.norm();
      Vec3 impulse = across * plane.normal;
      if (slip > 0) impulse -= std::min(p.mass[i], friction * across / slip) * sliding;
      impulses.linear.add(i, impulse);
      stored += 0.5 * plane.stiffness * overlap * overlap;
    }
    return stored;
  }
};

/// A step that walls of stiffness `stiffness_over_modulus` x constrained modulus x pitch bear: dt < 2/omega
/// of spring and particle, and in a corner of the box the material's own forces come on top.
inline double step_with_walls(const SphInfill& infill, double stiffness, double share = 0.8) {
  const ParticleView p = infill.particles();
  const double lightest = *std::ranges::min_element(p.mass);
  const double wall = 2 * std::sqrt(lightest / stiffness), own = infill.stable_step();
  return share / std::sqrt(1 / (wall * wall) + 1 / (own * own));
}

/// Follows total energy from the first entry on.
struct EnergyLedger {
  double first = 0, worst = 0;  ///< J
  bool begun = false;
  void enter(const InfillEnergy& e) {
    const double now = total(e);
    if (!begun) first = now, begun = true;
    worst = std::max(worst, std::abs(now - first));
  }
};

inline double smallest_distance(const ParticleView& p) {
  double found = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      found = std::min(found, (p.position(i) - p.position(j)).squaredNorm());
  return std::sqrt(found);
}

/// Share of particles that have another nearer than `distance`; by cells of that size.
inline double share_closer_than(const ParticleView& p, double distance) {
  std::map<std::array<long, 3>, std::vector<std::size_t>> cells;
  const auto cell = [&](std::size_t i) {
    return std::array<long, 3>{std::lround(p.x[i] / distance), std::lround(p.y[i] / distance),
                               std::lround(p.z[i] / distance)};
  };
  for (std::size_t i = 0; i < p.size(); ++i) cells[cell(i)].push_back(i);
  std::size_t count = 0;
  const auto has_other = [&](std::size_t i) {
    const auto [x, y, z] = cell(i);
    for (long a = x - 1; a <= x + 1; ++a)
      for (long b = y - 1; b <= y + 1; ++b)
        for (long c = z - 1; c <= z + 1; ++c)
          if (const auto found = cells.find({a, b, c}); found != cells.end())
            for (const std::size_t j : found->second)
              if (j != i && (p.position(i) - p.position(j)).norm() < distance) return true;
    return false;
  };
  for (std::size_t i = 0; i < p.size(); ++i) count += has_other(i);
  return static_cast<double>(count) / static_cast<double>(p.size());
}

inline bool all_finite(const ParticleView& p) {
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!p.position(i).allFinite() || !p.velocity(i).allFinite()) return false;
  return true;
}

}  // namespace tuft::sph::test

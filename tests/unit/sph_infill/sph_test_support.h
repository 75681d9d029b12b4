#pragma once
/// Materials, blocks of particles and walls for tests of SPH infill.
#include <cmath>
#include <ostream>
#include <random>

#include "sph_infill/sph_infill.h"

namespace tuft::sph::test {

/// Elastic in all that tests do: unloads as it loads, too strong to yield, no cutoff in reach.
inline SoilFoamMaterial elastic_material(double bulk_modulus, double density, double shear_ratio = 0.5) {
  SoilFoamMaterial m;
  m.density = density;
  m.pressure = {{0, 1}, {0, bulk_modulus}};
  m.unloading = {{0}, {bulk_modulus}};
  m.shear_ratio = shear_ratio;
  m.yield_a0 = 1e30;
  m.tension_cutoff = 1e15;
  return m;
}

/// The mixture of PHYSICS.md section 8, loose: P = (K0/b)(exp(b e) - 1), K_un = r (K0 + b p), tabulated.
inline SoilFoamMaterial mixture_material() {
  SoilFoamMaterial m;
  const double k0 = 1.5e6, b = 10, r = 1.2, alpha = 0.35, cohesion = 20e3;
  m.density = 977;
  for (int k = 0; k <= 40; ++k) {
    const double e = 0.01 * k;
    m.pressure.x.push_back(e);
    m.pressure.y.push_back(k0 / b * std::expm1(b * e));
  }
  m.unloading = {{0, 1e6}, {r * k0, r * (k0 + b * 1e6)}};
  m.shear_ratio = 0.5;
  m.yield_a0 = cohesion * cohesion;
  m.yield_a1 = 2 * cohesion * alpha;
  m.yield_a2 = alpha * alpha;
  m.tension_cutoff = 20e3;
  return m;
}

/// The same as closed forms, with parameters for every effect of the law.
inline SoilFoamMaterial mixture_with_effects() {
  SoilFoamMaterial m = mixture_material();
  m.pressure = m.unloading = {};
  m.pressure_exponential = ExponentialCompression{1.5e6, 10};
  m.unloading_ratio = 1.2;
  m.density_hardening = DensityHardening{4, 2, 0.5};
  m.strength_softening = StrengthSoftening{0.05, 0.2, 0.8};
  m.strength_recovery = StrengthRecovery{0.5, 0.02};
  m.strength_rate = StrengthRate{0.05, 0.1};
  m.inertial_friction = InertialFriction{0.7, 0.279, 0.001, 2450};
  m.dilation_angle = 0.15;
  return m;
}
inline constexpr SoilEffects all_soil_effects{true, true, true, true, true, true, true};

inline std::vector<Material> single_material(const SoilFoamMaterial& continuum) {
  Material material;
  material.name = "test";
  material.file = "test.toml";
  material.continuum = continuum;
  material.bulk_density = continuum.density;
  return {material};
}

enum class Preset { accurate, fast, paper };
/// Names the cases of parameterised tests.
inline void PrintTo(Preset preset, std::ostream* os) {
  *os << (preset == Preset::accurate ? "accurate" : preset == Preset::fast ? "fast" : "paper");
}

inline SphOptions options_of(Preset preset, double pitch) {
  SphOptions options;
  options.pitch = pitch;
  options.preset = preset == Preset::paper ? "paper" : preset == Preset::fast ? "fast" : "accurate";
  options.kernel = preset == Preset::accurate ? Kernel::wendland_c2 : Kernel::cubic_spline;
  options.smoothing_length = (preset == Preset::paper ? 0.71 : preset == Preset::fast ? 1.0 : 1.3) * pitch;
  return options;
}

/// nx x ny x nz particles, corner at (-nx/2, -ny/2, 0) pitch.
inline Lattice block(int nx, int ny, int nz, double pitch) {
  Turf turf;
  turf.layers = {{0, nz * pitch}};
  return make_lattice(turf, {{nx * pitch, ny * pitch}, 0}, pitch);
}

/// Shifts every particle by up to `share` of the pitch in each direction.
inline void jitter(Lattice& lattice, double share, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> shift(-share * lattice.pitch, share * lattice.pitch);
  for (std::size_t i = 0; i < lattice.position.size(); ++i)
    lattice.position.add(i, {shift(random), shift(random), shift(random)});
}

/// Frictionless wall: particles closer than their radius are pushed along the normal by a linear spring with
/// a light dashpot, as the coupler's contact does. Keeps its stored and dissipated energy, so that tests can
/// balance.
struct PenaltyPlane {
  Vec3 point{0, 0, 0}, normal{0, 0, 1};
  double stiffness = 0;  ///< N/m
  double damping_ratio = 0;

  /// Adds the impulse over `window` to each particle; returns the spring energy at these positions.
  double push(const ParticleView& p, double window, ContactImpulses& impulses) const {
    double stored = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double overlap = p.radius[i] - normal.dot(p.position(i) - point);
      if (overlap <= 0) continue;
      const double speed = normal.dot(p.velocity(i));
      const double dashpot = 2 * damping_ratio * std::sqrt(stiffness * p.mass[i]);
      impulses.linear.add(i, window * (stiffness * overlap - dashpot * speed) * normal);
      stored += 0.5 * stiffness * overlap * overlap;
    }
    return stored;
  }
};

/// Walls of a box, open on top.
struct Tray {
  std::vector<PenaltyPlane> planes;

  Tray(double side_x, double side_y, double stiffness, double damping_ratio) {
    const auto add = [&](const Vec3& point, const Vec3& normal) {
      planes.push_back({point, normal, stiffness, damping_ratio});
    };
    add({0, 0, 0}, {0, 0, 1});
    add({-side_x / 2, 0, 0}, {1, 0, 0});
    add({side_x / 2, 0, 0}, {-1, 0, 0});
    add({0, -side_y / 2, 0}, {0, 1, 0});
    add({0, side_y / 2, 0}, {0, -1, 0});
  }
  double push(const ParticleView& p, double window, ContactImpulses& impulses) const {
    impulses.linear.assign(p.size(), 0);
    double stored = 0;
    for (const PenaltyPlane& plane : planes) stored += plane.push(p, window, impulses);
    return stored;
  }
};

inline std::vector<double> field(const SphInfill& infill, std::string_view name) {
  for (auto& f : infill.fields())
    if (f.name == name) return f.values;
  throw std::runtime_error("no field " + std::string(name));
}

inline double total(const InfillEnergy& e) {
  return e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping - e.contact_work;
}

}  // namespace tuft::sph::test

#pragma once
/// Small scenes of grains for tests through the real host.
#include <vector>

#include "dem_bridge/dem_infill.h"

namespace tuft::dem::test {

inline Material grain_material(double young, double poisson, double density, double restitution,
                               double friction) {
  Material material;
  material.name = "test grain";
  material.grain = GrainMaterial{.density = density,
                                 .young_modulus = young,
                                 .poisson_ratio = poisson,
                                 .restitution = restitution,
                                 .friction = friction,
                                 .rolling_friction = 0.1,
                                 .diameter_min = 0.001,
                                 .diameter_max = 0.002};
  return material;
}

/// Rubber-like grains: soft enough for steps of microseconds.
inline Material rubber() {
  return grain_material(8e6, 0.45, 1150, 0.5, 0.6);
}

inline void add_grain(Grains& grains, const Vec3& position, double radius, double density) {
  grains.position.push_back(position);
  grains.radius.push_back(radius);
  grains.density.push_back(density);
  grains.layer.push_back(0);
  grains.material.push_back(0);
}

inline DemSettings settings_in_box(double half_size, const Vec3& gravity = Vec3(0, 0, 0)) {
  DemSettings settings;
  settings.gravity = gravity;
  settings.rolling_resistance = false;
  settings.box = {Vec3::Constant(-half_size), Vec3::Constant(half_size)};
  settings.options.answer_timeout = 20;
  return settings;
}

inline ContactImpulses no_impulses(std::size_t count) {
  ContactImpulses contact;
  contact.linear.assign(count, 0.0);
  contact.angular.assign(count, 0.0);
  return contact;
}

/// A regular block of grains with small gaps, shaken by deterministic velocities: collisions of every kind.
struct ShakenBlock {
  Grains grains;
  std::vector<Material> materials{rubber()};
  double half_width = 0;  ///< of the walls that `confine` makes

  explicit ShakenBlock(int per_side, double radius = 0.001) {
    const double pitch = 2.05 * radius;
    half_width = 0.5 * pitch * per_side;
    for (int k = 0; k < per_side; ++k)
      for (int j = 0; j < per_side; ++j)
        for (int i = 0; i < per_side; ++i)
          add_grain(grains,
                    Vec3(i + 0.5, j + 0.5, k + 0.5) * pitch - Vec3(half_width, half_width, half_width),
                    radius * (1.0 - 0.02 * ((i + 2 * j + 3 * k) % 5)), 1150);
  }
  void shake(DemInfill& infill, double speed) const {
    for (std::size_t i = 0; i < grains.size(); ++i) {
      const double a = 1.0 + static_cast<double>(i) * 0.7, b = 2.0 + static_cast<double>(i) * 1.3;
      infill.set_velocity(i, speed * Vec3(std::sin(a), std::cos(b), std::sin(a + b)),
                          200 * speed * Vec3(std::cos(a), std::sin(b), std::cos(a - b)));
    }
  }
  /// Penalty walls on all six sides, and friction on none.
  [[nodiscard]] ContactImpulses confine(const DemInfill& infill, double window) const {
    constexpr double stiffness = 2e3;  // N/m
    const ParticleView view = infill.particles();
    ContactImpulses contact = no_impulses(view.size());
    for (std::size_t i = 0; i < view.size(); ++i) {
      Vec3 force(0, 0, 0);
      for (int c = 0; c < 3; ++c) {
        const double low = view.radius[i] - half_width - view.position(i)[c];
        const double high = view.radius[i] - half_width + view.position(i)[c];
        if (low > 0) force[c] += stiffness * low;
        if (high > 0) force[c] -= stiffness * high;
      }
      contact.linear.set(i, window * force);
    }
    return contact;
  }
};

}  // namespace tuft::dem::test

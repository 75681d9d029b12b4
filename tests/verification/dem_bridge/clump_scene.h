#pragma once
/// Small scenes of clumps for tests through the real host.
#include <algorithm>
#include <cmath>

#include "dem_bridge/clump_bodies.h"
#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {

inline Material clumped(const Clump& clump, double restitution = 0.5, double friction = 0.6) {
  Material material = grain_material(8e6, 0.45, 1150, restitution, friction);
  material.grain->clump = clump;
  return material;
}

/// A clump of material 0; `turn` turns its principal axes, which fall in moment, out of those of space.
inline void add_clump(Grains& grains, const Material& material, const Vec3& centre, double diameter,
                      const Mat3& turn = Mat3::Identity()) {
  const ClumpBody body = make_clump_body(*material.grain->clump, material.name);
  const Index number =
      grains.body.empty() ? 0 : *std::max_element(grains.body.begin(), grains.body.end()) + 1;
  for (std::size_t k = 0; k < body.size(); ++k) {
    add_grain(grains, centre + diameter * (turn * body.centre[k]), diameter * body.radius[k],
              material.grain->density);
    grains.body.push_back(number);
  }
}

inline Mat3 turn_about(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// A block of clumps of many turns, some spheres of another kind among them, in walls of springs.
struct ClumpBlock {
  Grains grains;
  std::vector<Material> materials;
  double half_width = 0;
  static constexpr double diameter = 0.002;  ///< m, of the sphere of the largest clump's volume

  ClumpBlock(const Clump& clump, int per_side, bool with_spheres, double restitution = 0.5)
      : materials{clumped(clump, restitution), grain_material(2e7, 0.3, 2000, restitution, 0.4)} {
    const double pitch = 1.1 * diameter;
    half_width = 0.5 * pitch * per_side;
    for (int k = 0; k < per_side; ++k)
      for (int j = 0; j < per_side; ++j)
        for (int i = 0; i < per_side; ++i) {
          const Vec3 x = pitch * Vec3(i + 0.5, j + 0.5, k + 0.5) - Vec3::Constant(half_width);
          const int n = i + per_side * (j + per_side * k);
          if (with_spheres && n % 3 == 1) {
            add_grain(grains, x, 0.4 * diameter, 2000);
            grains.material.back() = 1;
            grains.body.push_back(-1);
          } else {
            add_clump(grains, materials[0], x, diameter * (1 - 0.02 * (n % 5)),
                      turn_about(Vec3(std::sin(n), std::cos(2 * n), std::sin(3 * n + 1)), n));
          }
        }
  }
  void shake(DemInfill& infill, double speed) const {
    for (std::size_t i = 0; i < grains.size(); ++i) {
      if (i > 0 && grains.body[i] >= 0 && grains.body[i] == grains.body[i - 1]) continue;
      const double a = 1.0 + static_cast<double>(i) * 0.7, b = 2.0 + static_cast<double>(i) * 1.3;
      infill.set_velocity(i, speed * Vec3(std::sin(a), std::cos(b), std::sin(a + b)),
                          200 * speed * Vec3(std::cos(a), std::sin(b), std::cos(a - b)));
    }
  }
  [[nodiscard]] ContactImpulses confine(const DemInfill& infill, double window) const {
    ShakenBlock walls(1);
    walls.half_width = half_width;
    return walls.confine(infill, window);
  }
};

/// Where a body is now, by its spheres.
inline GrainBodies bodies_now(const DemInfill& infill, const Grains& grains,
                              const std::vector<Material>& materials) {
  Grains moved = grains;
  for (std::size_t i = 0; i < grains.size(); ++i) moved.position.set(i, infill.particles().position(i));
  return find_bodies(moved, materials);
}

struct Motion {
  Vec3 momentum{0, 0, 0}, angular_momentum{0, 0, 0};  ///< of all bodies, about the origin
};
/// From velocities and spins of the spheres; spins half a step before positions.
inline Motion motion_of(const DemInfill& infill, const Grains& grains,
                        const std::vector<Material>& materials) {
  Motion motion;
  const ParticleView view = infill.particles();
  const GrainBodies found = bodies_now(infill, grains, materials);
  for (const GrainBody& body : found.bodies) {
    Vec3 velocity(0, 0, 0);
    for (std::size_t k = 0; k < body.count; ++k)
      velocity += found.shape_of(body).share[k] * view.velocity(body.first + k);
    const Mat3 inertia = body.axes * found.inertia_of(body).asDiagonal() * body.axes.transpose();
    motion.momentum += body.mass * velocity;
    motion.angular_momentum += body.centre.cross(body.mass * velocity) + inertia * view.spin(body.first);
  }
  for (std::size_t i = 0; i < grains.size(); ++i) {
    if (grains.body[i] >= 0) continue;
    const Vec3 momentum = view.mass[i] * view.velocity(i);
    motion.momentum += momentum;
    motion.angular_momentum += view.position(i).cross(momentum) +
                               0.4 * view.mass[i] * view.radius[i] * view.radius[i] * view.spin(i);
  }
  return motion;
}

inline double total_energy(const InfillEnergy& e) {
  return e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping + e.expelled - e.contact_work;
}

}  // namespace tuft::dem::test

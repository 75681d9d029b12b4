#include "tests/verification/sph_infill/cases/free_bodies.h"

#include <Eigen/Geometry>
#include <numbers>

namespace tuft::sph::test {
namespace {

/// Particles of a block that lie within a cylinder about the z axis.
Lattice disc(const DiscSizes& sizes) {
  const Lattice whole = block(2 * sizes.radius, 2 * sizes.radius, sizes.thickness, sizes.pitch);
  Lattice lattice;
  lattice.pitch = whole.pitch;
  for (std::size_t i = 0; i < whole.position.size(); ++i) {
    const Vec3 x = whole.position[i];
    if (std::hypot(x.x(), x.y()) > sizes.radius * sizes.pitch) continue;
    lattice.position.push_back(x);
    lattice.volume.push_back(whole.volume[i]);
    lattice.layer.push_back(0);
    lattice.material.push_back(0);
  }
  return lattice;
}

}  // namespace

DiscResult spinning_disc(const Numerics& numerics, const DiscSizes& sizes) {
  const double bulk = 1e6, density = 1000, speed = std::sqrt(bulk * 5 / 3 / density);
  const Lattice lattice = disc(sizes);
  const std::size_t n = lattice.position.size();
  SphInfill infill(lattice, single_material(elastic_material(bulk, density)),
                   settings_of(numerics, sizes.pitch, {0, 0, 0}));
  const Vec3 spin(0, 0, sizes.speed * speed / (sizes.radius * sizes.pitch));
  for (std::size_t i = 0; i < n; ++i) infill.set_velocity(i, spin.cross(lattice.position[i]));
  const auto shape = [&](double& radius, Vec3& momentum) {
    const ParticleView p = infill.particles();
    radius = 0;
    momentum = Vec3(0, 0, 0);
    for (std::size_t i = 0; i < n; ++i) {
      radius += p.x[i] * p.x[i] + p.y[i] * p.y[i];
      momentum += p.mass[i] * p.position(i).cross(p.velocity(i));
    }
    radius = std::sqrt(radius / static_cast<double>(n));
  };
  DiscResult result;
  double radius_before = 0, radius = 0;
  Vec3 momentum_before, momentum;
  shape(radius_before, momentum_before);
  EnergyLedger ledger;
  double kinetic = 0;
  const double end = 2 * std::numbers::pi * sizes.turns / spin.z();
  double time = 0;
  while (time < end) {
    const double dt = 0.8 * infill.stable_step();
    infill.advance(dt, 1, {});
    ledger.enter(infill.energy());
    if (time == 0) kinetic = infill.energy().kinetic;
    time += dt;
  }
  shape(radius, momentum);
  result.radius = radius / radius_before;
  result.energy_error = ledger.worst / kinetic;
  result.kinetic = (infill.energy().kinetic + infill.energy().stored) / kinetic;
  result.angular_momentum = momentum.z() / momentum_before.z();
  result.smallest_distance = smallest_distance(infill.particles()) / sizes.pitch;
  // The turn that it has really made, from its particles.
  const ParticleView p = infill.particles();
  double sine = 0, cosine = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 a = lattice.position[i], b = p.position(i);
    sine += a.x() * b.y() - a.y() * b.x();
    cosine += a.x() * b.x() + a.y() * b.y();
  }
  const Mat3 turn = Eigen::AngleAxisd(std::atan2(sine, cosine), Vec3(0, 0, 1)).toRotationMatrix();
  for (std::size_t i = 0; i < n; ++i)
    result.out_of_shape =
        std::max(result.out_of_shape, (p.position(i) - turn * lattice.position[i]).norm() / sizes.pitch);
  return result;
}

double falling_slab(const Numerics& numerics, double drop, bool cohesion) {
  const double pitch = 0.002, g = 9.81;
  Lattice lattice = block(12, 6, 4, pitch);
  jitter(lattice, 0.1);
  SoilFoamMaterial material = mixture_material();
  if (!cohesion) material.yield_a0 = material.yield_a1 = material.tension_cutoff = 0;
  SphInfill infill(lattice, single_material(material), settings_of(numerics, pitch, {0, 0, -g}));
  const Vec3 thrown(0.7, -0.2, 0.1);
  for (std::size_t i = 0; i < lattice.position.size(); ++i) infill.set_velocity(i, thrown);
  const double time = std::sqrt(2 * drop * 4 * pitch / g);
  infill.advance(time, static_cast<int>(std::ceil(time / (0.8 * infill.stable_step()))), {});
  const ParticleView p = infill.particles();
  const Vec3 moved = p.position(0) - lattice.position[0];
  double worst = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    worst = std::max(worst, (p.position(i) - lattice.position[i] - moved).norm());
  return worst / pitch;
}

}  // namespace tuft::sph::test

/// Beds of grains and of SPH particles at rest between frictionless walls: one code finds in both that the
/// stress at a height is the weight above it.
#include <gtest/gtest.h>

#include <functional>

#include "micro_scale/coarse_fields.h"
#include "micro_scale/field_comparison.h"
#include "micro_scale/network_statistics.h"
#include "tests/unit/sph_infill/sph_test_support.h"
#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::micro {
namespace {

constexpr double g = 9.81, side = 0.016;  // m, of the square tray

/// What the walls push, as contacts with bodies.
ContactNetwork wall_contacts(const sph::test::Tray& tray, const ParticleView& p) {
  ContactNetwork network;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t w = 0; w < tray.planes.size(); ++w) {
      const sph::test::PenaltyPlane& plane = tray.planes[w];
      const double overlap = p.radius[i] - plane.normal.dot(p.position(i) - plane.point);
      if (overlap <= 0) continue;
      const double dashpot = 2 * plane.damping_ratio * std::sqrt(plane.stiffness * p.mass[i]);
      const double force = plane.stiffness * overlap - dashpot * plane.normal.dot(p.velocity(i));
      network.add(ContactKind::body, static_cast<Index>(i), static_cast<Index>(w),
                  -p.radius[i] * plane.normal, plane.normal, force * plane.normal, overlap);
    }
  return network;
}

void append(ContactNetwork& network, const ContactNetwork& more) {
  for (std::size_t c = 0; c < more.size(); ++c)
    network.add(more.kind[c], more.particle[c], more.other[c], more.branch[c], -more.branch[c].normalized(),
                more.force(c), more.overlap[c]);
}

struct Bed {
  double geostatic_error =
      0;  ///< largest |-sigma_zz - weight above|, over the whole weight, above the floor's reach
  double balance_error = 0;  ///< the same down to the floor, with what it bears
  double floor = 0;          ///< its force over the weight
  double lateral = 0;        ///< mean sigma_xx/sigma_zz in the lower half
};

Bed look_at(const Infill& infill, const sph::test::Tray& tray, double height) {
  const CoarseGrid grid =
      make_grid(Vec3(-0.5 * side, -0.5 * side, 0), Vec3(0.5 * side, 0.5 * side, height), 0.001);
  const double width = 0.003;
  ContactNetwork network = infill.contacts();
  append(network, wall_contacts(tray, infill.particles()));
  const auto moments = infill.stress_moments();
  const CoarseFields fields =
      coarse_grain(grid, lucy_kernel(width), infill.particles(), {{}, {}, moments}, network);
  EXPECT_EQ(fields.outside, 0u);
  const auto mean = [&](const auto& of_cell) {
    std::vector<double> values;
    for (std::size_t c = 0; c < grid.size(); ++c) values.push_back(of_cell(c));
    return profile(grid, values);
  };
  const std::vector<double> rho = mean([&](std::size_t c) { return fields.density[c]; }),
                            given = mean([&](std::size_t c) { return fields.boundary_force[c].z(); }),
                            zz = mean([&](std::size_t c) { return fields.stress[c](2, 2); }),
                            xx = mean([&](std::size_t c) { return fields.stress[c](0, 0); });
  const double h = grid.spacing.z();
  double weight = 0, above = 0, lateral = 0, vertical = 0;
  for (const double value : rho) weight += g * value * h;
  Bed bed;
  for (std::size_t k = rho.size(); k-- > 0;) {
    const double z = h * (static_cast<double>(k) + 0.5), here = h * (g * rho[k] - given[k]);
    const double error = std::abs(-zz[k] - (above + 0.5 * here)) / weight;
    if (z > 2 * width + h) bed.geostatic_error = std::max(bed.geostatic_error, error);
    bed.floor += h * given[k] / weight;
    if (z > 2 * width + h && z < 0.5 * height) lateral += xx[k], vertical += zz[k];
    above += here;
  }
  bed.lateral = lateral / vertical;
  return bed;
}

void print(const char* name, const Bed& bed, double kinetic) {
  std::printf("%s: geostatic error %.5f, floor over weight %.6f, lateral %.3f, kinetic %.2e\n", name,
              bed.geostatic_error, bed.floor, bed.lateral, kinetic);
}

TEST(BedAtRest, OfGrainsCarriesTheWeightAboveEachHeight) {
  constexpr double r = 0.00092;
  dem::Grains grains;
  for (int k = 0; k < 16; ++k)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i)
        dem::test::add_grain(
            grains,
            Vec3(0.002 * (i - 3.5) + 5e-5 * std::sin(7.0 * i + 3 * j + k),
                 0.002 * (j - 3.5) + 5e-5 * std::cos(5.0 * i + j + 2 * k), 0.001 + 0.0019 * k),
            r * (1 - 0.03 * ((i + 2 * j + 3 * k) % 5)), 1150);
  const std::vector<Material> materials{dem::test::rubber()};
  dem::DemInfill infill(grains, materials, dem::test::settings_in_box(0.05, Vec3(0, 0, -g)));
  const sph::test::Tray tray(side, side, 2e3, 0.2);
  ContactImpulses walls;
  walls.angular.assign(grains.size(), 0);
  const auto advance = [&](int windows, int substeps, double damping) {
    infill.set_damping(damping);
    const double window = 0.8 * substeps * infill.stable_step();
    for (int k = 0; k < windows; ++k) {
      tray.push(infill.particles(), window, walls);
      infill.advance(window, substeps, walls);
    }
  };
  advance(2500, 8, 30);
  advance(3000, 8, 200);
  // Walls that push evenly for eight steps keep the grains on them trembling.
  advance(4000, 1, 200);
  const Bed bed = look_at(infill, tray, 0.032);
  print("dem", bed, infill.energy().kinetic);
  EXPECT_LT(bed.geostatic_error, 0.005);
  EXPECT_NEAR(bed.floor, 1, 0.002);
  EXPECT_GT(bed.lateral, 0.2);
  EXPECT_LT(bed.lateral, 1.5);
}

TEST(BedAtRest, OfSphParticlesCarriesTheWeightAboveEachHeight) {
  constexpr double pitch = 0.002;
  const auto materials = sph::test::single_material(sph::test::mixture_material());
  sph::SphSettings settings;
  settings.options = sph::test::options_of(sph::test::Preset::accurate, pitch);
  settings.gravity = Vec3(0, 0, -g);
  sph::SphInfill infill(sph::test::block(8, 8, 14, pitch), materials, settings);
  const double modulus = sph::constrained_modulus(*materials[0].continuum, 1e4);
  const sph::test::Tray tray(side, side, 10 * modulus * pitch, 0.1);
  ContactImpulses walls;
  infill.set_damping(2000);
  double dt = 0.5 * infill.stable_step();
  const double mass = infill.particles().mass[0], omega = std::sqrt(10 * modulus * pitch / mass);
  dt = std::min(dt, 0.5 / omega);
  for (int k = 0; k < 6000; ++k) {
    tray.push(infill.particles(), dt, walls);
    infill.advance(dt, 1, walls);
  }
  const Bed bed = look_at(infill, tray, 0.032);
  print("sph", bed, infill.energy().kinetic);
  EXPECT_LT(bed.geostatic_error, 0.01);
  EXPECT_NEAR(bed.floor, 1, 0.001);
}

}  // namespace
}  // namespace tuft::micro

/// How densely grains pack between bodies of the coupler.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/verification/coupler/loose_grains.h"

namespace tuft::coupler {
namespace {

constexpr double radius = 0.001, density = 1150, weight = 9.81;

void add_box(GrainCase& setup, double x, double y) {
  setup.bodies.push_back(half_space("floor", Vec3(0, 0, 0), Vec3(0, 0, 1)));
  setup.bodies.push_back(half_space("x_low", Vec3(-x, 0, 0), Vec3(1, 0, 0)));
  setup.bodies.push_back(half_space("x_high", Vec3(x, 0, 0), Vec3(-1, 0, 0)));
  setup.bodies.push_back(half_space("y_low", Vec3(0, -y, 0), Vec3(0, 1, 0)));
  setup.bodies.push_back(half_space("y_high", Vec3(0, y, 0), Vec3(0, -1, 0)));
}

/// Share of a box that spheres fill, by points drawn in it.
double share_filled(const ParticleView& p, const Vec3& low, const Vec3& high) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> even(0, 1);
  constexpr int points = 20000;
  int inside = 0;
  for (int n = 0; n < points; ++n) {
    const double x = even(random), y = even(random), z = even(random);
    const Vec3 at = low + (high - low).cwiseProduct(Vec3(x, y, z));
    for (std::size_t i = 0; i < p.size(); ++i)
      if ((p.position(i) - at).squaredNorm() < p.radius[i] * p.radius[i]) {
        ++inside;
        break;
      }
  }
  return static_cast<double>(inside) / points;
}

// Random close packing of equal spheres: 0.64 (Scott & Kilgour 1969, 0.6366). Walls order what lies at them:
// three diameters are left out.
TEST(EqualSmoothSpheres, PackToRandomClosePacking) {
  GrainCase setup;
  setup.materials = {dem::test::grain_material(2e7, 0.3, density, 0.3, 0)};
  setup.gravity = Vec3(0, 0, -weight);
  setup.damping_ratio = 0.3;
  add_box(setup, 14 * radius, 14 * radius);
  add_loose(setup, radius, density, {12, 12}, 2600, 2.3 * radius, 0, 7, [](double, double) { return true; });
  Simulation s = make(setup);
  settle(s, 40, 0.25);
  const ParticleView p = s.infill().particles();
  double top = 0;
  for (std::size_t i = 0; i < p.size(); ++i) top += p.z[i];
  top = 2 * top / static_cast<double>(p.size());
  const double in = 8 * radius;
  const double share = share_filled(p, Vec3(-in, -in, 6 * radius), Vec3(in, in, top - 5 * radius));
  std::printf("packing fraction %.4f, height %.3g mm\n", share, 1e3 * top);
  EXPECT_NEAR(share, 0.635, 0.015);
}

}  // namespace
}  // namespace tuft::coupler

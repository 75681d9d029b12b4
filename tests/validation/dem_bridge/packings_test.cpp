/// What a mass of grains does, between bodies of the coupler: packing fraction, Janssen's stress, angle of
/// repose.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/verification/coupler/grain_case.h"

namespace tuft::coupler {
namespace {

constexpr double radius = 0.001, density = 1150, weight = 9.81;

/// Grains on a loose cubic lattice with random shifts, from `low` upwards, `count` of them.
void add_loose(GrainCase& setup, const std::array<int, 2>& across, int count, double pitch, double low) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> shift(-0.5, 0.5);
  for (int n = 0; n < count; ++n) {
    const int layer = n / (across[0] * across[1]), in_layer = n % (across[0] * across[1]);
    const int i = in_layer % across[0], j = in_layer / across[0];
    const double room = pitch - 2 * radius;
    const double x = shift(random), y = shift(random), z = shift(random);
    dem::test::add_grain(
        setup.grains,
        Vec3((i - 0.5 * (across[0] - 1)) * pitch + room * x, (j - 0.5 * (across[1] - 1)) * pitch + room * y,
             low + (layer + 0.5) * pitch + room * z),
        radius, density);
  }
}

void add_box(GrainCase& setup, double x, double y) {
  setup.bodies.push_back(half_space("floor", Vec3(0, 0, 0), Vec3(0, 0, 1)));
  setup.bodies.push_back(half_space("x_low", Vec3(-x, 0, 0), Vec3(1, 0, 0)));
  setup.bodies.push_back(half_space("x_high", Vec3(x, 0, 0), Vec3(-1, 0, 0)));
  setup.bodies.push_back(half_space("y_low", Vec3(0, -y, 0), Vec3(0, 1, 0)));
  setup.bodies.push_back(half_space("y_high", Vec3(0, y, 0), Vec3(0, -1, 0)));
}

void settle(Simulation& s, double damping, double time) {
  s.set_damping(0, damping);
  for (int k = 0; k < std::lround(time / 1e-3); ++k) s.advance_interval(1e-3);
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
  add_loose(setup, {12, 12}, 2600, 2.3 * radius, 0);
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

// Janssen 1895: walls bear what friction on them can, sigma' = rho g - 4 mu K sigma/D, so the floor bears
// rho g D/(4 mu K) (1 - exp(-4 mu K H/D)). K is measured: the mean pressure on the walls over the mean axial
// stress, which follows from what the walls bear. The floor sinks a little, so that friction is mobilised
// downwards everywhere.
TEST(AFilledTube, BearsOnItsFloorWhatJanssenSays) {
  constexpr double bore = 8 * radius, mu = 0.4;
  GrainCase setup;
  setup.materials = {dem::test::grain_material(2e7, 0.3, density, 0.3, 0.5)};
  setup.gravity = Vec3(0, 0, -weight);
  setup.damping_ratio = 0.3;
  setup.bodies.push_back(half_space("floor", Vec3(0, 0, 0), Vec3(0, 0, 1)));
  setup.bodies[0].driven = true;
  RigidBody tube;
  tube.name = "tube";
  tube.shape = Bore{bore};
  tube.friction = FrictionLaw{mu, mu, 0};
  setup.bodies.push_back(tube);
  add_loose(setup, {4, 4}, 900, 2.3 * radius, 0);
  Simulation s = make(setup);
  settle(s, 40, 0.3);
  s.set_damping(0, 0);
  // Over two radii, slowly.
  s.drive_body(0, Vec3(0, 0, -0.01));
  double floor = 0, wall = 0, pressure = 0, height = 0;
  int count = 0;
  for (int k = 0; k < 200; ++k) {
    s.advance_interval(1e-3);
    if (k < 100) continue;
    floor -= s.interval_impulse()[0].z() / 1e-3;
    wall -= s.interval_impulse()[1].z() / 1e-3;
    const ContactNetwork network = s.boundary_contacts();
    for (std::size_t c = 0; c < network.size(); ++c)
      if (network.kind[c] == ContactKind::body && network.other[c] == 1)
        pressure += network.normal_force[c].norm();
    const ParticleView p = s.infill().particles();
    double mean = 0;
    for (std::size_t i = 0; i < p.size(); ++i) mean += p.z[i] - s.bodies()[0].position.z();
    height += 2 * mean / static_cast<double>(p.size());
    ++count;
  }
  floor /= count, wall /= count, pressure /= count, height /= count;
  double mass = 0;
  for (const double m : s.infill().particles().mass) mass += m;
  const double area = std::numbers::pi * bore * bore, diameter = 2 * bore;
  EXPECT_NEAR(floor + wall, mass * weight, 0.03 * mass * weight);
  EXPECT_GT(wall, 0.8 * mu * pressure) << "friction is not mobilised";
  // Integrated over the height: pressure = K integral(sigma) pi D, wall = mu_mobilised pressure, and of the
  // profile itself K follows from the floor's stress: one equation, solved by bisection.
  const double stress_alone = mass * weight / area;
  const auto janssen = [&](double k) {
    const double a = 4 * mu * k * height / diameter;
    return stress_alone * (1 - std::exp(-a)) / a;
  };
  double low = 0.01, high = 5;
  for (int i = 0; i < 60; ++i) (janssen(0.5 * (low + high)) > floor / area ? low : high) = 0.5 * (low + high);
  const double k_of_floor = 0.5 * (low + high);
  // Mean axial stress of the profile: (rho g - (sigma_floor/H)) D/(4 mu K).
  const double mean_axial = (stress_alone - janssen(k_of_floor)) * diameter / (4 * mu * k_of_floor * height);
  const double k_of_walls = pressure / (std::numbers::pi * diameter * height) / mean_axial;
  std::printf(
      "H/D %.2f: floor bears %.3f of the weight; K of the floor %.3f, of the walls %.3f; mobilised %.3f of "
      "mu\n",
      height / diameter, floor / (mass * weight), k_of_floor, k_of_walls, wall / (mu * pressure));
  EXPECT_LT(floor, 0.6 * mass * weight);
  EXPECT_GT(k_of_floor, 0.3);
  EXPECT_LT(k_of_floor, 1.2);
  EXPECT_NEAR(k_of_walls, k_of_floor, 0.2 * k_of_floor);
}

/// Degrees, of the slope left behind a door that opens, over a sill that the lowest grains stay behind.
double angle_of_repose(double rolling_friction) {
  GrainCase setup;
  Material material = dem::test::grain_material(5e6, 0.3, density, 0.3, 0.6);
  material.grain->rolling_friction = rolling_friction;
  setup.materials = {material};
  setup.rolling_resistance = true;
  setup.gravity = Vec3(0, 0, -weight);
  setup.damping_ratio = 0.3;
  setup.stiffness = 5e3;
  constexpr double x = 20 * radius, y = 5 * radius;
  add_box(setup, x, y);
  setup.bodies[2].shape = Block{Vec3(0.01, 0.1, 0.1)};  // the door
  setup.bodies[2].position = Vec3(x + 0.01, 0, 0.1);
  RigidBody sill;
  sill.name = "sill";
  sill.shape = Block{Vec3(0.01, 0.1, 2 * radius)};
  sill.position = Vec3(x + 0.01, 0, 2 * radius);
  setup.bodies.push_back(sill);
  setup.bodies[0].friction = FrictionLaw{0.6, 0.6, 0};
  setup.half_box = 0.05;
  add_loose(setup, {17, 4}, 700, 2.3 * radius, 0);
  Simulation s = make(setup);
  settle(s, 40, 0.15);
  s.set_damping(0, 0);
  s.remove_body(2);
  for (int k = 0; k < 400; ++k) s.advance_interval(1e-3);
  // Highest grain of each slice, and the straight line through them.
  constexpr int slices = 12;
  std::vector<double> top(slices, 0);
  const ParticleView p = s.infill().particles();
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p.is_expelled(i) || p.x[i] > x) continue;
    const auto slice =
        static_cast<std::size_t>(std::clamp((p.x[i] + x) / (2 * x) * slices, 0.0, slices - 1.0));
    top[slice] = std::max(top[slice], p.z[i]);
  }
  double sx = 0, sz = 0, sxx = 0, sxz = 0;
  for (int k = 0; k < slices; ++k) {
    const double at = (k + 0.5) / slices * 2 * x, z = top[static_cast<std::size_t>(k)];
    sx += at, sz += z, sxx += at * at, sxz += at * z;
  }
  const double slope = (slices * sxz - sx * sz) / (slices * sxx - sx * sx);
  return std::atan(-slope) * 180 / std::numbers::pi;
}

TEST(ASlopeOfGrains, IsSteeperTheMoreTheyResistRolling) {
  double before = 0;
  for (const double rolling : {0.0, 0.15, 0.4}) {
    const double angle = angle_of_repose(rolling);
    std::printf("rolling friction %g: %.1f degrees\n", rolling, angle);
    EXPECT_GT(angle, before + 2);
    before = angle;
  }
  EXPECT_LT(before, 45);
}

}  // namespace
}  // namespace tuft::coupler

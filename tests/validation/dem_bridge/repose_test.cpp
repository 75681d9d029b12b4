/// The angle of repose of grains that resist rolling, or are no spheres.
///
/// A bed between smooth plates three to four grains apart, on a floor of ribs as wide as the grains, for
/// bodies do not resist rolling; one side is opened, grains run over the edge, and the slope of what stays is
/// measured at rest. Sliding friction is high: with 0.5 the slope was nearly the same at rolling frictions of
/// 0.1 and 0.3. Grains are not equal: equal ones order between the plates, and the slope is that of their
/// lattice, 27 to 28 degrees without rolling friction and 29 with 0.1. Rolling resistance is epsd2, for cdt
/// lets no grain come to rest. Zhou, Xu, Yu & Zulli 2001, Phys. Rev. E 64, 021301, found by such simulations
/// that the angle rises with rolling friction, and falls with the distance of the plates: their values are of
/// other grains and are not compared.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/verification/coupler/loose_grains.h"
#include "tests/verification/dem_bridge/clump_scene.h"

namespace tuft::coupler {
namespace {

constexpr double largest = 0.001, smallest = 0.0007;  ///< m, radii of grains
constexpr double density = 1150, gravity = 9.81, friction = 0.8;
constexpr double wide = 2 * largest;  ///< m, of a rib, and of a column of the surface
constexpr int columns = 18;           ///< from the wall at the back to the edge
constexpr double edge = 0.5 * columns * wide, deep = 3 * wide;  ///< m
constexpr double ground = -0.11;  ///< m, axes of the ribs; grains leave the simulation not far below
constexpr double at_rest = 2e-3;  ///< m/s; one that has rolled down another has a hundred times that

/// Clumps of the spheres' volumes in their place, turned at random.
void make_clumps(GrainCase& setup, const Clump& clump, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  setup.materials[0].grain->clump = clump;
  const dem::Grains spheres = std::move(setup.grains);
  setup.grains = {};
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    dem::test::add_clump(setup.grains, setup.materials[0], spheres.position[i], 2 * spheres.radius[i],
                         Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix());
  }
}

/// Grains in a box whose body 0 is the side to be opened, at x = edge.
GrainCase bed_of_grains(double rolling_friction, std::uint64_t seed, const Clump* clump) {
  GrainCase setup;
  setup.materials = {dem::test::grain_material(5e5, 0.3, density, 0.3, friction)};
  setup.materials[0].grain->rolling_friction = rolling_friction;
  setup.rolling_resistance = true;
  setup.gravity = Vec3(0, 0, -gravity);
  setup.damping_ratio = 0.3;
  setup.stiffness = 100;
  setup.half_box = 0.12;
  setup.bodies.push_back(half_space("gate", Vec3(edge, 0, 0), Vec3(-1, 0, 0)));
  setup.bodies.push_back(half_space("back", Vec3(-edge, 0, 0), Vec3(1, 0, 0)));
  setup.bodies.push_back(half_space("near", Vec3(0, -deep / 2, 0), Vec3(0, 1, 0)));
  setup.bodies.push_back(half_space("far", Vec3(0, deep / 2, 0), Vec3(0, -1, 0)));
  for (int rib = 0; rib < columns; ++rib) {
    RigidBody body;
    body.name = "rib";
    body.shape = LyingCylinder{wide / 2};
    body.position = Vec3(-edge + (rib + 0.5) * wide, 0, ground);
    body.friction = FrictionLaw{friction, friction, 0};
    setup.bodies.push_back(body);
  }
  // Clumps reach farther than the spheres of their volume.
  const double reach = clump != nullptr ? 1.3 * largest : largest;
  add_loose(setup, reach, density, {clump != nullptr ? 12 : 16, 2}, clump != nullptr ? 900 : 1200,
            2.2 * reach, ground + reach, seed, [](double, double) { return true; });
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> size(smallest, largest);
  for (double& radius : setup.grains.radius) radius = size(random);
  if (clump != nullptr) make_clumps(setup, *clump, random);
  return setup;
}

/// What stands on the floor.
struct Slope {
  std::array<double, columns> top{};  ///< m
  double fastest = 0;                 ///< m/s
};
Slope slope_of(const ParticleView& p) {
  Slope slope;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p.is_expelled(i) || p.x[i] > edge || p.z[i] < ground) continue;
    slope.fastest = std::max(slope.fastest, p.velocity(i).norm());
    const int column = std::clamp(static_cast<int>((p.x[i] + edge) / wide), 0, columns - 1);
    slope.top[column] = std::max(slope.top[column], p.z[i] + p.radius[i] - ground);
  }
  return slope;
}

/// Degrees, of the line through the tops by least squares, but for two columns at either end.
double angle_of(const Slope& slope) {
  constexpr int first = 2, last = columns - 2;
  double mean = 0, moment = 0, spread = 0;
  for (int k = first; k < last; ++k) mean += slope.top[k] / (last - first);
  for (int k = first; k < last; ++k) {
    const double x = (k - 0.5 * (first + last - 1)) * wide;
    moment += x * (slope.top[k] - mean);
    spread += x * x;
  }
  return -std::atan(moment / spread) * 180 / std::numbers::pi;
}

double angle_of_repose(double rolling_friction, std::uint64_t seed, const Clump* clump = nullptr) {
  Simulation s = make(bed_of_grains(rolling_friction, seed, clump));
  settle(s, 20, 0.2);
  // What drags bears nothing at rest: it spares slides their swing.
  s.set_damping(0, 10);
  s.remove_body(0);
  s.advance_interval(0.1);
  Slope slope = slope_of(s.infill().particles());
  for (const double start = s.time(); slope.fastest > at_rest && s.time() < start + 3;) {
    s.advance_interval(0.01);
    slope = slope_of(s.infill().particles());
  }
  const double angle = angle_of(slope);
  std::printf("%s, rolling friction %.2f, seed %d: %.1f degrees, at rest after %.2f s\n",
              clump != nullptr ? "clumps" : "spheres", rolling_friction, static_cast<int>(seed), angle,
              s.time());
  std::fflush(stdout);
  EXPECT_LT(slope.fastest, at_rest) << rolling_friction;
  return angle;
}

TEST(AngleOfRepose, RisesWithRollingFrictionByMoreThanItScatters) {
  double steepest = 0;
  for (const double rolling_friction : {0.0, 0.15, 0.4}) {
    const double one = angle_of_repose(rolling_friction, 7), other = angle_of_repose(rolling_friction, 8);
    EXPECT_GT(std::min(one, other), steepest) << rolling_friction;
    steepest = std::max(one, other);
  }
}

constexpr int seeds = 4;

struct Sample {
  double mean = 0, squares = 0;  ///< degrees; squares: sum of the deviations'
};
Sample angles_of_repose(const Clump* clump = nullptr) {
  std::array<double, seeds> angle;
  Sample sample;
  for (int k = 0; k < seeds; ++k) {
    angle[k] = angle_of_repose(0, 7 + static_cast<std::uint64_t>(k), clump);
    sample.mean += angle[k] / seeds;
  }
  for (const double each : angle) sample.squares += (each - sample.mean) * (each - sample.mean);
  return sample;
}

// One bed and the next differ by up to four degrees: the means are compared, by Student's t.
TEST(AngleOfRepose, OfClumpsThatRollFreelyIsAboveThatOfSpheresThatDo) {
  constexpr double bound = 2.447;  // of 95 of 100 equal pairs, with 2 seeds - 2 = 6 degrees of freedom
  const Clump clump{ClumpShape::tetrahedron, 0.4};
  const Sample spheres = angles_of_repose(), clumps = angles_of_repose(&clump);
  const double variance = (spheres.squares + clumps.squares) / (2 * seeds - 2);
  EXPECT_GT(clumps.mean - spheres.mean, bound * std::sqrt(2 * variance / seeds))
      << "spheres " << spheres.mean << ", clumps " << clumps.mean << ", one bed +- " << std::sqrt(variance);
}

}  // namespace
}  // namespace tuft::coupler

/// Janssen's law: grains in a tube hang on its wall by friction, so that the stress in them saturates with
/// depth.
///
/// d(sigma)/dz = rho g - (P/A) mu K sigma, sigma the vertical stress at the depth z, P and A perimeter and
/// area of the tube, mu the friction of its wall, K the wall's pressure over sigma: sigma = rho g l (1 -
/// exp(-z/l)), l = A/(P mu K). It holds where friction is all that Coulomb allows and points up, everywhere.
/// Grains that have merely settled do not do that: their tangential springs are wound up every way, and the
/// wall bears what happens to be left of them, here -5 to 17 % of the weight where the law says 24 to 60 %.
/// So the tube is raised, slowly, past grains that stay where they are (after Bertho, Giorgiutti-Dauphine &
/// Hulin 2003, Phys. Rev. Lett. 90, 144301, who verified the law that way). The wall has less friction than
/// the grains have among each other: one half as rough as they are stays at 93 % of the limit, for some of
/// them roll on it in place of sliding. K is a property of neither grain nor wall that is known beforehand:
/// it is measured, as the wall's pressure over the stress of all contacts (Love's sum of force times branch).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "loose_grains.h"

namespace tuft::coupler {
namespace {

constexpr double radius = 0.001, density = 1150, gravity = 9.81;
constexpr double across = 12 * radius;  ///< m, inside the tube
constexpr double grain_friction = 0.5, wall_friction = 0.15;
constexpr double speed = 0.02;  ///< m/s, of the wall: a tenth of what a fall through a grain's diameter gives
constexpr int cuts = 9;         ///< planes in which stress is measured, at tenths of the height
constexpr Index floor_body = 0;

struct Tube {
  Simulation simulation;
  double area = 0, perimeter = 0;  ///< m^2, m
  std::vector<std::size_t> wall_nodes;

  void raise() {
    if (wall_nodes.empty())
      simulation.drive_body(floor_body + 1, Vec3(0, 0, speed));
    else
      simulation.drive_carpet(wall_nodes, Vec3(0, 0, speed));
  }
};

/// Soft grains, for steps of 40 us; under the stresses in here they overlap by some 2 % of their radius.
GrainCase grains_over_a_floor() {
  GrainCase setup;
  setup.materials = {dem::test::grain_material(5e5, 0.3, density, 0.3, grain_friction)};
  setup.gravity = Vec3(0, 0, -gravity);
  setup.damping_ratio = 0.3;
  setup.stiffness = 100;
  setup.bodies.push_back(half_space("floor", Vec3(0, 0, 0), Vec3(0, 0, 1)));
  setup.bodies.back().friction = FrictionLaw{grain_friction, grain_friction, 0};
  return setup;
}

Tube round_tube(int count, double friction, std::uint64_t seed) {
  GrainCase setup = grains_over_a_floor();
  RigidBody wall;
  wall.name = "wall";
  wall.shape = Bore{across / 2};
  wall.friction = FrictionLaw{friction, friction, 0};
  wall.driven = true;
  setup.bodies.push_back(wall);
  add_loose(setup, radius, density, {6, 6}, count, 2.2 * radius, 0, seed,
            [](double x, double y) { return std::hypot(x, y) < across / 2 - radius; });
  return {make(setup), std::numbers::pi * across * across / 4, std::numbers::pi * across, {}};
}

/// A square tube of four sheets of shells, each a strand of its own, all their nodes gripped.
Tube tube_of_shells(int count, double friction, std::uint64_t seed) {
  constexpr double thickness = 1e-4, face = (across + thickness) / 2, low = -0.012, edge = 0.006;
  GrainCase setup = grains_over_a_floor();
  setup.shell_friction = FrictionLaw{friction, friction, 0};
  setup.shell.density = 1e9;  // nothing moves them but the grip: for a long step
  add_loose(setup, radius, density, {5, 5}, count, 2.2 * radius, 0, seed,
            [](double, double) { return true; });
  const int rows = static_cast<int>(std::ceil((setup.grains.position.z.back() + radius - low) / edge));
  for (Index sheet = 0; sheet < 4; ++sheet) {
    const auto first = static_cast<Index>(setup.mesh.nodes.size());
    const double turn = 0.5 * std::numbers::pi * sheet;
    for (int row = 0; row <= rows; ++row)
      for (int column = 0; column <= 2; ++column) {
        const double along = (column - 1) * face;
        setup.mesh.nodes.push_back(Vec3(face * std::cos(turn) - along * std::sin(turn),
                                        face * std::sin(turn) + along * std::cos(turn), low + row * edge));
        setup.mesh.clamped.push_back(1);
      }
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < 2; ++column) {
        const Index corner = first + 3 * row + column;
        setup.mesh.quads.push_back({corner, corner + 1, corner + 4, corner + 3});
        setup.mesh.thickness.push_back(thickness);
        setup.mesh.material.push_back(0);
        setup.mesh.surface.push_back(1 + sheet);
      }
  }
  setup.mesh.surface_count = 5;
  std::vector<std::size_t> nodes(setup.mesh.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  return {make(setup), across * across, 4 * across, std::move(nodes)};
}

/// Means over time. Forces in N.
struct Reading {
  double area = 0, perimeter = 0;  ///< m^2, m
  double weight = 0, floor = 0, wall_up = 0, wall_normal = 0;
  double wall_up_before = 0, wall_normal_before = 0;  ///< settled, before the wall moves
  double height = 0;                                  ///< m, of even grains with that centre of mass
  double stress_volume = 0;            ///< J, vertical stress (compression positive) summed over the volume
  std::array<double, cuts> through{};  ///< vertical, through planes at (k + 1)/10 of the height
};

/// Adds what one moment's contacts say.
void add_moment(const Simulation& s, Reading& sum) {
  const ParticleView p = s.infill().particles();
  const double height = 2 * std::accumulate(p.z.begin(), p.z.end(), 0.0) / static_cast<double>(p.size());
  sum.height += height;
  for (const ContactNetwork& contacts : {s.infill().contacts(), s.boundary_contacts()})
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const double up = contacts.force(c).z(), branch = contacts.branch[c].z(),
                   from = p.z[static_cast<std::size_t>(contacts.particle[c])];
      const bool body = contacts.kind[c] == ContactKind::body,
                 on_floor = body && contacts.other[c] == floor_body;
      if (on_floor) sum.floor += up;
      if ((body && !on_floor) || contacts.kind[c] == ContactKind::fibre) {
        sum.wall_up += up;
        sum.wall_normal += contacts.normal_force[c].norm();
      }
      sum.stress_volume -= up * branch;
      for (int k = 0; k < cuts; ++k) {
        const double plane = 0.1 * (k + 1) * height;
        if ((from - plane) * (from + branch - plane) < 0) sum.through[k] += branch < 0 ? up : -up;
      }
    }
}

/// Fills, settles, raises the wall by two diameters of a grain, and reads while it goes on by as much.
Reading raise_and_read(Tube tube) {
  Simulation& s = tube.simulation;
  settle(s, 20, 0.25);
  Reading settled;
  add_moment(s, settled);
  tube.raise();
  // Else the filling, which the wall takes along at first, would swing up and down for long.
  s.advance_interval(0.2);
  s.set_damping(0, 0);
  constexpr double read_every = 2.5e-3;
  constexpr int readings = 80;
  Reading mean;
  mean.area = tube.area;
  mean.perimeter = tube.perimeter;
  mean.wall_up_before = settled.wall_up;
  mean.wall_normal_before = settled.wall_normal;
  for (int k = 0; k < readings; ++k) {
    s.advance_interval(read_every);
    add_moment(s, mean);
  }
  for (double* value : {&mean.floor, &mean.wall_up, &mean.wall_normal, &mean.height, &mean.stress_volume})
    *value /= readings;
  for (double& value : mean.through) value /= readings;
  for (const double mass : s.infill().particles().mass) mean.weight += mass * gravity;
  return mean;
}

/// Of as many fillings of a round tube, which differ in where grains were dropped. What the floor of one
/// bears is off by 1 (400 grains) to 2.2 % (800, standard deviation of 12 fillings).
Reading mean_of_fillings(int grains, int fillings) {
  Reading mean;
  for (int k = 0; k < fillings; ++k) {
    const Reading one = raise_and_read(round_tube(grains, wall_friction, 7 + static_cast<std::uint64_t>(k)));
    mean.area = one.area, mean.perimeter = one.perimeter;
    for (double Reading::*value :
         {&Reading::weight, &Reading::floor, &Reading::wall_up, &Reading::wall_normal,
          &Reading::wall_up_before, &Reading::wall_normal_before, &Reading::height, &Reading::stress_volume})
      mean.*value += one.*value / fillings;
    for (int cut = 0; cut < cuts; ++cut) mean.through[cut] += one.through[cut] / fillings;
  }
  return mean;
}

/// K: the wall's pressure over the mean vertical stress.
double stress_ratio(const Reading& r) {
  return (r.wall_normal / r.perimeter) / (r.stress_volume / r.area);
}

/// sigma A over the weight, in a plane at this share of the height.
double janssen(const Reading& r, double ratio, double at) {
  const double depth = r.area / (r.perimeter * wall_friction * ratio);
  return depth / r.height * -std::expm1(-(1 - at) * r.height / depth);
}

/// Vertical friction of the wall over what Coulomb allows.
double mobilised(const Reading& r) {
  return r.wall_up / (wall_friction * r.wall_normal);
}
double mobilised_before(const Reading& r) {
  return r.wall_up_before / (wall_friction * r.wall_normal_before);
}

/// What holds at any height and of any wall.
void expect_janssen(const Reading& r) {
  EXPECT_LT(std::abs(mobilised_before(r)), 0.4) << "settled: the wall bears what filling left";
  EXPECT_NEAR(mobilised(r), 1, 0.01);
  EXPECT_NEAR((r.floor + r.wall_up) / r.weight, 1, 0.003) << "grains nearly at rest";
  const double share = r.floor / r.weight;
  EXPECT_NEAR(share, janssen(r, stress_ratio(r), 0), 0.05 * share);
}

TEST(GrainsInATubeThatIsRaised, PressItsFloorAsJanssenSays) {
  const std::vector<Reading> fillings{mean_of_fillings(200, 2), mean_of_fillings(400, 4),
                                      mean_of_fillings(800, 6)};
  const double ratio = stress_ratio(fillings.back());
  for (const Reading& r : fillings) {
    expect_janssen(r);
    const double share = r.floor / r.weight;
    EXPECT_NEAR(share, janssen(r, ratio, 0), 0.09 * share) << "with K of the tallest filling";
  }
  const double weight = fillings[0].weight;
  EXPECT_LT(fillings[1].floor - fillings[0].floor, 0.6 * weight) << "as much again is filled in";
  EXPECT_LT(fillings[2].floor - fillings[1].floor, 0.5 * weight) << "twice as much is filled in";
}

TEST(GrainsInATubeThatIsRaised, AreUnderTheStressThatJanssenSaysAtEveryDepth) {
  const Reading r = mean_of_fillings(600, 4);
  expect_janssen(r);
  for (int k = 0; k < cuts; ++k)
    EXPECT_NEAR(r.through[k], r.weight * janssen(r, stress_ratio(r), 0.1 * (k + 1)), 0.1 * r.floor)
        << "at " << k + 1 << " tenths of the height";
}

TEST(GrainsInATubeThatIsRaised, StandOnItsFloorWithAllTheirWeightIfItIsSmooth) {
  const Reading r = raise_and_read(round_tube(400, 0, 7));
  EXPECT_NEAR(r.floor / r.weight, 1, 0.002);
  EXPECT_GT(stress_ratio(r), 0.4) << "though they press its wall";
}

TEST(GrainsInATubeOfShellsThatIsRaised, PressItsFloorAsJanssenSays) {
  std::vector<Reading> fillings;
  for (const int count : {250, 500}) {
    fillings.push_back(raise_and_read(tube_of_shells(count, wall_friction, 7)));
    expect_janssen(fillings.back());
  }
  EXPECT_LT(fillings[1].floor - fillings[0].floor, 0.6 * fillings[0].weight) << "as much again is filled in";
}

TEST(GrainsInATubeOfShellsThatIsRaised, StandOnItsFloorWithAllTheirWeightIfItIsSmooth) {
  const Reading r = raise_and_read(tube_of_shells(250, 0, 7));
  EXPECT_NEAR(r.floor / r.weight, 1, 0.002);
  EXPECT_GT(stress_ratio(r), 0.4) << "though they press its walls";
}

}  // namespace
}  // namespace tuft::coupler

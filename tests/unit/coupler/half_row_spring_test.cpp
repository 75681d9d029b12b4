#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <span>

#include "core/scene_reader.h"
#include "coupler/body_contact.h"
#include "coupler/build_simulation.h"

namespace tuft::coupler {
namespace {

constexpr double radius = 1e-3;  // m

Scene turf_scene() {
  return read_scene("inputs/clegg_small.toml");
}

TEST(HalfRowSpring, IsAsStiffAsTheInfillBehindItUnderTheSameStress) {
  const Scene scene = turf_scene();
  constexpr double area = 4 * radius * radius;
  for (const Material& material : scene.materials) {
    if (!material.continuum) continue;
    const NormalSpring spring = half_row_spring(material, scene.numerics, area, radius);
    EXPECT_NEAR(spring.force(spring.end) / area / scene.numerics.contact_pressure, 1, 1e-12) << material.name;
    for (const double share : {0.0, 0.3, 1.0}) {
      const double overlap = share * spring.end, stress = spring.force(overlap) / area;
      const double modulus = sph::constrained_modulus(*material.continuum, stress);
      EXPECT_NEAR(spring.tangent(overlap) / (modulus * area / radius), 1, 1e-9) << material.name << share;
    }
  }
}

TEST(HalfRowSpring, HasTheThicknessOfItsRowAndTheAreaOfItsColumn) {
  const Scene scene = turf_scene();
  const Material& material = scene.materials[static_cast<std::size_t>(scene.turf.layers.back().material)];
  constexpr double half_height = 1.25 * radius, area = 4 * radius * radius;
  const NormalSpring spring = half_row_spring(material, scene.numerics, area, half_height);
  EXPECT_NEAR(spring.force(spring.end) / area / scene.numerics.contact_pressure, 1, 1e-12);
  const double modulus = sph::constrained_modulus(*material.continuum, 0);
  EXPECT_NEAR(spring.tangent(0) / (modulus * area / half_height), 1, 1e-9);
}

TEST(PointWithAHalfHeight, PressesWallsAndFloorByTheSpringsOfEach) {
  constexpr double of_floor = 3e4, of_walls = 5e4, pressed = 1e-4;
  const double sideways = 2e-3, upwards = 3e-3, mass = 1e-3, none = 0, x = 0.05 - sideways + pressed,
               z = upwards - pressed;
  ParticleView view;
  view.x = std::span(&x, 1), view.z = std::span(&z, 1);
  view.y = view.vx = view.vy = view.vz = std::span(&none, 1);
  view.radius = std::span(&sideways, 1), view.half_height = std::span(&upwards, 1);
  view.mass = std::span(&mass, 1);
  BodyContact contact({{{of_floor}}, {0}, {{}}, {{of_walls}}});
  const std::vector<RigidBody> bodies = tray({0.1, 0.1});
  contact.search(view, bodies, 1e-3, false);
  Vec3Array force;
  force.assign(1, 0);
  BodyImpulses on_bodies;
  on_bodies.reset(bodies.size());
  contact.evaluate(view, bodies, 0, 1e-6, 0, 0, 1, force, nullptr, on_bodies);
  EXPECT_NEAR(force[0].x(), -of_walls * pressed, 1e-9 * of_walls * pressed);
  EXPECT_NEAR(force[0].z(), of_floor * pressed, 1e-9 * of_floor * pressed);
  EXPECT_EQ(contact.initial_overlap().largest, 0) << "nothing is let go";
}

TEST(PointThatSlides, HasItsFrictionOnFibresOnAFloorThatStandsForTheCarpetAndItsOwnOnWalls) {
  constexpr double stiffness = 1e4, pressed = 1e-4, of_body = 0.3, of_fibres = 0.6;
  const double size = 1e-3, mass = 1e-3, none = 0, x = 0.05 - size + pressed, z = size - pressed, speed = 1;
  ParticleView view;
  view.x = std::span(&x, 1), view.z = std::span(&z, 1);
  view.y = view.vx = view.vz = std::span(&none, 1);
  view.vy = std::span(&speed, 1);
  view.radius = std::span(&size, 1), view.mass = std::span(&mass, 1);
  const FrictionLaw on_bodies{of_body, of_body, 0}, on_fibres{of_fibres, of_fibres, 0};
  for (const bool is_carpet : {false, true}) {
    BodyContact contact({{{stiffness}}, {0}, {on_bodies}, {}, {on_fibres}});
    std::vector<RigidBody> bodies = tray({0.1, 0.1});
    bodies.front().is_carpet = is_carpet;
    contact.search(view, bodies, 1e-3, false);
    Vec3Array force;
    force.assign(1, 0);
    BodyImpulses impulses;
    impulses.reset(bodies.size());
    contact.evaluate(view, bodies, 0, 1e-2, 0, 0, 1, force, nullptr, impulses);
    const double normal = stiffness * pressed;  // on the floor and on the wall at x
    EXPECT_NEAR(force[0].y(), -normal * ((is_carpet ? of_fibres : of_body) + of_body), 1e-12) << is_carpet;
  }
}

TEST(PointWithAHalfHeight, TouchesFloorAndWallsAtItsHalfAxesAndSlopesBetweenThem) {
  const double at{0}, sideways{2e-3}, upwards{3e-3};
  ParticleView view;
  view.x = view.y = view.z = std::span(&at, 1);
  view.radius = std::span(&sideways, 1), view.half_height = std::span(&upwards, 1);
  EXPECT_DOUBLE_EQ(view.radius_along(0, {0, 0, -1}), upwards);
  EXPECT_DOUBLE_EQ(view.radius_along(0, {0, 1, 0}), sideways);
  EXPECT_DOUBLE_EQ(view.largest_radius(0), upwards);
  // Of the planes with this normal the one that an ellipsoid touches lies at the largest n . x on it.
  const Vec3 normal = Vec3(0.6, 0, 0.8);
  double farthest = 0;
  for (int k = 0; k <= 9000; ++k) {
    const double angle = 1e-4 * std::numbers::pi / 1.8 * k;
    farthest = std::max(farthest, normal.dot(Vec3(sideways * std::cos(angle), 0, upwards * std::sin(angle))));
  }
  EXPECT_NEAR(view.radius_along(0, normal), farthest, 1e-9);
  view.half_height = {};
  EXPECT_DOUBLE_EQ(view.radius_along(0, normal), sideways);
}

TEST(HalfRowSpring, IsLinearWithAContactModulus) {
  Scene scene = turf_scene();
  scene.materials[0].contact_modulus = 5e6;
  const NormalSpring spring =
      half_row_spring(scene.materials[0], scene.numerics, 4 * radius * radius, radius);
  EXPECT_DOUBLE_EQ(spring.stiffness, 5e6 * 4 * radius);
  EXPECT_EQ(spring.stiffening, 0);
}

/// One point above a floor, with a spring that stiffens.
class PointAboveFloor : public testing::Test {
 protected:
  static constexpr double mass = 1e-4;
  void place(double height, double speed) {
    z_ = {height};
    vz_ = {speed};
    contact_.search(view(), bodies_, radius, false);
  }
  [[nodiscard]] double stable_step(double horizon) const {
    std::vector<BodyContact::Approach> approaches;
    contact_.look(view(), bodies_, approaches);
    return contact_.stable_steps(view(), approaches, horizon, false).front();
  }
  void evaluate() {
    Vec3Array linear;
    linear.assign(1, 0);
    BodyImpulses on_bodies;
    on_bodies.reset(1);
    contact_.evaluate(view(), bodies_, 0, 1e-6, 0, 0, 1e-6, linear, nullptr, on_bodies);
  }
  /// Impulses upwards on the point and on the floor, N s, in a window in which a point with kicks of its own
  /// is kicked for `length` (s), `since` (s) after the last time.
  std::array<double, 2> impulses_of_kick(double since, double length) {
    ParticleView points = view();
    const double lag = 0.5 * length;
    points.kicks = {1, std::span(&since, 1), std::span(&length, 1), std::span(&lag, 1)};
    Vec3Array linear;
    linear.assign(1, 0);
    BodyImpulses on_bodies;
    on_bodies.reset(1);
    contact_.evaluate(points, bodies_, 0, 1e-6, 0, 0, 1e-6, linear, nullptr, on_bodies);
    return {linear.z[0], on_bodies.impulse[0].z()};
  }
  void let_floor_move() { bodies_[0].driven = true; }
  void replace(const NormalSpring& spring) { contact_.replace_springs({spring}, view(), bodies_, 0); }
  [[nodiscard]] const ContactEnergy& energy() const { return contact_.energy(); }
  [[nodiscard]] static double step_of(double stiffness) { return 2 * std::sqrt(mass / stiffness); }

  const NormalSpring spring_{1e5, 4e3, 5e-4};

 private:
  [[nodiscard]] ParticleView view() const {
    ParticleView view;
    view.x = view.y = view.vx = view.vy = zero_;
    view.z = z_, view.vz = vz_, view.radius = radius_, view.mass = mass_;
    return view;
  }

  BodyContact contact_{{{spring_}, {0}, {{}}}};
  std::vector<RigidBody> bodies_ = [] {
    RigidBody floor;
    floor.shape = HalfSpace{Vec3(0, 0, 1)};
    return std::vector<RigidBody>{floor};
  }();
  std::vector<double> zero_{0}, radius_{radius}, mass_{mass}, z_{1}, vz_{0};
};

TEST_F(PointAboveFloor, WithKicksOfItsOwnReceivesTheForceForAsLongAsEachLasts) {
  place(radius - 1e-4, 0);
  const double force = spring_.force(1e-4);
  for (const double length : {4e-6, -2.5e-6}) {  // backwards where the last kick went too far ahead
    const auto [point, floor] = impulses_of_kick(8e-6, length);
    EXPECT_NEAR(point, force * length, 1e-12 * force);
    EXPECT_DOUBLE_EQ(floor, -point);
  }
  const auto [point, floor] = impulses_of_kick(8e-6, 0);
  EXPECT_EQ(point, 0);
  EXPECT_EQ(floor, 0);
  EXPECT_DOUBLE_EQ(energy().elastic, spring_.energy(1e-4)) << "what it holds between kicks";
  let_floor_move();
  const auto [at_moving, moving] = impulses_of_kick(8e-6, 4e-6);
  EXPECT_NEAR(at_moving, force * 4e-6, 1e-12 * force);
  EXPECT_DOUBLE_EQ(moving, -at_moving);
}

TEST_F(PointAboveFloor, BeforeTheFirstSearchMayMeetTheStiffestOfItsSpring) {
  EXPECT_DOUBLE_EQ(stable_step(0), step_of(spring_.tangent(1)));
}

TEST_F(PointAboveFloor, ApartFromAllBodiesBoundsNoStep) {
  place(10 * radius, -1);
  EXPECT_EQ(stable_step(1e-5), std::numeric_limits<double>::infinity());
}

TEST_F(PointAboveFloor, BoundsTheStepByTheStiffnessItWillMeet) {
  place(radius - 1e-4, 0);
  EXPECT_NEAR(stable_step(1e-5) / step_of(spring_.tangent(1e-4)), 1, 1e-12);
  place(radius - 1e-4, -10);
  EXPECT_NEAR(stable_step(1e-5) / step_of(spring_.tangent(2e-4)), 1, 1e-12);
  place(radius - 1e-4, 10);
  EXPECT_NEAR(stable_step(1e-5) / step_of(spring_.tangent(1e-4)), 1, 1e-12);
}

TEST_F(PointAboveFloor, KeepsTheSumOfElasticAndDampedEnergyWhereSpringsAreReplaced) {
  place(radius - 2e-4, 0);
  evaluate();
  EXPECT_DOUBLE_EQ(energy().elastic, spring_.energy(2e-4));
  const NormalSpring softer{4e4};
  replace(softer);
  evaluate();
  EXPECT_DOUBLE_EQ(energy().elastic, softer.energy(2e-4));
  EXPECT_NEAR(energy().elastic + energy().damped, spring_.energy(2e-4), 1e-15);
}

}  // namespace
}  // namespace tuft::coupler

/// A clump alone: free flight, kicks, plates that a test makes of contact impulses.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "tests/verification/dem_bridge/clump_scene.h"

namespace tuft::dem::test {
namespace {

constexpr double diameter = 0.002;
const Clump rod{ClumpShape::pair, 0.3};
const Clump odd{
    ClumpShape::spheres, 0.5, {{0, 0, 0, 1}, {1.1, 0, 0, 0.7}, {0.2, 0.9, 0, 0.6}, {0, 0, 0.8, 0.5}}};

struct Flight {
  Grains grains;
  std::vector<Material> materials;
  GrainBody body;
  ClumpBody shape;
  Vec3 inertia;

  explicit Flight(const Clump& clump, const Mat3& turn = Mat3::Identity()) : materials{clumped(clump)} {
    add_clump(grains, materials[0], Vec3(0, 0, 0), diameter, turn);
    const GrainBodies found = find_bodies(grains, materials);
    body = found.bodies[0];
    shape = found.shapes[0];
    inertia = found.inertia_of(body);
  }
  [[nodiscard]] DemInfill infill(const Vec3& gravity = Vec3(0, 0, 0)) const {
    return {grains, materials, settings_in_box(0.05, gravity)};
  }
};

/// Euler's equations of the free body by Runge & Kutta's method, finely: axes after a time.
Mat3 turned_freely(const Mat3& axes, const Vec3& angular_momentum, const Vec3& inertia, double time) {
  Eigen::Quaterniond q(axes);
  constexpr int steps = 20000;
  const double h = time / steps;
  const auto rate = [&](const Eigen::Quaterniond& turn) {
    const Vec3 spin = turn * (turn.conjugate() * angular_momentum).cwiseQuotient(inertia);
    const Eigen::Quaterniond w(0, spin.x(), spin.y(), spin.z());
    return Eigen::Vector4d(0.5 * (w * turn).coeffs());
  };
  const auto moved = [&](const Eigen::Vector4d& by) {
    Eigen::Quaterniond result;
    result.coeffs() = q.coeffs() + by;
    return result;
  };
  for (int k = 0; k < steps; ++k) {
    const Eigen::Vector4d a = rate(q), b = rate(moved(0.5 * h * a)), c = rate(moved(0.5 * h * b)),
                          d = rate(moved(h * c));
    q.coeffs() += h / 6 * (a + 2 * b + 2 * c + d);
    q.normalize();
  }
  return q.toRotationMatrix();
}

TEST(FreeClump, FliesStraightAndKeepsItsEnergy) {
  const Flight flight(odd, turn_about(Vec3(1, 2, 3), 0.8));
  DemInfill infill = flight.infill();
  const Vec3 velocity(0.3, -0.2, 0.5), spin(150, -220, 90);
  infill.set_velocity(0, velocity, spin);
  // Sphere 0 has that velocity; the centre of mass another.
  const Vec3 of_centre = velocity - spin.cross(flight.grains.position[0] - flight.body.centre);
  const double start = infill.energy().kinetic;
  const Vec3 in_body = flight.body.axes.transpose() * spin;
  EXPECT_NEAR(start / (0.5 * flight.body.mass * of_centre.squaredNorm() +
                       0.5 * in_body.dot(flight.inertia.asDiagonal() * in_body)),
              1, 1e-12);
  const double window = 4e-6;
  for (int k = 0; k < 2000; ++k) {
    infill.advance(window, 1, no_impulses(4));
    ASSERT_NEAR(infill.energy().kinetic / start, 1, 1e-6) << k;
  }
  const GrainBody now = bodies_now(infill, flight.grains, flight.materials).bodies[0];
  EXPECT_LT((now.centre - 2000 * window * of_centre).norm(), 1e-12);
  const Motion motion = motion_of(infill, flight.grains, flight.materials);
  EXPECT_LT((motion.momentum - flight.body.mass * of_centre).norm(), 1e-12 * motion.momentum.norm());
}

/// The axis of a symmetric top goes round the angular momentum with the angular velocity L/I.
TEST(FreeClump, OfTwoSpheresPrecessesAsASymmetricTop) {
  const Flight flight(rod);
  const Vec3 axis = flight.body.axes.col(2);  // of the least moment
  const Vec3 across = flight.body.axes.col(0), spin = 300 * axis + 200 * across;
  const Vec3 momentum = flight.body.axes * flight.inertia.asDiagonal() * flight.body.axes.transpose() * spin;
  ASSERT_NEAR(flight.inertia[0] / flight.inertia[1], 1, 1e-12);
  const double time = 0.02;  // about one and a half turns
  const double angle = momentum.norm() / flight.inertia[0] * time;
  ASSERT_GT(angle, 4);
  const Vec3 wanted = turn_about(momentum, angle) * axis;
  const auto error = [&](int windows) {
    DemInfill infill = flight.infill();
    infill.set_velocity(0, Vec3(0, 0, 0), spin);
    for (int k = 0; k < windows; ++k) infill.advance(time / windows, 1, no_impulses(2));
    const ParticleView view = infill.particles();
    const Vec3 along = (view.position(1) - view.position(0)).normalized();
    return std::min((along - wanted).norm(), (along + wanted).norm());
  };
  const double coarse = error(1000), fine = error(2000);
  EXPECT_LT(coarse, 2e-4);
  EXPECT_NEAR(coarse / fine, 4, 0.5) << "second order";
}

TEST(FreeClump, OfUnlikeMomentsTurnsByEulersEquations) {
  const Flight flight(odd, turn_about(Vec3(3, -1, 1), 1.1));
  const Vec3 spin = flight.body.axes * Vec3(60, 250, 20);  // about the middle axis, which is not stable
  const Vec3 momentum = flight.body.axes * flight.inertia.asDiagonal() * flight.body.axes.transpose() * spin;
  const double time = 0.03;
  const Mat3 wanted = turned_freely(flight.body.axes, momentum, flight.inertia, time);
  ASSERT_GT((wanted.col(0) - flight.body.axes.col(0)).norm(), 0.5);
  const auto error = [&](int windows) {
    DemInfill infill = flight.infill();
    infill.set_velocity(0, Vec3(0, 0, 0), spin);
    for (int k = 0; k < windows; ++k) infill.advance(time / windows, 1, no_impulses(4));
    return (bodies_now(infill, flight.grains, flight.materials).bodies[0].axes - wanted).norm();
  };
  const double coarse = error(1500), fine = error(3000);
  EXPECT_LT(coarse, 2e-3);
  EXPECT_NEAR(coarse / fine, 4, 0.5);
}

/// A rod hit at one end, across: v = J/M, spin = d J/I.
TEST(KickOfOneSphere, GivesTheBodyItsVelocityAndSpin) {
  const Flight flight(rod);
  ContactImpulses hit = no_impulses(2);
  const Vec3 impulse = 2e-6 * flight.body.axes.col(0), twist = 1e-10 * flight.body.axes.col(2);
  hit.linear.set(1, impulse);
  hit.angular.set(0, twist);
  for (const int substeps : {1, 3}) {
    DemInfill struck = flight.infill();
    const AdvanceReport report = struck.advance(1e-7, substeps, hit);
    EXPECT_LT((report.impulse_received - impulse).norm(), 1e-15 * impulse.norm());
    EXPECT_LT((report.impulse_scale - impulse.cwiseAbs()).norm(), 1e-15 * impulse.norm());
    struck.advance(1e-7, substeps, no_impulses(2));
    const Vec3 end = flight.grains.position[1] - flight.body.centre, moment = end.cross(impulse);
    const Vec3 spin = moment / flight.inertia[0] + twist / flight.inertia[2];
    const ParticleView view = struck.particles();
    EXPECT_LT((view.spin(0) - spin).norm(), 1e-4 * spin.norm());
    EXPECT_LT((view.spin(0) - view.spin(1)).norm(), 1e-12 * spin.norm());
    const Vec3 middle = 0.5 * (view.velocity(0) + view.velocity(1));
    EXPECT_LT((middle - impulse / flight.body.mass).norm(), 1e-10 * middle.norm());
    EXPECT_LT((view.velocity(1) - middle - spin.cross(end)).norm(), 1e-4 * middle.norm());
    const double work = 0.5 * impulse.squaredNorm() / flight.body.mass +
                        0.5 * moment.squaredNorm() / flight.inertia[0] +
                        0.5 * twist.squaredNorm() / flight.inertia[2];
    EXPECT_NEAR(struck.energy().contact_work / work, 1, 1e-4);
    EXPECT_NEAR(struck.energy().kinetic / work, 1, 1e-4);
  }
}

TEST(FallingClump, FallsAsAPointMassAndIsSlowedByDampingInMotionAndSpinAlike) {
  const Flight flight(odd);
  DemInfill infill = flight.infill(Vec3(0, 0, -9.81));
  const double window = 5e-6, rate = 300;
  infill.set_damping(rate);
  infill.set_velocity(0, Vec3(0, 0, 0), flight.body.axes.col(0) * 200);
  double start = 0;
  for (int k = 0; k < 1000; ++k) {
    infill.advance(window, 2, no_impulses(4));
    if (k == 0) start = total_energy(infill.energy());
  }
  const double time = 1000 * window;
  EXPECT_NEAR(infill.particles().spin(0).norm() / (200 * std::exp(-rate * time)), 1, 2e-3);
  const Motion motion = motion_of(infill, flight.grains, flight.materials);
  EXPECT_NEAR(motion.momentum.z() / flight.body.mass,
              -9.81 / rate * (1 - std::exp(-rate * time)) +
                  (200 * flight.body.axes.col(0)).cross(flight.body.centre - flight.grains.position[0]).z() *
                      std::exp(-rate * time),
              1e-4);
  EXPECT_NEAR(total_energy(infill.energy()), start, 1e-7 * start);
}

/// LIGGGHTS' fix keeps a step of its own: every change must reach it.
TEST(FreeClump, FollowsAStepThatChanges) {
  const Flight flight(rod);
  DemInfill infill = flight.infill(Vec3(0, 0, -9.81));
  double height = 0, speed = 0;
  for (int k = 0; k < 60; ++k) {
    const double window = k % 3 == 0 ? 2e-6 : 6e-6;
    infill.advance(window, 1, no_impulses(2));
    speed -= 9.81 * window;  // a kick is as long as its step
    height += window * speed;
  }
  EXPECT_NEAR(bodies_now(infill, flight.grains, flight.materials).bodies[0].centre.z(), height, 1e-15);
}

/// A plate z = 0 below both ends: springs, dashpots, Coulomb's friction against the motion of the lowest
/// points.
ContactImpulses plate(const DemInfill& infill, double window, double stiffness, double damping,
                      double friction, const Vec3& up) {
  const ParticleView view = infill.particles();
  ContactImpulses contact = no_impulses(view.size());
  for (std::size_t i = 0; i < view.size(); ++i) {
    const double depth = view.radius[i] - view.position(i).dot(up);
    if (depth <= 0) continue;
    const Vec3 arm = -view.radius[i] * up, velocity = view.velocity(i) + view.spin(i).cross(arm);
    const double normal = std::max(0.0, stiffness * depth - damping * velocity.dot(up));
    const Vec3 sliding = velocity - velocity.dot(up) * up;
    const Vec3 force = normal * up - friction * normal * sliding / std::max(sliding.norm(), 1e-3);
    contact.linear.set(i, window * force);
    contact.angular.set(i, window * arm.cross(force));
  }
  return contact;
}

struct Slider {
  Flight flight{rod};
  double rest = 0;  ///< of centres above the plate

  explicit Slider(const Vec3& up) {
    const Vec3 along = Vec3(0, 1, 0).cross(up).normalized();
    const double radius = flight.grains.radius[0], half = diameter * flight.shape.centre[0].norm();
    rest = radius - 0.5 * flight.body.mass * 9.81 * up.z() / 2000;
    for (std::size_t i = 0; i < 2; ++i)
      flight.grains.position.set(i, rest * up + (i == 0 ? half : -half) * along);
  }
};

/// Both ends on the plate: the rod slows down by mu g, and does not roll, as a sphere would, nor tip over.
TEST(ClumpOnAPlate, SlidesOnTwoFeetWithoutTurning) {
  const Vec3 up(0, 0, 1);
  const Slider slider(up);
  DemInfill infill = slider.flight.infill(Vec3(0, 0, -9.81));
  infill.set_velocity(0, Vec3(0.2, 0, 0), Vec3(0, 0, 0));
  const double window = 4e-6, friction = 0.3;
  for (int k = 0; k < 5000; ++k) infill.advance(window, 1, plate(infill, window, 2000, 1, friction, up));
  const ParticleView view = infill.particles();
  EXPECT_NEAR(0.5 * (view.vx[0] + view.vx[1]), 0.2 - friction * 9.81 * 5000 * window, 0.002);
  EXPECT_LT(view.spin(0).norm(), 0.5) << "a sphere would spin with " << 0.2 / 0.001;
}

TEST(ClumpOnAPlate, StaysOnASlopeOnWhichASphereWouldRollAndComesToRest) {
  const double slope = 0.25;  // below the angle of friction
  const Vec3 up = Vec3(-std::sin(slope), 0, std::cos(slope));
  const Slider slider(up);
  DemInfill infill = slider.flight.infill(Vec3(0, 0, -9.81));
  const double window = 4e-6;
  for (int k = 0; k < 6000; ++k) infill.advance(window, 1, plate(infill, window, 2000, 1, 0.5, up));
  const ParticleView view = infill.particles();
  // The viscous start of this friction law creeps: v = 1e-3 tan(slope)/mu.
  EXPECT_NEAR(0.5 * (view.velocity(0) + view.velocity(1)).norm(), 1e-3 * std::tan(slope) / 0.5, 2e-4);
  EXPECT_LT(view.spin(0).norm(), 0.2);
}

/// A clump of one sphere is a grain: two solvers, one motion.
TEST(ClumpOfOneSphere, BouncesAsTheSphereDoes) {
  std::array<ParticleView, 2> views;
  std::vector<std::unique_ptr<DemInfill>> infills;
  for (const bool clump : {false, true}) {
    Grains grains;
    std::vector<Material> materials{clump ? clumped({ClumpShape::spheres, 0.5, {ClumpSphere{}}}) : rubber()};
    for (const Vec3& x : {Vec3(-0.001005, 0, 0), Vec3(0.001005, 0.0007, 0), Vec3(0.0005, 0.0024, 0.0003)}) {
      if (clump)
        add_clump(grains, materials[0], x, 0.002);
      else
        add_grain(grains, x, 0.001, 1150);
    }
    DemSettings settings = settings_in_box(0.05, Vec3(0, 0, -9.81));
    settings.rolling_resistance = true;
    infills.push_back(std::make_unique<DemInfill>(grains, materials, settings));
    DemInfill& infill = *infills.back();
    EXPECT_NEAR(infill.stable_step() / infills.front()->stable_step(), 1, 1e-9);
    infill.set_velocity(0, Vec3(0.5, 0.1, 0), Vec3(0, 0, 20));
    infill.set_velocity(1, Vec3(-0.5, 0, 0.1), Vec3(10, 0, 0));
    infill.set_damping(20);
    // Steps that change also in contact: half a kick is made before the next step is known.
    for (int k = 0; k < 400; ++k) infill.advance(k % 2 == 0 ? 5e-6 : 3e-6, 2, no_impulses(3));
    views[clump ? 1 : 0] = infill.particles();
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((views[0].position(i) - views[1].position(i)).norm(), 1e-12);
    EXPECT_LT((views[0].velocity(i) - views[1].velocity(i)).norm(), 1e-9);
    EXPECT_LT((views[0].spin(i) - views[1].spin(i)).norm(), 1e-6);
    EXPECT_NEAR(views[0].mass[i] / views[1].mass[i], 1, 1e-12);
  }
  EXPECT_GT(views[0].spin(2).norm(), 1) << "hit";
  const InfillEnergy a = infills[0]->energy(), b = infills[1]->energy();
  EXPECT_NEAR(a.kinetic, b.kinetic, 1e-9 * a.kinetic);
  EXPECT_NEAR(a.dissipated, b.dissipated, 1e-9 * a.dissipated);
  EXPECT_NEAR(a.damping, b.damping, 1e-9 * a.damping);
}

}  // namespace
}  // namespace tuft::dem::test

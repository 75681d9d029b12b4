// Spheres of conditioning: free motion, collisions, energy and momentum, the same bits always.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "core/parallel.h"
#include "sph_infill/sphere_infill.h"
#include "sph_infill/sphere_placing.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

SphereSettings settings_of(double damping_ratio, double friction, const Vec3& gravity = {0, 0, 0},
                           double diameter_ratio = 1) {
  SphereSettings settings;
  settings.diameter_ratio = diameter_ratio;
  settings.options = test::options_of(test::Preset::accurate, pitch);
  settings.gravity = gravity;
  settings.modulus = 8e7;
  settings.friction = friction;
  settings.damping_ratio = {damping_ratio};
  return settings;
}

std::vector<Material> material() {
  return test::single_material(test::mixture_material());
}

/// Two spheres, centres `distance` diameters apart along x.
SphereInfill two_spheres(double distance, const SphereSettings& settings) {
  Lattice lattice = test::block(2, 1, 1, pitch);
  lattice.position.set(0, {-0.5 * distance * pitch, 0, 0});
  lattice.position.set(1, {0.5 * distance * pitch, 0, 0});
  return {lattice, material(), lattice.position, settings};
}

Vec3 momentum_of(const ParticleView& p) {
  Vec3 sum(0, 0, 0);
  for (std::size_t i = 0; i < p.size(); ++i) sum += p.mass[i] * p.velocity(i);
  return sum;
}

double inertia_of(const ParticleView& p, std::size_t i) {
  return 0.4 * p.mass[i] * p.radius[i] * p.radius[i];
}

double total_of(const InfillEnergy& e) {
  return e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping - e.contact_work;
}

TEST(Spheres, FallFreely) {
  SphereInfill infill = two_spheres(3, settings_of(0, 0, {0, 0, -9.81}));
  const double dt = 1e-5;
  for (int k = 0; k < 1000; ++k) infill.advance(dt, 1, {});
  const ParticleView p = infill.particles();
  const double t = 1000 * dt;
  // The first kick is half a step long: positions are exact at t, velocities are those of t - dt/2.
  EXPECT_NEAR(p.z[0], -0.5 * 9.81 * t * t, 1e-12);
  EXPECT_NEAR(p.vz[0], -9.81 * (t - 0.5 * dt), 1e-12);
  // v- . v+ is v^2 less a quarter of the change in a step; at the start there is no step before, and nothing
  // less.
  const double mass = p.mass[0] + p.mass[1];
  EXPECT_NEAR(total_of(infill.energy()), -mass * std::pow(9.81 * dt, 2) / 8, 1e-18);
}

class Collision : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(DampingRatios, Collision, testing::Values(0.0, 0.1, 0.2155));

TEST_P(Collision, ReturnsTheSpeedThatASpringAndDashpotThatNeverPullGive) {
  const double zeta = GetParam();
  SphereInfill infill = two_spheres(1.01, settings_of(zeta, 0.5));
  infill.set_velocity(0, {0.1, 0, 0});
  infill.set_velocity(1, {-0.1, 0, 0});
  const double kinetic = infill.particles().mass[0] * 0.1 * 0.1;
  const double dt = 0.02 * infill.stable_step();
  double t = 0;
  for (; t < 2.5e-3; t += dt) infill.advance(dt, 1, {});
  // Schwager & Poeschel 2007.
  const double s = std::sqrt(1 - zeta * zeta);
  const double restitution =
      std::exp(-zeta / s * (std::numbers::pi - std::atan2(2 * zeta * s, 1 - 2 * zeta * zeta)));
  const ParticleView p = infill.particles();
  EXPECT_NEAR(p.vx[1], 0.1 * restitution, 0.1 * 0.005);
  EXPECT_EQ(p.vx[0], -p.vx[1]);
  const InfillEnergy e = infill.energy();
  EXPECT_NEAR(e.kinetic + e.stored + e.dissipated, kinetic, 1e-3 * kinetic);
  EXPECT_NEAR(e.dissipated, (1 - restitution * restitution) * kinetic, 0.01 * kinetic);
}

TEST(Spheres, GlancingCollisionKeepsMomentumAndItsMomentAndTurnsTheSpheres) {
  SphereInfill infill = two_spheres(1.005, settings_of(0.2, 0.5));
  infill.set_velocity(0, {0.2, 0.15, 0});
  infill.set_spin(0, {0, 0, 40});
  const auto moment = [&] {
    const ParticleView p = infill.particles();
    Vec3 sum(0, 0, 0);
    for (std::size_t i = 0; i < 2; ++i)
      sum += p.mass[i] * p.position(i).cross(p.velocity(i)) + inertia_of(p, i) * p.spin(i);
    return sum;
  };
  const Vec3 linear = momentum_of(infill.particles()), angular = moment();
  const double dt = 0.02 * infill.stable_step(), scale = angular.norm();
  for (int k = 0; k < 4000; ++k) infill.advance(dt, 1, {});
  EXPECT_NE(infill.particles().spin(1).z(), 0);
  EXPECT_LT((momentum_of(infill.particles()) - linear).norm(), 1e-14 * linear.norm());
  // Torques are about the surfaces of the spheres, forces between centres that overlap: a share of the
  // overlap.
  EXPECT_LT((moment() - angular).norm(), 0.01 * scale);
  const InfillEnergy e = infill.energy();
  const double put_in =
      0.5 * infill.particles().mass[0] * (0.04 + 0.0225) + 0.5 * inertia_of(infill.particles(), 0) * 1600;
  EXPECT_NEAR(total_of(e), put_in, 2e-3 * put_in);
  EXPECT_GT(e.dissipated, 0);
}

/// Spheres placed in a box, falling to its floor.
struct FallingBed {
  int n = 6;
  Lattice lattice;
  SphereInfill infill;
  test::Tray tray;

  explicit FallingBed(int width)
      : n(width),
        lattice(test::block(width, width, width, pitch)),
        infill(lattice, material(), positions(lattice, width), settings_of(0.2, 0.5, {0, 0, -9.81}, 0.9)),
        tray(width * pitch, width * pitch, 8e7 * pitch, 0) {}
  static Vec3Array positions(const Lattice& lattice, int width) {
    const std::array<double, 2> size{width * pitch, width * pitch};
    return place_spheres(lattice, {sphere_radii(lattice, 0.9), sphere_radii(lattice, 1), {size, 0}, 1})
        .position;
  }
  void run(int windows, double step_share = 0.5) {
    ContactImpulses contact;
    for (int k = 0; k < windows; ++k) {
      const double window = step_share * infill.stable_step();
      tray.push(infill.particles(), window, contact);
      infill.advance(window, 1, contact);
    }
  }
};

/// Largest imbalance over what a bed thrown to the floor loses.
double imbalance_of_fall(double step_share) {
  FallingBed bed(6);
  const ParticleView p = bed.infill.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    bed.infill.set_velocity(i, {0.05 * std::sin(double(i)), 0, -0.3});
  bed.run(1, step_share);
  const InfillEnergy first = bed.infill.energy();
  double worst = 0;
  const int tenths = static_cast<int>(200 / step_share);
  for (int k = 0; k < 10; ++k) {
    bed.run(tenths, step_share);
    worst = std::max(worst, std::abs(total_of(bed.infill.energy()) - total_of(first)));
  }
  const InfillEnergy last = bed.infill.energy();
  const double lost = first.kinetic + first.gravity_potential - last.kinetic - last.gravity_potential;
  EXPECT_GT(last.dissipated, 0.5 * lost);
  EXPECT_LT(bed.infill.largest_overlap(), 0.01);
  return worst / lost;
}

TEST(Spheres, EnergyOfABedThatFallsIntoABoxIsBalancedToOnePercentAndBetterWithTheSquareOfTheStep) {
  // Contacts begin and end within a step: an error of k dt^2/(6 m) of what meets, less what parts.
  const double coarse = imbalance_of_fall(0.4), fine = imbalance_of_fall(0.2);
  EXPECT_LT(coarse, 0.02);
  EXPECT_LT(fine, 0.01);
  EXPECT_LT(fine, 0.5 * coarse);
}

TEST(Spheres, MomentumOfAFreeCloudStaysToRounding) {
  SphereInfill infill = [] {
    const Lattice lattice = test::block(5, 5, 5, pitch);
    return SphereInfill(lattice, material(), lattice.position, settings_of(0.2, 0.5));
  }();
  const ParticleView p = infill.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    infill.set_velocity(i, Vec3(0.3, -0.2, 0.1) - 100 * (p.position(i) - Vec3(0, 0, 0.005)));
  const Vec3 before = momentum_of(infill.particles());
  double scale = 0;
  for (std::size_t i = 0; i < p.size(); ++i) scale += p.mass[i] * p.velocity(i).norm();
  for (int k = 0; k < 500; ++k) infill.advance(0.5 * infill.stable_step(), 1, {});
  EXPECT_GT(infill.energy().dissipated, 0.1 * infill.energy().kinetic);
  EXPECT_LT((momentum_of(infill.particles()) - before).norm(), 1e-13 * scale);
}

void expect_same(const SphereInfill& a, const SphereInfill& b) {
  const ParticleView p = a.particles(), q = b.particles();
  EXPECT_TRUE(std::ranges::equal(p.x, q.x) && std::ranges::equal(p.z, q.z));
  EXPECT_TRUE(std::ranges::equal(p.vx, q.vx) && std::ranges::equal(p.vz, q.vz));
  EXPECT_TRUE(std::ranges::equal(p.wx, q.wx) && std::ranges::equal(p.wz, q.wz));
  const InfillEnergy e = a.energy(), f = b.energy();
  EXPECT_EQ(e.kinetic, f.kinetic);
  EXPECT_EQ(e.stored, f.stored);
  EXPECT_EQ(e.dissipated, f.dissipated);
  EXPECT_EQ(e.contact_work, f.contact_work);
  EXPECT_EQ(a.stable_step(), b.stable_step());
}

TEST(Spheres, GiveTheSameBitsWithOneAndTwoThreads) {
  const int before = omp_get_max_threads();
  set_threads(1);
  FallingBed one(9);
  one.run(400);
  set_threads(2);
  FallingBed two(9);
  two.run(400);
  set_threads(before);
  expect_same(one.infill, two.infill);
}

TEST(Spheres, LoadedFromTheMiddleOfAFallGoOnWithTheSameBits) {
  FallingBed through(6), first(6), second(6);
  for (FallingBed* bed : {&through, &first})
    for (std::size_t i = 0; i < bed->infill.particles().size(); ++i)
      bed->infill.set_velocity(i, {0.05 * std::sin(double(i)), 0, -0.3});  // so that they meet
  through.run(1500);
  first.run(600);
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("tuft-spheres-" + std::to_string(::getpid()) + ".h5");
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group root = file.root();
    first.infill.save(root);
    file.commit();
  }
  second.infill.load(h5::File::open(path).root());
  std::filesystem::remove(path);
  const auto moments = first.infill.stress_moments();
  EXPECT_EQ(moments, second.infill.stress_moments()) << "before anything is evaluated anew";
  EXPECT_TRUE(std::ranges::any_of(moments, [](const auto& m) { return m[2] < 0; }));
  second.run(900);
  expect_same(through.infill, second.infill);
}

}  // namespace
}  // namespace tuft::sph

/// Mass, centre of mass and inertia of overlapping spheres, against closed forms and against themselves
/// turned.
#include "dem_bridge/clump_shape.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "core/error.h"

namespace tuft::dem {
namespace {

constexpr double pi = std::numbers::pi;

Mat3 turned() {
  return (Eigen::AngleAxisd(0.7, Vec3::UnitX()) * Eigen::AngleAxisd(-1.1, Vec3::UnitZ()) *
          Eigen::AngleAxisd(0.4, Vec3::UnitY()))
      .toRotationMatrix();
}

TEST(UnionOfSpheres, OfOneIsTheSphere) {
  const std::vector<Vec3> centre{Vec3(0.3, -0.2, 0.9)};
  const std::vector<double> radius{1.7};
  const UnionMoments m = union_moments(centre, radius);
  const double volume = 4.0 / 3 * pi * std::pow(1.7, 3);
  EXPECT_NEAR(m.volume / volume, 1, 1e-13);
  EXPECT_LT((m.first / volume - centre[0]).norm(), 1e-13);
  const Mat3 second = 0.2 * 1.7 * 1.7 * Mat3::Identity() + centre[0] * centre[0].transpose();
  EXPECT_LT((m.second / volume - second).norm(), 1e-12);
}

/// Two unlike spheres on a slanting axis: caps with moments in closed form, int_h^r pi (r^2 - s^2) s^k ds
/// along the axis.
TEST(UnionOfSpheres, OfTwoIsTheSumOfTheirPartsOnBothSidesOfThePlaneWhereTheyMeet) {
  const double a = 1.0, b = 0.7, distance = 0.9;
  const Vec3 axis = turned().col(0);
  const std::vector<Vec3> centre{Vec3(0, 0, 0), distance * axis};
  const std::vector<double> radius{a, b};
  const double plane = (distance * distance + a * a - b * b) / (2 * distance);  // from the first centre
  double volume = 0, along = 0, along_along = 0, across_across = 0;
  // The part of a sphere of radius r below the height h: integrals over s from -r to h.
  const auto add = [&](double r, double h, double from, double sign) {
    const auto primitive = [r](double s, int k) {
      return pi * (r * r * std::pow(s, k + 1) / (k + 1) - std::pow(s, k + 3) / (k + 3));
    };
    const auto integral = [&](int k) { return primitive(h, k) - primitive(-r, k); };
    const auto quartic = [r](double s) {  // of pi/4 (r^2 - s^2)^2
      return pi / 4 * (r * r * r * r * s - 2.0 / 3 * r * r * s * s * s + std::pow(s, 5) / 5);
    };
    volume += integral(0);
    along += from * integral(0) + sign * integral(1);
    along_along += from * from * integral(0) + 2 * from * sign * integral(1) + integral(2);
    across_across += quartic(h) - quartic(-r);
  };
  add(a, plane, 0, 1);
  add(b, distance - plane, distance, -1);  // looked at from the other side
  const UnionMoments m = union_moments(centre, radius);
  EXPECT_NEAR(m.volume / volume, 1, 1e-12);
  EXPECT_LT((m.first - along * axis).norm(), 1e-12 * volume);
  const Mat3 second =
      along_along * axis * axis.transpose() + across_across * (Mat3::Identity() - axis * axis.transpose());
  EXPECT_LT((m.second - second).norm(), 1e-12 * volume);
}

TEST(UnionOfSpheres, ConvergesAndDoesNotDependOnHowItIsTurned) {
  const std::vector<Vec3> centre{Vec3(0, 0, 0), Vec3(1, 0.2, 0), Vec3(0.3, 0.8, 0.1), Vec3(0.4, 0.3, 0.9),
                                 Vec3(-0.5, 0.4, 0.5)};
  const std::vector<double> radius{1, 0.8, 0.7, 0.9, 0.6};
  std::vector<Vec3> other;
  for (const Vec3& x : centre) other.emplace_back(turned() * x);
  const UnionMoments fine = union_moments(centre, radius, 128), given = union_moments(centre, radius),
                     across = union_moments(other, radius);
  EXPECT_NEAR(given.volume / fine.volume, 1, 1e-12);
  EXPECT_LT((given.second - fine.second).norm(), 1e-12 * fine.second.norm());
  EXPECT_NEAR(across.volume / fine.volume, 1, 1e-12);
  EXPECT_LT((across.first - turned() * fine.first).norm(), 1e-12 * fine.first.norm());
  EXPECT_LT((across.second - turned() * fine.second * turned().transpose()).norm(),
            1e-12 * fine.second.norm());
  const double coarse = std::abs(union_moments(centre, radius, 4).volume / fine.volume - 1),
               middle = std::abs(union_moments(centre, radius, 8).volume / fine.volume - 1);
  EXPECT_LT(coarse, 1e-2);
  EXPECT_LT(middle, 0.05 * coarse);
}

/// By counting: an independent look at a shape without closed form.
TEST(UnionOfSpheres, OfATetrahedronIsWhatRandomPointsHit) {
  const ClumpBody body = make_clump_body({ClumpShape::tetrahedron, 0.4}, "sand");
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> uniform(-body.reach, body.reach);
  constexpr int tries = 400000;
  int hits = 0;
  Mat3 second = Mat3::Zero();
  for (int t = 0; t < tries; ++t) {
    const Vec3 x(uniform(engine), uniform(engine), uniform(engine));
    bool inside = false;
    for (std::size_t i = 0; i < body.size(); ++i)
      inside |= (x - body.centre[i]).squaredNorm() < body.radius[i] * body.radius[i];
    if (!inside) continue;
    ++hits;
    second += x * x.transpose();
  }
  EXPECT_NEAR(hits * std::pow(2 * body.reach, 3) / tries / (pi / 6), 1, 0.006);
  second /= hits;
  const Mat3 inertia = second.trace() * Mat3::Identity() - second;
  EXPECT_LT((inertia - Mat3(body.inertia.asDiagonal())).norm(), 0.01 * body.inertia.norm());
}

TEST(ClumpBody, OfOneSphereIsTheGrain) {
  const ClumpBody body = make_clump_body({ClumpShape::spheres, 0.5, {{1, 2, 3, 7}}}, "sand");
  ASSERT_EQ(body.size(), 1u);
  EXPECT_NEAR(body.radius[0], 0.5, 1e-13);
  EXPECT_LT(body.centre[0].norm(), 1e-13);
  EXPECT_LT((body.inertia - Vec3::Constant(0.1)).norm(), 1e-13) << "2/5 m r^2";
  EXPECT_NEAR(body.stable_share, 1, 1e-12);
}

TEST(ClumpBody, HasTheVolumeOfItsGrainItsCentreAtNoughtAndFallingMoments) {
  for (const Clump& clump :
       {Clump{ClumpShape::pair, 0.3}, Clump{ClumpShape::triangle, 0.5}, Clump{ClumpShape::tetrahedron, 0.6},
        Clump{ClumpShape::spheres,
              0.5,
              {{0, 0, 0, 1}, {1, 0, 0, 0.6}, {0.2, 0.9, 0.1, 0.7}, {0, 0, 1.1, 0.5}}}}) {
    const ClumpBody body = make_clump_body(clump, "sand");
    const UnionMoments m = union_moments(body.centre, body.radius);
    EXPECT_NEAR(m.volume, pi / 6, 1e-12);
    EXPECT_LT(m.first.norm(), 1e-12);
    const Mat3 second = m.second / m.volume;
    EXPECT_LT((second.trace() * Mat3::Identity() - second - Mat3(body.inertia.asDiagonal())).norm(), 1e-12);
    EXPECT_GE(body.inertia[0], body.inertia[1]);
    EXPECT_GE(body.inertia[1], body.inertia[2]);
    double sum = 0;
    Vec3 centre(0, 0, 0);
    for (std::size_t i = 0; i < body.size(); ++i) {
      EXPECT_GT(body.share[i], 0);
      sum += body.share[i];
      centre += body.share[i] * body.centre[i];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_LT(centre.norm(), 1e-12);
    EXPECT_LE(body.stable_share, 1);
    EXPECT_GT(body.stable_share, 0.3);
  }
}

/// Touching spheres are apart: the sums of both, by Steiner.
TEST(ClumpBody, OfTwoThatTouchHasBothInertias) {
  const ClumpBody body = make_clump_body({ClumpShape::pair, 0}, "sand");
  const double r = 0.5 / std::cbrt(2.0);
  EXPECT_NEAR(body.radius[0], r, 1e-13);
  EXPECT_NEAR((body.centre[0] - body.centre[1]).norm(), 2 * r, 1e-13);
  EXPECT_NEAR(body.inertia[2], 0.4 * r * r, 1e-13);
  EXPECT_NEAR(body.inertia[0], 1.4 * r * r, 1e-13);
  EXPECT_NEAR(body.stable_share, 1, 1e-9) << "each sphere is as free as alone";
}

/// A motion of the body has at least the energy of spheres with the share that stable steps go by.
TEST(ClumpBody, BearsWhatItsSpheresBear) {
  std::mt19937_64 engine(7);
  std::normal_distribution<double> normal;
  const auto random = [&] { return Vec3(normal(engine), normal(engine), normal(engine)); };
  for (const double overlap : {0.1, 0.5, 0.8})
    for (const ClumpShape shape : {ClumpShape::pair, ClumpShape::triangle, ClumpShape::tetrahedron}) {
      const ClumpBody body = make_clump_body({shape, overlap}, "sand");
      double nearest = 1e300;
      for (int trial = 0; trial < 2000; ++trial) {
        const Vec3 v = random(), w = 3 * random();
        const double energy = v.squaredNorm() + w.dot(body.inertia.asDiagonal() * w);
        double of_spheres = 0;
        for (std::size_t i = 0; i < body.size(); ++i)
          of_spheres += body.stable_share * body.share[i] *
                        ((v + w.cross(body.centre[i])).squaredNorm() +
                         0.4 * body.radius[i] * body.radius[i] * w.squaredNorm());
        EXPECT_LE(of_spheres, energy * (1 + 1e-12));
        nearest = std::min(nearest, energy / of_spheres);
      }
      EXPECT_LT(nearest, 1.6);
    }
}

}  // namespace
}  // namespace tuft::dem

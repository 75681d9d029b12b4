#include "coupler/soft_overlap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace tuft::coupler {
namespace {

using Facet = std::array<Vec3, 4>;

/// Of a ball with facets of the given stiffnesses (one for all when there is one).
SoftOverlap overlap_of(const Vec3& centre, double touching, const std::vector<Facet>& facets,
                       const std::vector<double>& stiffness = {1e4}) {
  SoftOverlap overlap;
  overlap.clear();
  for (std::size_t e = 0; e < facets.size(); ++e)
    overlap.add_facet(centre, touching, facets[e], stiffness[std::min(e, stiffness.size() - 1)],
                      static_cast<Index>(e));
  if (overlap.count > 0) overlap.finish(centre);
  return overlap;
}

double energy(const SoftOverlap& overlap) {
  return overlap.count == 0
             ? 0
             : 0.5 * overlap.parts[0].root * overlap.parts[0].root * overlap.value * overlap.value;
}

Vec3 force(const SoftOverlap& overlap) {
  if (overlap.count == 0) return {0, 0, 0};
  return overlap.parts[0].root * overlap.parts[0].root * overlap.value * overlap.direction();
}

const Facet unit_square{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)};

/// Two unit squares that meet along y in a hollow of the given half angle from the vertical.
std::vector<Facet> hollow(double half_angle) {
  const double c = std::sin(half_angle), s = std::cos(half_angle);
  return {{Vec3(-c, 0, s), Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(-c, 1, s)},
          {Vec3(0, 0, 0), Vec3(c, 0, s), Vec3(c, 1, s), Vec3(0, 1, 0)}};
}

TEST(SoftOverlap, GivesTheForceThatIsTheSlopeOfItsEnergyAlsoWhereStiffnessChanges) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> within(-1, 1);
  int checked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Facet> facets = hollow(0.6);
    for (Facet& facet : facets)
      for (Vec3& x : facet) x += 0.1 * Vec3(within(generator), within(generator), within(generator));
    const Vec3 centre(0.3 * within(generator), 0.5 + 0.4 * within(generator), 0.6 + 0.2 * within(generator));
    const double touching = 0.4;
    const std::vector<double> stiffness{1e4, 2.5e4};
    const SoftOverlap at = overlap_of(centre, touching, facets, stiffness);
    if (at.count < 2 || at.parts[0].nearness < 0.05) continue;  // on a face the distance itself has a kink
    constexpr double h = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = h * Vec3::Unit(axis);
      const double slope = (energy(overlap_of(centre + step, touching, facets, stiffness)) -
                            energy(overlap_of(centre - step, touching, facets, stiffness))) /
                           (2 * h);
      EXPECT_NEAR(force(at)[axis], -slope, 1e-4 * force(at).norm() + 1e-6);
    }
    ++checked;
  }
  EXPECT_GT(checked, 100);
}

TEST(SoftOverlap, WithOneTriangleIsThatOfTheTriangle) {
  const SoftOverlap d = overlap_of({0.8, 0.2, 0.1}, 0.12, {unit_square});
  ASSERT_EQ(d.count, 1u);
  EXPECT_NEAR(d.value, 0.02, 1e-15);
  EXPECT_NEAR((d.direction() - Vec3(0, 0, 1)).norm(), 0, 1e-14);
  EXPECT_NEAR(d.parts[0].share, 1, 1e-15);
}

TEST(SoftOverlap, OfABallThatIsApartIsNothingAndTellsTheGap) {
  const SoftOverlap d = overlap_of({0.8, 0.2, 0.1}, 0.07, {unit_square});
  EXPECT_EQ(d.count, 0u);
  EXPECT_EQ(d.value, 0);
  EXPECT_NEAR(d.gap, 0.03, 1e-15);
}

TEST(SoftOverlap, OfNTrianglesAtOneDepthIsTheEighthRootOfNDeeper) {
  const SoftOverlap edge = overlap_of({0.5, 0.5, 0.1}, 0.2, {unit_square});  // over the diagonal
  ASSERT_EQ(edge.count, 2u);
  EXPECT_NEAR(edge.value, 0.1 * std::pow(2, 0.125), 1e-15);
  EXPECT_NEAR(edge.direction().z(), std::pow(2, 0.125), 1e-14);
  EXPECT_NEAR(edge.parts[0].share, 0.5, 1e-14);
}

TEST(SoftOverlap, TurnsItsPushSmoothlyAcrossAHollow) {
  // The deepest part alone would jump between the two walls' normals within any step, however small.
  const std::vector<Facet> walls = hollow(0.5);
  const double touching = 0.4;
  Vec3 before = force(overlap_of({-0.1, 0.5, 0.6}, touching, walls));
  const double size = before.norm();
  double largest = 0;
  for (int i = 1; i <= 2000; ++i) {
    const Vec3 now = force(overlap_of({-0.1 + 0.2 * i / 2000, 0.5, 0.6}, touching, walls));
    largest = std::max(largest, (now - before).norm());
    before = now;
  }
  EXPECT_LT(largest, 0.01 * size);
}

TEST(SoftOverlap, MeetsEveryTriangleWithoutAJumpOfItsForce) {
  // Down into a hollow a little off its middle: parts come in one after the other, each from nothing.
  const std::vector<Facet> walls = hollow(0.9);
  Vec3 before(0, 0, 0);
  std::size_t most = 0;
  double largest = 0, size = 0;
  for (int i = 0; i <= 4000; ++i) {
    const SoftOverlap d = overlap_of({0.02, 0.5, 1.0 - 0.8 * i / 4000}, 0.4, walls);
    largest = std::max(largest, (force(d) - before).norm());
    before = force(d);
    size = std::max(size, before.norm());
    most = std::max(most, d.count);
  }
  EXPECT_GE(most, 3u);
  EXPECT_LT(largest, 0.01 * size);
}

TEST(SoftOverlap, KeepsTheDeepestTrianglesInAnyOrderOfFacets) {
  std::vector<Facet> facets;
  for (int i = 0; i < 12; ++i) {  // 24 triangles, more than are kept
    const double x = 0.05 * i;
    facets.push_back({Vec3(x, 0, 0), Vec3(x + 0.05, 0, 0), Vec3(x + 0.05, 0.2, 0), Vec3(x, 0.2, 0)});
  }
  const Vec3 centre(0.28, 0.07, 0.3);
  const SoftOverlap forward = overlap_of(centre, 0.6, facets);
  std::reverse(facets.begin(), facets.end());
  const SoftOverlap backward = overlap_of(centre, 0.6, facets);
  ASSERT_EQ(forward.count, SoftOverlap::most_parts);
  for (std::size_t i = 0; i < forward.count; ++i)
    EXPECT_DOUBLE_EQ(forward.parts[i].overlap, backward.parts[i].overlap);
  EXPECT_NEAR(forward.value, backward.value, 1e-14);
}

TEST(SoftOverlap, OfABallThatHasPassedThroughGrowsOnAndPushesBack) {
  SoftOverlap d = overlap_of({0.7, 0.3, -0.1}, 0.2, {unit_square});
  EXPECT_LT(d.direction().z(), 0);
  d.take_as_passed();
  EXPECT_NEAR(d.parts[0].overlap, 0.3, 1e-12);
  EXPECT_GT(d.direction().z(), 0.9);
}

TEST(SoftOverlap, DoesNotJumpWhereTheBallsCentrePassesThroughNearAFold) {
  const SoftOverlap before = overlap_of({0.52, 0.5, 1e-7}, 0.2, {unit_square});
  SoftOverlap after = overlap_of({0.52, 0.5, -1e-7}, 0.2, {unit_square});
  ASSERT_EQ(before.count, 2u);
  after.take_as_passed();
  EXPECT_NEAR(after.value, before.value, 1e-6);
}

}  // namespace
}  // namespace tuft::coupler

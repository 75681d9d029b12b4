#include "sph_infill/separated_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/error.h"
#include "sph_infill/neighbour_list.h"
#include "sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double reach = 0.3;

Vec3Array random_points(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(-0.5, 0.5);
  Vec3Array points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = along(random), y = along(random);
    points.push_back({x, y, along(random)});
  }
  return points;
}

/// Two halves of the rectangle |x| < 0.2, |y| < 0.1 in the plane of z = 0, turned by `turn`.
std::vector<Sheet> two_halves(const Mat3& turn) {
  std::vector<Sheet> sheets;
  for (const double from : {-0.2, 0.0}) {
    const double to = from + 0.2;
    sheets.push_back({turn * Vec3(from, -0.1, 0), turn * Vec3(to, -0.1, 0), turn * Vec3(to, 0.1, 0),
                      turn * Vec3(from, 0.1, 0)});
  }
  return sheets;
}

Mat3 some_turn() {
  return Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
}

/// By where the line meets the plane, for sheets larger by `edge` all around.
bool is_separated(const Mat3& turn, const Vec3& a, const Vec3& b, double edge) {
  const Vec3 p = turn.transpose() * a, q = turn.transpose() * b;
  if ((p.z() >= 0) == (q.z() >= 0) || (p - q).norm() >= reach) return false;
  const Vec3 met = p + p.z() / (p.z() - q.z()) * (q - p);
  return std::abs(met.x()) < 0.2 + edge && std::abs(met.y()) < 0.1 + edge;
}

TEST(SeparatedPairs, AreThoseWhoseLineOfCentresMeetsASheet) {
  const Vec3Array points = random_points(500, 1);
  const Mat3 turn = some_turn();
  const std::vector<Sheet> sheets = two_halves(turn);
  const SeparatedPairs pairs(points, sheets, reach);
  std::size_t found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = pairs.of(i);
    EXPECT_TRUE(std::is_sorted(row.begin(), row.end()));
    found += row.size();
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j == i) continue;
      const bool listed = std::binary_search(row.begin(), row.end(), static_cast<Index>(j));
      EXPECT_GE(listed, is_separated(turn, points[i], points[j], 0)) << i << ", " << j;
      EXPECT_LE(listed, is_separated(turn, points[i], points[j], 0.03 * reach)) << i << ", " << j;
    }
  }
  EXPECT_GT(found, 200u);
}

TEST(SeparatedPairs, OfALatticeThatASheetLiesInCountItsPlaneAsAbove) {
  Vec3Array points;
  for (const double z : {-0.1, 0.0, 0.1}) points.push_back({0, 0, z});
  const std::vector<Sheet> sheets{{Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)}};
  const SeparatedPairs pairs(points, sheets, 0.25);
  EXPECT_EQ(pairs.values(), (std::vector<double>{0, 1, 0, 2}));
}

TEST(SeparatedPairs, ComeBackFromTheirValues) {
  const Vec3Array points = random_points(300, 2);
  const std::vector<Sheet> sheets = two_halves(some_turn());
  const SeparatedPairs pairs(points, sheets, reach);
  EXPECT_FALSE(pairs.empty());
  EXPECT_EQ(SeparatedPairs(pairs.values(), points.size()), pairs);
}

TEST(SeparatedPairs, AreLeftOutOfRowsFromTheNextBuildOn) {
  const Vec3Array points = random_points(300, 3);
  const std::vector<Sheet> sheets = two_halves(some_turn());
  NeighbourList list(points, 0.25, 0.05);
  list.build(points);
  std::vector<std::vector<Index>> whole;
  for (std::size_t i = 0; i < points.size(); ++i) whole.push_back(list.row(i));
  list.separate(SeparatedPairs(points, sheets, reach));
  list.build(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto gone = list.separated().of(i);
    std::vector<Index> expected;
    std::set_difference(whole[i].begin(), whole[i].end(), gone.begin(), gone.end(),
                        std::back_inserter(expected));
    EXPECT_EQ(list.row(i), expected);
  }
}

/// A block that is drawn apart in the plane of a sheet feels nothing of it; without the sheet it holds
/// together.
TEST(SeparatedPairs, LetTwoHalvesOfABlockGoTheirWays) {
  constexpr int n = 8;
  constexpr double pitch = 0.001, middle = 0.5 * n * pitch;
  const Lattice lattice = test::block(n, n, n, pitch);
  SphSettings settings;
  settings.options.smoothing_length = 1.3 * pitch;
  settings.gravity = Vec3::Zero();
  const std::vector<Material> materials = test::single_material(test::elastic_material(1e6, 1000));
  const double far = 10 * pitch;
  const std::vector<Sheet> sheet{
      {Vec3(-far, -far, middle), Vec3(far, -far, middle), Vec3(far, far, middle), Vec3(-far, far, middle)}};
  for (const bool cut : {true, false}) {
    SphInfill block(lattice, materials, settings);
    for (std::size_t i = 0; i < lattice.volume.size(); ++i)
      block.set_velocity(i, Vec3(0, 0, lattice.position.z[i] > middle ? 1 : -1));
    if (cut) block.set_sheets(sheet);
    const double dt = 0.5 * block.stable_step();
    for (int step = 0; step < 20; ++step) block.advance(dt, 1, {});
    const InfillEnergy energy = block.energy();
    const double kinetic = 0.5 * 1000 * std::pow(n * pitch, 3);
    if (cut) {
      EXPECT_NEAR(energy.kinetic, kinetic, 1e-12 * kinetic);
      EXPECT_NEAR(energy.stored + energy.dissipated, 0, 1e-12 * kinetic);
    } else {
      EXPECT_LT(energy.kinetic, 0.9 * kinetic);
    }
  }
}

}  // namespace
}  // namespace tuft::sph

// Where spheres begin, and how the density is measured that they reach.
#include <gtest/gtest.h>

#include "core/error.h"
#include "sph_infill/compaction.h"
#include "sph_infill/sphere_infill.h"
#include "sph_infill/sphere_placing.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

PlacingRequest request_of(const Lattice& lattice, double diameter, std::array<double, 2> size) {
  return {sphere_radii(lattice, diameter), sphere_radii(lattice, 1), {size, 0}, 1};
}

TEST(SpherePlacing, LeavesNoOverlapAndStaysWithinTheWalls) {
  // Rows 1.25 and 0.9 pitches high: spheres as wide as the cubes of their volumes do not fit the lattice.
  Turf turf;
  turf.layers = {{0, 0.0025}, {0, 0.009}};
  const std::array<double, 2> size{0.02, 0.016};
  const Lattice lattice = make_lattice(turf, {size, 0}, pitch);
  const PlacingRequest request = request_of(lattice, 1, size);
  const Placing placed = place_spheres(lattice, request);
  for (std::size_t i = 0; i < lattice.position.size(); ++i) {
    const Vec3 x = placed.position[i];
    const double wall = request.wall_radius[i];
    EXPECT_LE(std::abs(x.x()), 0.5 * size[0] - wall + 1e-12);
    EXPECT_LE(std::abs(x.y()), 0.5 * size[1] - wall + 1e-12);
    EXPECT_GE(x.z(), wall - 1e-12);
    for (std::size_t j = 0; j < i; ++j) {
      const double reach = request.sphere_radius[i] + request.sphere_radius[j];
      EXPECT_GE((x - placed.position[j]).norm(), (1 - 2e-4) * reach) << i << ", " << j;
    }
  }
}

TEST(SpherePlacing, IsDecidedByItsSeed) {
  const Lattice lattice = test::block(6, 6, 6, pitch);
  PlacingRequest request = request_of(lattice, 0.96, {6 * pitch, 6 * pitch});
  const Placing one = place_spheres(lattice, request), again = place_spheres(lattice, request);
  request.seed = 2;
  const Placing other = place_spheres(lattice, request);
  EXPECT_EQ(one.position.z, again.position.z);
  EXPECT_NE(one.position.z, other.position.z);
}

TEST(SpherePlacing, SpheresTooLargeForTheRoomAreRefused) {
  const Lattice lattice = test::block(4, 4, 4, pitch);
  PlacingRequest request = request_of(lattice, 1.4, {4 * pitch, 4 * pitch});
  request.wall_radius.assign(lattice.volume.size(),
                             2 * pitch - 1e-9);  // hardly room for one beside the other
  EXPECT_THROW((void)place_spheres(lattice, request), RunError);
}

TEST(Compaction, IsOneOnTheLatticeAndFollowsAnEvenCompressionInsideToOnePercentAndAtSurfacesToFour) {
  Turf turf;
  turf.layers = {{0, 0.006}, {0, 0.014}};
  const Lattice lattice = make_lattice(turf, {{0.02, 0.02}, 0}, pitch);
  const CompactionMeasure measure(lattice, test::options_of(test::Preset::accurate, pitch));
  for (const double ratio : measure.ratio(lattice.position)) EXPECT_DOUBLE_EQ(ratio, 1);
  Vec3Array pressed = lattice.position;
  for (double& z : pressed.z) z *= 0.9;
  const std::vector<double> ratio = measure.ratio(pressed), smooth = measure.smoothed(pressed, ratio);
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    const double z = lattice.position.z[i];
    const bool inside = z > 0.005 && z < 0.015;
    EXPECT_NEAR(ratio[i], 1 / 0.9, inside ? 0.01 : 0.045) << z;
    EXPECT_NEAR(smooth[i], 1 / 0.9, inside ? 0.015 : 0.045) << z;
  }
}

TEST(Compaction, VolumesOfADisorderedBedAddUpToItsRoomWithinTwoPercent) {
  const int n = 10;
  Lattice lattice = test::block(n, n, n, pitch);
  const CompactionMeasure measure(lattice, test::options_of(test::Preset::accurate, pitch));
  Lattice moved = lattice;
  test::jitter(moved, 0.25);
  const std::vector<double> ratio = measure.ratio(moved.position),
                            smooth = measure.smoothed(moved.position, ratio);
  double raw_room = 0, room = 0, placed = 0, raw_square = 0, square = 0;
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    placed += lattice.volume[i];
    raw_room += lattice.volume[i] / ratio[i];
    room += lattice.volume[i] / smooth[i];
    raw_square += std::pow(ratio[i] - 1, 2);
    square += std::pow(smooth[i] - 1, 2);
  }
  EXPECT_NEAR(raw_room, placed, 0.02 * placed);
  EXPECT_NEAR(room, placed, 0.02 * placed);
  EXPECT_LT(square, 0.5 * raw_square);  // a bed as dense as placed: all of the spread is noise
}

}  // namespace
}  // namespace tuft::sph

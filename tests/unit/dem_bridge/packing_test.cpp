/// What a packing promises: mass, walls, obstacles, little overlap, the same grains for the same seed.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/error.h"
#include "core/geometry.h"
#include "dem_bridge/clump_bodies.h"
#include "dem_bridge/dem_infill.h"

namespace tuft::dem {
namespace {

/// Sand, a sand-rubber mixture and rubber, as in the published turf but coarse.
class Packing : public ::testing::Test {
 protected:
  Packing() {
    materials_.resize(5);
    materials_[0].name = "sand grain";
    materials_[0].grain = GrainMaterial{2650, 50e6, 0.25, 0.6, 0.5, 0.1, 0.0002, 0.0012};
    materials_[1].name = "rubber grain";
    materials_[1].grain = GrainMaterial{1150, 8e6, 0.45, 0.5, 0.7, 0.1, 0.0008, 0.0017};
    materials_[2].name = "sand";
    materials_[2].bulk_density = 1600;
    materials_[2].grain_shares = {{0, 1.0}};
    materials_[3].name = "mixture";
    materials_[3].bulk_density = 977;
    materials_[3].grain_shares = {{0, 0.7}, {1, 0.3}};
    materials_[4].name = "rubber";
    materials_[4].bulk_density = 440;
    materials_[4].grain_shares = {{1, 1.0}};
    turf_.layers = {{2, 0.006}, {3, 0.012}, {4, 0.012}};
    options_.coarse_graining = 2.5;
    options_.material_coarse_graining["sand grain"] = 3.5;
    request_.size = {0.04, 0.03};
    request_.floor = 0.002;
    request_.turf = &turf_;
    request_.materials = &materials_;
    request_.options = &options_;
  }

  [[nodiscard]] double mass(const Grains& grains, std::size_t i) const {
    return 4.0 / 3.0 * std::numbers::pi * std::pow(grains.radius[i], 3) * grains.density[i];
  }
  /// Upright strips 1.3 mm wide, like fibres.
  [[nodiscard]] std::vector<ThinQuad> fibres() const {
    std::vector<ThinQuad> quads;
    for (double x = -0.015; x < 0.02; x += 0.009)
      for (double y = -0.01; y < 0.015; y += 0.009)
        for (int k = 0; k < 10; ++k) {
          const double low = 0.002 + 0.003 * k, lean = 0.0002 * k;
          quads.push_back(
              {{Vec3(x + lean, y, low), Vec3(x + lean, y + 0.0013, low),
                Vec3(x + lean + 0.0002, y + 0.0013, low + 0.003), Vec3(x + lean + 0.0002, y, low + 0.003)},
               5e-5});
        }
    return quads;
  }

  std::vector<Material> materials_;
  Turf turf_;
  DemOptions options_;
  PackingRequest request_;
};

TEST_F(Packing, LayersHaveTheirMassToHalfAGrain) {
  const Grains grains = pack_grains(request_);
  for (std::size_t l = 0; l < 3; ++l) {
    const Material& material = materials_[static_cast<std::size_t>(turf_.layers[l].material)];
    for (const GrainShare& share : material.grain_shares) {
      double sum = 0;
      for (std::size_t i = 0; i < grains.size(); ++i)
        if (grains.layer[i] == static_cast<Index>(l) && grains.material[i] == share.material)
          sum += mass(grains, i);
      const GrainMaterial& grain = *materials_[static_cast<std::size_t>(share.material)].grain;
      const double diameter = grain.diameter_max * (share.material == 0 ? 3.5 : 2.5);
      const double half_a_grain = 0.5 * std::numbers::pi / 6 * std::pow(diameter, 3) * grain.density;
      EXPECT_NEAR(sum, share.mass_fraction * material.bulk_density * 0.04 * 0.03 * turf_.layers[l].depth,
                  half_a_grain);
    }
  }
}

TEST_F(Packing, DiametersAreUniformBetweenTheCoarseGrainedLimits) {
  const Grains grains = pack_grains(request_);
  std::vector<double> diameters;
  for (std::size_t i = 0; i < grains.size(); ++i)
    if (grains.material[i] == 1) diameters.push_back(2 * grains.radius[i]);
  ASSERT_GT(diameters.size(), 200u);
  const auto [smallest, largest] = std::minmax_element(diameters.begin(), diameters.end());
  EXPECT_GE(*smallest, 2.5 * 0.0008 * (1 - 1e-12));
  EXPECT_LE(*largest, 2.5 * 0.0017 * (1 + 1e-12));
  double mean = 0;
  for (double d : diameters) mean += d / static_cast<double>(diameters.size());
  const double width = 2.5 * 0.0009;
  EXPECT_NEAR(mean, 2.5 * 0.00125, 4 * width / std::sqrt(12.0 * static_cast<double>(diameters.size())));
}

TEST_F(Packing, DrawnAtRandomTheyDepartFromTheUniformLawAsOneOverTheRootOfTheirNumber) {
  const Grains grains = pack_grains(request_);
  std::vector<double> diameters;
  for (std::size_t i = 0; i < grains.size(); ++i)
    if (grains.material[i] == 0) diameters.push_back(2 * grains.radius[i]);
  std::sort(diameters.begin(), diameters.end());
  const auto n = static_cast<double>(diameters.size());
  double distance = 0;
  for (std::size_t k = 0; k < diameters.size(); ++k) {
    const double share = (diameters[k] / 3.5 - 0.0002) / 0.001;
    distance =
        std::max({distance, share - static_cast<double>(k) / n, static_cast<double>(k + 1) / n - share});
  }
  ASSERT_GT(n, 300);
  EXPECT_LT(distance * std::sqrt(n), 1.63) << "Kolmogorov's bound that chance passes once in a hundred";
}

TEST_F(Packing, LognormalAndSievedGrainsAreScaledAndGiveTheLayersTheirMass) {
  GrainMaterial &sand = *materials_[0].grain, &rubber = *materials_[1].grain;
  sand.sizes = {
      .law = SizeLaw::sieve, .by = SizeShares::mass, .sieve = {{0.0004, 0.0006, 0.0012}, {0, 0.3, 1}}};
  rubber.sizes = {
      .law = SizeLaw::lognormal, .by = SizeShares::mass, .median = 0.0012, .geometric_deviation = 1.3};
  const Grains grains = pack_grains(request_);
  std::array<double, 2> sum{}, finer{}, asked{};
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const auto kind = static_cast<std::size_t>(grains.material[i]);
    const double scale = kind == 0 ? 3.5 : 2.5, d = 2 * grains.radius[i] / scale;
    EXPECT_GE(d, (kind == 0 ? 0.0004 : 0.0008) * (1 - 1e-12));
    EXPECT_LE(d, (kind == 0 ? 0.0012 : 0.0017) * (1 + 1e-12));
    sum[kind] += mass(grains, i);
    if (d < (kind == 0 ? 0.0006 : 0.0012)) finer[kind] += mass(grains, i);
  }
  const double area = 0.04 * 0.03;
  asked[0] = (1600 * 0.006 + 0.7 * 977 * 0.012) * area;
  asked[1] = (0.3 * 977 * 0.012 + 440 * 0.012) * area;
  for (std::size_t kind = 0; kind < 2; ++kind) EXPECT_NEAR(sum[kind], asked[kind], 1e-9 * asked[kind]);
  EXPECT_NEAR(finer[0] / sum[0], 0.3, 0.02);
  const double below = std::erf(std::log(1.2 / 0.8) / std::log(1.3) / std::numbers::sqrt2),
               above = std::erf(std::log(1.7 / 1.2) / std::log(1.3) / std::numbers::sqrt2);
  EXPECT_NEAR(finer[1] / sum[1], below / (below + above), 0.02);
}

TEST_F(Packing, StaysInsideWallsFloorAndDepth) {
  const Grains grains = pack_grains(request_);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const Vec3 x = grains.position[i];
    const double r = grains.radius[i] * (1 - 1e-12);
    EXPECT_LE(std::abs(x.x()) + r, 0.02);
    EXPECT_LE(std::abs(x.y()) + r, 0.015);
    EXPECT_GE(x.z() - r, 0.002);
    EXPECT_LE(x.z() + r, 0.002 + 0.030 + 1e-12);
  }
}

TEST_F(Packing, OverlapsAreSmall) {
  const auto quads = fibres();
  request_.obstacles = quads;
  const Grains grains = pack_grains(request_);
  double worst = 0, worst_obstacle = 0, sum = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double overlap =
          grains.radius[i] + grains.radius[j] - (grains.position[i] - grains.position[j]).norm();
      worst = std::max(worst, overlap / std::min(grains.radius[i], grains.radius[j]));
      sum += std::max(0.0, overlap);
    }
    for (const ThinQuad& quad : quads) {
      const double distance =
          std::sqrt(closest_point_on_facet(grains.position[i], quad.corner).distance_squared);
      worst_obstacle =
          std::max(worst_obstacle, (grains.radius[i] + quad.half_thickness - distance) / grains.radius[i]);
    }
  }
  EXPECT_LT(worst, 0.25);
  EXPECT_LT(worst_obstacle, 0.25);
  EXPECT_LT(sum / static_cast<double>(grains.size()), 0.02 * 0.001) << "mean overlap";
  RecordProperty("grains", static_cast<int>(grains.size()));
}

/// Strands in pairs, so near to each other that the largest grains do not fit between the two.
TEST_F(Packing, GrainsThatStickBetweenStrandsAreMovedAndLayersKeepTheirMass) {
  std::vector<ThinQuad> quads = fibres();
  for (ThinQuad quad : fibres()) {
    for (Vec3& corner : quad.corner) corner.x() += 0.0015;
    quads.push_back(quad);
  }
  const Grains free = pack_grains(request_);
  request_.obstacles = quads;
  const Grains grains = pack_grains(request_);
  EXPECT_EQ(free.moved, 0u);
  EXPECT_GT(grains.moved, 5u);
  std::vector<double> radii = grains.radius, as_drawn = free.radius;
  std::sort(radii.begin(), radii.end());
  std::sort(as_drawn.begin(), as_drawn.end());
  EXPECT_EQ(radii, as_drawn);
  double worst = 0;
  for (std::size_t i = 0; i < grains.size(); ++i)
    for (const ThinQuad& quad : quads)
      worst = std::max(
          worst, 1 + quad.half_thickness / grains.radius[i] -
                     std::sqrt(closest_point_on_facet(grains.position[i], quad.corner).distance_squared) /
                         grains.radius[i]);
  EXPECT_LT(worst, 0.25);
}

TEST_F(Packing, GrainsLieOnEachOther) {
  const Grains grains = pack_grains(request_);
  double contacts = 0, solid = 0, top = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    solid += 4.0 / 3 * std::numbers::pi * std::pow(grains.radius[i], 3);
    top = std::max(top, grains.position.z[i] + grains.radius[i]);
    for (std::size_t j = 0; j < i; ++j)
      contacts +=
          (grains.position[i] - grains.position[j]).norm() < grains.radius[i] + grains.radius[j] ? 1 : 0;
  }
  EXPECT_GT(2 * contacts / static_cast<double>(grains.size()), 2.5);
  EXPECT_GT(solid / (0.04 * 0.03 * (top - request_.floor)), 0.48)
      << "as placed the rubber fills 0.38 of its layer";
}

TEST_F(Packing, FillsARoundContainerEvenlyAndStaysInIt) {
  request_.size = {0.04, 0.04};
  request_.round = true;
  const Grains grains = pack_grains(request_);
  double sum = 0, inner = 0, expected = 0;
  for (const Layer& layer : turf_.layers)
    expected += materials_[static_cast<std::size_t>(layer.material)].bulk_density * std::numbers::pi * 0.02 *
                0.02 * layer.depth;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const double from_axis = std::hypot(grains.position.x[i], grains.position.y[i]);
    EXPECT_LE(from_axis + grains.radius[i], 0.02 + 1e-12);
    sum += mass(grains, i);
    if (from_axis < 0.02 / std::numbers::sqrt2) inner += mass(grains, i);
  }
  EXPECT_NEAR(sum, expected, 0.01 * expected);
  EXPECT_NEAR(inner, 0.5 * sum, 0.06 * sum) << "in half of the area; centres keep off the wall";
  request_.size[1] = 0.03;
  EXPECT_THROW((void)pack_grains(request_), InputError);
}

TEST_F(Packing, OfOneGrainAcrossStandsOnTheAxisOfItsTube) {
  materials_[4].bulk_density = 1150 * 2.0 / 3;
  materials_[1].grain->diameter_min = materials_[1].grain->diameter_max = 0.004;
  options_.coarse_graining = 1;
  turf_.layers = {{4, 0.02}};
  request_.size = {0.004, 0.004};
  request_.round = true;
  const Grains grains = pack_grains(request_);
  ASSERT_EQ(grains.size(), 5u);
  for (std::size_t i = 0; i < grains.size(); ++i)
    EXPECT_LT(std::hypot(grains.position.x[i], grains.position.y[i]), 1e-12);
}

TEST_F(Packing, IsTheSameForASeedAndAnotherForAnother) {
  const Grains one = pack_grains(request_), two = pack_grains(request_);
  EXPECT_EQ(one.position.x, two.position.x);
  EXPECT_EQ(one.position.z, two.position.z);
  EXPECT_EQ(one.radius, two.radius);
  EXPECT_EQ(one.material, two.material);
  request_.seed = 2;
  EXPECT_NE(pack_grains(request_).position.x, one.position.x);
}

/// Measured when beds were first let fall on themselves; results were published with them. Sums to rounding,
/// and where grains lie to a hundredth: which one goes where depends on the processor's vectors.
TEST_F(Packing, UniformNumbersGiveTheGrainsOfEarlierVersions) {
  const Grains grains = pack_grains(request_);
  ASSERT_EQ(grains.size(), 1209u);
  double radius = 0, volume = 0, height = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    radius += grains.radius[i];
    volume += std::pow(grains.radius[i], 3);
    height += grains.position.z[i] / 1209;
  }
  EXPECT_NEAR(radius, 1.6605864616919954, 1e-12 * radius);
  EXPECT_NEAR(volume, 4.1164972980962691e-06, 1e-12 * volume);
  EXPECT_NEAR(height, 0.01286, 0.01 * height);
}

TEST_F(Packing, LayersKeepTheirOrderAndMixturesAreMixed) {
  const Grains grains = pack_grains(request_);
  std::array<double, 3> height{}, count{};
  std::array<double, 2> mixed{}, mixed_count{};
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const auto l = static_cast<std::size_t>(grains.layer[i]);
    height[l] += grains.position.z[i];
    count[l] += 1;
    if (l != 1) continue;
    mixed[static_cast<std::size_t>(grains.material[i])] += grains.position.z[i];
    mixed_count[static_cast<std::size_t>(grains.material[i])] += 1;
  }
  EXPECT_NEAR(height[0] / count[0], 0.005, 0.001);
  EXPECT_NEAR(height[1] / count[1], 0.014, 0.0015);
  EXPECT_NEAR(height[2] / count[2], 0.0227, 0.001) << "lower than as asked for: it is loose as crumb is";
  EXPECT_NEAR(mixed[0] / mixed_count[0], mixed[1] / mixed_count[1], 0.002);
}

TEST_F(Packing, TooDenseALayerGrowsUpwards) {
  materials_[4].bulk_density = 900;  // 0.78 of the rubber's density
  turf_.layers = {{4, 0.012}};
  const Grains grains = pack_grains(request_);
  double top = 0, sum = 0, worst = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    top = std::max(top, grains.position.z[i] + grains.radius[i]);
    sum += mass(grains, i);
    for (std::size_t j = 0; j < i; ++j)
      worst = std::max(
          worst, (grains.radius[i] + grains.radius[j] - (grains.position[i] - grains.position[j]).norm()) /
                     std::min(grains.radius[i], grains.radius[j]));
  }
  EXPECT_NEAR(sum, 900 * 0.04 * 0.03 * 0.012, 0.01 * sum);
  EXPECT_GT(top, 0.002 + 0.012);
  EXPECT_LE(top, 0.002 + 0.012 * (900.0 / 1150) / 0.48 + 1e-9);
  EXPECT_LT(worst, 0.4);
}

TEST_F(Packing, SaysWhatIsMissing) {
  const auto message = [&] {
    try {
      (void)pack_grains(request_);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing was thrown");
  };
  options_.coarse_graining = 30;
  EXPECT_NE(message().find("less coarse graining"), std::string::npos) << message();
  options_.coarse_graining = 2.5;
  materials_[1].grain.reset();
  EXPECT_NE(message().find("rubber grain of mixture has no [grain] block"), std::string::npos) << message();
  materials_[3].grain_shares.clear();
  EXPECT_NE(message().find("mixture has no grains"), std::string::npos) << message();
}

/// Sand of clumps among spheres of rubber.
class PackingOfClumps : public Packing {
 protected:
  PackingOfClumps() {
    materials_[0].grain->clump = Clump{ClumpShape::tetrahedron, 0.5};
    request_.clumps = true;
  }
};

TEST_F(PackingOfClumps, HasTheMassesNumbersAndVolumesOfTheSpheresInWhosePlaceTheyAre) {
  const Grains clumps = pack_grains(request_);
  request_.clumps = false;
  const Grains spheres = pack_grains(request_);
  const GrainBodies found = find_bodies(clumps, materials_);
  std::vector<double> of_spheres, of_clumps;
  for (std::size_t i = 0; i < spheres.size(); ++i)
    if (spheres.material[i] == 0) of_spheres.push_back(2 * spheres.radius[i]);
  for (const GrainBody& body : found.bodies) of_clumps.push_back(body.diameter);
  std::sort(of_spheres.begin(), of_spheres.end());
  std::sort(of_clumps.begin(), of_clumps.end());
  ASSERT_EQ(of_clumps.size(), of_spheres.size());
  ASSERT_GT(of_clumps.size(), 100u);
  for (std::size_t k = 0; k < of_clumps.size(); ++k) EXPECT_NEAR(of_clumps[k], of_spheres[k], 1e-12);
  EXPECT_EQ(clumps.size(), spheres.size() + 3 * of_clumps.size());
}

/// Without the effect a material's clump changes no bit.
TEST_F(PackingOfClumps, SwitchedOffIsThatOfMaterialsWithoutThem) {
  request_.clumps = false;
  const Grains off = pack_grains(request_);
  materials_[0].grain->clump.reset();
  const Grains never = pack_grains(request_);
  EXPECT_TRUE(off.body.empty());
  EXPECT_EQ(off.position.x, never.position.x);
  EXPECT_EQ(off.position.z, never.position.z);
  EXPECT_EQ(off.radius, never.radius);
}

TEST_F(PackingOfClumps, StaysWithinWallsAndFloorOverlapsLittleAndIsTheSameForTheSameSeed) {
  const std::vector<ThinQuad> quads = fibres();
  request_.obstacles = quads;
  for (const bool round : {false, true}) {
    request_.round = round;
    if (round) request_.size = {0.03, 0.03};
    const Grains grains = pack_grains(request_), again = pack_grains(request_);
    EXPECT_EQ(grains.position.x, again.position.x);
    EXPECT_EQ(grains.body, again.body);
    double overlap = 0;
    int pairs = 0;
    for (std::size_t i = 0; i < grains.size(); ++i) {
      const Vec3 x = grains.position[i];
      const double r = grains.radius[i];
      EXPECT_GE(x.z() - r, request_.floor - 1e-9);
      if (round) {
        EXPECT_LE(x.head<2>().norm() + r, 0.5 * request_.size[0] + 1e-5);
      } else {
        EXPECT_LE(std::abs(x.x()) + r, 0.5 * request_.size[0] + 1e-9);
        EXPECT_LE(std::abs(x.y()) + r, 0.5 * request_.size[1] + 1e-9);
      }
      for (std::size_t j = 0; j < i; ++j) {
        if (grains.body[i] >= 0 && grains.body[i] == grains.body[j]) continue;
        const double depth = r + grains.radius[j] - (x - grains.position[j]).norm();
        if (depth <= 0) continue;
        overlap += depth / std::min(r, grains.radius[j]);
        ++pairs;
      }
    }
    ASSERT_GT(pairs, 100);
    EXPECT_LT(overlap / pairs, 0.1);
  }
}

/// No direction is preferred: of all axes the mean of products is a third.
TEST_F(PackingOfClumps, IsTurnedAtRandom) {
  const GrainBodies found = find_bodies(pack_grains(request_), materials_);
  Mat3 mean = Mat3::Zero();
  for (const GrainBody& body : found.bodies)
    mean += body.axes.col(0) * body.axes.col(0).transpose() / static_cast<double>(found.bodies.size());
  EXPECT_LT((mean - Mat3::Identity() / 3).norm(), 2 / std::sqrt(static_cast<double>(found.bodies.size())));
}

TEST_F(PackingOfClumps, IsScaledByCoarseGraining) {
  options_.material_coarse_graining["sand grain"] = 3;
  const GrainBodies found = find_bodies(pack_grains(request_), materials_);
  for (const GrainBody& body : found.bodies) {
    EXPECT_GE(body.diameter, 3 * 0.0002 * (1 - 1e-9));
    EXPECT_LE(body.diameter, 3 * 0.0012 * (1 + 1e-9));
  }
}

}  // namespace
}  // namespace tuft::dem

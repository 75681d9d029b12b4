#include "coupler/layer_depth.h"

#include <gtest/gtest.h>

namespace tuft::coupler {
namespace {

struct Bed {
  std::vector<double> x, y, z, radius;
  std::vector<Index> layer;
  void add(double px, double py, double pz, double r, Index l) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
    radius.push_back(r);
    layer.push_back(l);
  }
  [[nodiscard]] ParticleView view() const {
    ParticleView v;
    v.x = x;
    v.y = y;
    v.z = z;
    v.radius = radius;
    v.layer = layer;
    return v;
  }
};

/// A cubic lattice on a floor at z = 0.002, two layers of 3 and 4 planes.
Bed lattice() {
  Bed bed;
  constexpr double r = 0.001;
  for (int k = 0; k < 7; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 20; ++i)
        bed.add(-0.02 + (2 * i + 1) * r, -0.02 + (2 * j + 1) * r, 0.002 + (2 * k + 1) * r, r, k < 3 ? 0 : 1);
  return bed;
}

TEST(LayerTops, OfALatticeAreWhereItsPlanesEnd) {
  const Bed bed = lattice();
  const std::vector<double> tops = layer_tops(bed.view(), {0.04, 0.04}, 0.002, 2);
  ASSERT_EQ(tops.size(), 2u);
  EXPECT_NEAR(tops[0], 0.006, 1e-15);
  EXPECT_NEAR(tops[1], 0.014, 1e-15);
}

TEST(LayerTops, AreNotMovedByAFewGrainsThatClimbedThePile) {
  Bed bed = lattice();
  for (int i = 0; i < 20; ++i) bed.add(-0.019 + 0.0019 * i, 0.003, 0.04, 0.001, i % 2);
  const std::vector<double> tops = layer_tops(bed.view(), {0.04, 0.04}, 0.002, 2);
  EXPECT_NEAR(tops[0], 0.006, 1e-15);
  EXPECT_NEAR(tops[1], 0.014, 1e-15);
}

TEST(LayerTops, OfAnEmptyLayerAreThoseOfWhatLiesBelow) {
  const Bed bed = lattice();
  const std::vector<double> tops = layer_tops(bed.view(), {0.04, 0.04}, 0.002, 3);
  EXPECT_NEAR(tops[2], tops[1], 1e-15);
  EXPECT_EQ(layer_tops(ParticleView{}, {0.04, 0.04}, 0.002, 1)[0], 0);
}

}  // namespace
}  // namespace tuft::coupler

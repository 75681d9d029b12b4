/// Clumps as whole grains: their spheres' contacts are theirs, and move them.
#include <gtest/gtest.h>

#include <numeric>

#include "coupler/whole_grains.h"
#include "tests/verification/dem_bridge/clump_scene.h"

namespace tuft::coupler {
namespace {

using namespace dem;
using namespace dem::test;

class WholeGrainsOfClumps : public ::testing::TestWithParam<bool> {
 protected:
  WholeGrainsOfClumps() {
    block_.shake(infill_, 1);
    for (int k = 0; k < 200; ++k) infill_.advance(window_, 1, block_.confine(infill_, window_));
  }
  static DemSettings settings() {
    DemSettings settings = settings_in_box(0.05, Vec3(0, 0, -9.81));
    settings.rolling_resistance = true;
    return settings;
  }

  ClumpBlock block_{{ClumpShape::tetrahedron, 0.5}, 3, GetParam()};
  DemInfill infill_{block_.grains, block_.materials, settings()};
  double window_ = 0.8 * infill_.stable_step();
};
INSTANTIATE_TEST_SUITE_P(WithoutAndWithSpheres, WholeGrainsOfClumps, ::testing::Bool());

/// m (v(t + dt/2) - v(t - dt/2)) / dt = contacts + walls + weight, of each clump.
TEST_P(WholeGrainsOfClumps, AreMovedByTheirContactsAndWeight) {
  double largest = 0, worst = 0;
  std::size_t contacts = 0;
  for (int k = 0; k < 60; ++k) {
    const WholeGrains grains(infill_);
    const ContactNetwork network = grains.network_of(infill_.contacts());
    contacts = std::max(contacts, network.size());
    ASSERT_EQ(grains.view().size(), 27u);
    std::vector<Vec3> force(27, Vec3(0, 0, 0)), before;
    for (std::size_t c = 0; c < network.size(); ++c) {
      ASSERT_LT(network.particle[c], network.other[c]) << "no clump touches itself";
      force[static_cast<std::size_t>(network.particle[c])] += network.force(c);
      force[static_cast<std::size_t>(network.other[c])] -= network.force(c);
      largest = std::max(largest, network.force(c).norm());
    }
    const ContactImpulses walls = block_.confine(infill_, window_);
    for (std::size_t i = 0; i < block_.grains.size(); ++i)
      force[static_cast<std::size_t>(grains.grain_of_sphere()[i])] += walls.linear[i] / window_;
    for (std::size_t g = 0; g < 27; ++g) before.push_back(grains.view().velocity(g));
    infill_.advance(window_, 1, walls);
    const WholeGrains after(infill_);
    for (std::size_t g = 0; g < 27; ++g) {
      const double mass = after.view().mass[g];
      const Vec3 gained = mass * (after.view().velocity(g) - before[g]) / window_;
      worst = std::max(worst, (gained - force[g] - mass * Vec3(0, 0, -9.81)).norm());
    }
  }
  ASSERT_GT(contacts, 8u);
  EXPECT_LT(worst, 1e-9 * largest) << "largest force " << largest << " N";
}

TEST_P(WholeGrainsOfClumps, StandWhereTheirMassIsAndBranchesGoFromThereToThere) {
  const WholeGrains grains(infill_);
  const GrainBodies bodies = bodies_now(infill_, block_.grains, block_.materials);
  for (const GrainBody& body : bodies.bodies) {
    const auto g = static_cast<std::size_t>(grains.grain_of_sphere()[body.first]);
    EXPECT_LT((grains.view().position(g) - body.centre).norm(), 1e-9);
    EXPECT_NEAR(grains.view().mass[g] / body.mass, 1, 1e-12);
  }
  ContactNetwork of_spheres = infill_.contacts();
  const auto last = static_cast<Index>(block_.grains.size() - 1);
  const Vec3 to_wall(0, 0, -0.001), on_it(0.1, 0.2, 0.3);
  of_spheres.add(ContactKind::body, last, 3, to_wall, Vec3(0, 0, 1), on_it, 1e-5);
  const ContactNetwork network = grains.network_of(of_spheres);
  ASSERT_EQ(network.size(), of_spheres.size());
  double between = 0;  // N m
  for (std::size_t c = 0; c + 1 < network.size(); ++c) {
    const Vec3 from = grains.view().position(static_cast<std::size_t>(network.particle[c])),
               to = grains.view().position(static_cast<std::size_t>(network.other[c]));
    EXPECT_EQ(network.branch[c], Vec3(to - from));
    if (c > 0) {
      EXPECT_LE(std::pair(network.particle[c - 1], network.other[c - 1]),
                std::pair(network.particle[c], network.other[c]));
    }
    between += network.force(c).squaredNorm();
  }
  double between_spheres = 0;
  for (std::size_t c = 0; c + 1 < of_spheres.size(); ++c)
    between_spheres += of_spheres.force(c).squaredNorm();
  EXPECT_NEAR(between / between_spheres, 1, 1e-12);
  const std::size_t wall = network.size() - 1;
  EXPECT_EQ(network.kind[wall], ContactKind::body);
  EXPECT_EQ(network.particle[wall], 26);
  EXPECT_EQ(network.other[wall], 3) << "a body's number stays";
  const Vec3 touched = infill_.particles().position(static_cast<std::size_t>(last)) + to_wall;
  EXPECT_LT((grains.view().position(26) + network.branch[wall] - touched).norm(), 1e-15);
  EXPECT_LT((network.force(wall) - on_it).norm(), 1e-15);
}

TEST(WholeGrainsOfSpheres, AreTheSpheres) {
  const ShakenBlock block(2);
  const DemInfill infill(block.grains, block.materials, settings_in_box(0.05));
  const WholeGrains grains(infill);
  EXPECT_TRUE(grains.grain_of_sphere().empty());
  EXPECT_EQ(grains.view().x.data(), infill.particles().x.data());
}

}  // namespace
}  // namespace tuft::coupler

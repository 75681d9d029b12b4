/// How many processes bring grains to rest.
#include <gtest/gtest.h>

#include "coupler/settled_packing.h"

namespace tuft::coupler {
namespace {

dem::Grains spheres(std::size_t count) {
  dem::Grains grains;
  grains.radius.assign(count, 1e-3);
  grains.position.assign(count, 0);
  return grains;
}

TEST(PackingRanks, AreTwoForManyGrainsAndElseWhatTheSceneAsksFor) {
  Scene scene;
  EXPECT_EQ(packing_ranks(scene, spheres(19'999)), 1);
  EXPECT_EQ(packing_ranks(scene, spheres(20'000)), 2);
  scene.infill.dem.ranks = 3;
  EXPECT_EQ(packing_ranks(scene, spheres(20'000)), 3);
}

TEST(PackingRanks, AreOneOnAnotherMachineAndForClumps) {
  Scene scene;
  dem::Grains clumps = spheres(20'000);
  clumps.body.assign(20'000, 0);
  EXPECT_EQ(packing_ranks(scene, clumps), 1);
  scene.infill.dem.host = "tcp://machine:5555";
  EXPECT_EQ(packing_ranks(scene, spheres(20'000)), 1);
}

}  // namespace
}  // namespace tuft::coupler

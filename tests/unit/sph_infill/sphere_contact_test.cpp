// The force between two spheres, at single moments and along paths.
#include <gtest/gtest.h>

#include "sph_infill/sphere_contact.h"

namespace tuft::sph {
namespace {

constexpr SphereBond bond{2e5, 3.0, 0.5};
const Vec3 along_z(0, 0, 1);

TEST(SphereContact, PushesApartByStiffnessTimesOverlap) {
  Vec3 slip(0, 0, 0);
  const SphereForce f = sphere_force(bond, {1e-5, along_z, Vec3::Zero(), 0}, slip);
  EXPECT_EQ(f.spring, Vec3(0, 0, 2));
  EXPECT_EQ(f.other, Vec3::Zero());
  EXPECT_DOUBLE_EQ(f.normal_energy, 0.5 * 2e5 * 1e-10);
}

TEST(SphereContact, DashpotTakesTheSpringsForceAwayButNeverPulls) {
  Vec3 slip(0, 0, 0);
  const SphereForce parting = sphere_force(bond, {1e-5, along_z, Vec3(0, 0, 10), 0}, slip);
  EXPECT_EQ((parting.spring + parting.other).norm(), 0);
  const SphereForce nearing = sphere_force(bond, {1e-5, along_z, Vec3(0, 0, -1), 0}, slip);
  EXPECT_DOUBLE_EQ((nearing.spring + nearing.other).z(), 2 + 3.0);
}

TEST(SphereContact, SlipIsCutAtCoulombsLimitAndReversalStartsFromALoadedSpring) {
  Vec3 slip(0, 0, 0);
  const SphereMotion sliding{1e-5, along_z, Vec3(1e-4, 0, 0), 1};
  const SphereForce f = sphere_force({bond.stiffness, 0, bond.friction}, sliding, slip);
  EXPECT_NEAR(f.other.x(), -0.5 * 2, 1e-15);
  EXPECT_NEAR(slip.x(), 1 / (tangential_ratio * bond.stiffness), 1e-15);  // mu N / k_t
  const SphereForce back =
      sphere_force({bond.stiffness, 0, bond.friction}, {1e-5, along_z, Vec3(-1e-6, 0, 0), 1}, slip);
  EXPECT_NEAR(back.other.x(), -1 + tangential_ratio * bond.stiffness * 1e-6, 1e-12);
}

TEST(SphereContact, ExchangeOfTheSpheresTurnsEverySign) {
  const Vec3 normal = Vec3(0.3, -0.5, 0.8).normalized(), velocity(0.2, 0.1, -0.4);
  Vec3 slip(1e-7, 2e-7, 0), mirrored = -slip;
  const SphereForce a = sphere_force(bond, {1e-5, normal, velocity, 1e-6}, slip);
  const SphereForce b = sphere_force(bond, {1e-5, -normal, -velocity, 1e-6}, mirrored);
  EXPECT_EQ(a.spring, Vec3(-b.spring));
  EXPECT_EQ(a.other, Vec3(-b.other));
  EXPECT_EQ(slip, Vec3(-mirrored));
}

TEST(SphereContact, TurningOfThePairKeepsTheTangentialSpringsLengthAndItsPlace) {
  Vec3 slip(1e-7, 0, 0);
  const Vec3 normal = Vec3(0.1, 0, 1).normalized();
  const SphereForce f = sphere_force({bond.stiffness, 0, 10}, {1e-5, normal, Vec3::Zero(), 1}, slip);
  EXPECT_NEAR(slip.norm(), 1e-7, 1e-20);
  EXPECT_NEAR(slip.dot(normal), 0, 1e-20);
  EXPECT_NEAR(f.tangential_energy, 0.5 * tangential_ratio * bond.stiffness * 1e-14, 1e-20);
}

}  // namespace
}  // namespace tuft::sph

/// The forces of contacts as the host lists them are those that move the grains, and listing them changes
/// nothing.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;

std::vector<Vec3> sums_by_grain(const ContactNetwork& network, std::size_t grains) {
  std::vector<Vec3> sums(grains, Vec3::Zero());
  for (std::size_t c = 0; c < network.size(); ++c) {
    sums[static_cast<std::size_t>(network.particle[c])] += network.force(c);
    sums[static_cast<std::size_t>(network.other[c])] -= network.force(c);
  }
  return sums;
}

void expect_same_bits(const ContactNetwork& a, const ContactNetwork& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.particle, b.particle);
  EXPECT_EQ(a.other, b.other);
  EXPECT_EQ(a.overlap, b.overlap);
  const auto same = [](const Vec3Array& one, const Vec3Array& two) {
    EXPECT_EQ(one.x, two.x);
    EXPECT_EQ(one.y, two.y);
    EXPECT_EQ(one.z, two.z);
  };
  same(a.branch, b.branch);
  same(a.normal_force, b.normal_force);
  same(a.tangential_force, b.tangential_force);
}

class ContactNetworkOfGrains : public ::testing::Test {
 protected:
  ContactNetworkOfGrains() { settings_.rolling_resistance = true; }
  ~ContactNetworkOfGrains() override { fs::remove(file_); }

  [[nodiscard]] double window_of(const DemInfill& infill) const { return 0.5 * infill.stable_step(); }
  void advance(DemInfill& infill, int windows, bool listing = false) const {
    for (int k = 0; k < windows; ++k) {
      if (listing) (void)infill.contacts();
      infill.advance(2 * window_of(infill), 2, block_.confine(infill, 2 * window_of(infill)));
    }
  }
  void save(DemInfill& infill) const {
    auto file = h5::File::create_atomically(file_);
    h5::Group group = file.root();
    infill.save(group);
    file.commit();
  }

  ShakenBlock block_{6};
  DemSettings settings_ = settings_in_box(0.05, Vec3(0, 0, -9.81));
  fs::path file_ = fs::temp_directory_path() / ("tuft-network-" + std::to_string(::getpid()) + ".h5");
};

/// m (v(t + dt/2) - v(t - dt/2)) / dt = contacts + what the driver gives + weight, at the same t.
TEST_F(ContactNetworkOfGrains, WithWeightAndWallsMovesEachGrain) {
  DemInfill infill(block_.grains, block_.materials, settings_);
  block_.shake(infill, 0.5);
  advance(infill, 150);
  const double window = window_of(infill);
  double largest = 0, worst = 0;
  for (int k = 0; k < 60; ++k) {
    const ContactNetwork network = infill.contacts();
    const std::vector<Vec3> sums = sums_by_grain(network, block_.grains.size());
    const ContactImpulses walls = block_.confine(infill, window);
    std::vector<Vec3> before;
    for (std::size_t i = 0; i < sums.size(); ++i) before.push_back(infill.particles().velocity(i));
    infill.advance(window, 1, walls);
    const ParticleView view = infill.particles();
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const Vec3 gained = view.mass[i] * (view.velocity(i) - before[i]) / window;
      const Vec3 force = sums[i] + walls.linear[i] / window + view.mass[i] * settings_.gravity;
      worst = std::max(worst, (gained - force).norm());
      largest = std::max(largest, sums[i].norm());
    }
    ASSERT_GT(network.size(), 40u);
  }
  EXPECT_LT(worst, 1e-9 * largest) << "largest force " << largest << " N";
}

TEST_F(ContactNetworkOfGrains, ChangesNoBitOfTheRun) {
  DemInfill listed(block_.grains, block_.materials, settings_),
      plain(block_.grains, block_.materials, settings_);
  for (DemInfill* infill : {&listed, &plain}) {
    block_.shake(*infill, 0.5);
    advance(*infill, 300, infill == &listed);
  }
  const ParticleView a = listed.particles(), b = plain.particles();
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a.position(i), b.position(i)) << i;
    ASSERT_EQ(a.velocity(i), b.velocity(i)) << i;
    ASSERT_EQ(a.spin(i), b.spin(i)) << i;
  }
}

TEST_F(ContactNetworkOfGrains, OfAResumedRunIsThatOfTheRunThatWentOn) {
  DemInfill whole(block_.grains, block_.materials, settings_);
  block_.shake(whole, 0.5);
  advance(whole, 150);
  const ContactNetwork before = whole.contacts();
  save(whole);
  expect_same_bits(before, whole.contacts());
  DemInfill resumed(block_.grains, block_.materials, settings_);
  resumed.load(h5::File::open(file_).root());
  expect_same_bits(before, resumed.contacts());
  advance(whole, 150);
  advance(resumed, 150);
  ASSERT_GT(whole.contacts().size(), 40u);
  expect_same_bits(whole.contacts(), resumed.contacts());
}

TEST_F(ContactNetworkOfGrains, HoldsNormalForcesAlongTheBranchAndTangentialOnesAcross) {
  DemInfill infill(block_.grains, block_.materials, settings_);
  block_.shake(infill, 0.5);
  advance(infill, 150);
  const ContactNetwork network = infill.contacts();
  double tangential = 0;
  for (std::size_t c = 0; c < network.size(); ++c) {
    const Vec3 n = network.branch[c].normalized();
    const double normal = network.normal_force[c].norm(), slip = network.tangential_force[c].norm();
    EXPECT_LT(network.normal_force[c].cross(n).norm(), 1e-12 * normal);
    EXPECT_LT(std::abs(network.tangential_force[c].dot(n)), 1e-9 * (normal + slip));
    EXPECT_GT(network.overlap[c], 0);
    EXPECT_LT(network.particle[c], network.other[c]);
    tangential = std::max(tangential, slip / normal);
  }
  EXPECT_GT(tangential, 0.1);
}

TEST(ContactNetworkOfAChain, CarriesTheForceFromEndToEnd) {
  Grains grains;
  for (int i = 0; i < 3; ++i) add_grain(grains, Vec3(0.00195 * (i - 1), 0, 0), 0.001, 1150);
  const std::vector<Material> materials{rubber()};
  DemInfill infill(grains, materials, settings_in_box(0.05));
  infill.set_damping(2000);
  const double window = 0.5 * infill.stable_step(), pressed = 0.02;
  for (int k = 0; k < 4000; ++k) {
    ContactImpulses ends = no_impulses(3);
    ends.linear.set(0, window * Vec3(pressed, 0, 0));
    ends.linear.set(2, window * Vec3(-pressed, 0, 0));
    infill.advance(window, 1, ends);
  }
  const ContactNetwork network = infill.contacts();
  ASSERT_EQ(network.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(network.particle[c], static_cast<Index>(c));
    EXPECT_EQ(network.other[c], static_cast<Index>(c + 1));
    EXPECT_NEAR(network.normal_force[c].x(), -pressed, 1e-6 * pressed);
    EXPECT_LT(network.tangential_force[c].norm(), 1e-9 * pressed);
  }
}

}  // namespace
}  // namespace tuft::dem::test

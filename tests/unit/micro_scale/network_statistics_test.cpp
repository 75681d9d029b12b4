/// Statistics of contact networks whose answers are known.
#include "micro_scale/network_statistics.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/unit/micro_scale/particle_sample.h"

namespace tuft::micro {
namespace {

using test::Sample;

TEST(NetworkStatistics, OfASimpleCubicLatticeHaveSixContactsInsideAndAnEvenFabric) {
  constexpr int side = 6;
  const Sample sample = test::cubic_lattice(side, 0.002, Vec3(0.1, 0.1, 0.1));
  const std::vector<double> contacts = count_coordination(sample.network, sample.mass.size());
  for (int k = 1; k + 1 < side; ++k)
    for (int j = 1; j + 1 < side; ++j)
      for (int i = 1; i + 1 < side; ++i)
        EXPECT_EQ(contacts[static_cast<std::size_t>(i + side * (j + side * k))], 6);
  const NetworkStatistics s = describe_network(sample.network, sample.mass.size());
  EXPECT_NEAR(s.coordination, 6.0 * (side - 1) / side, 1e-12);  // three of six at corners, and so on
  EXPECT_LT((s.fabric - Mat3::Identity() / 3).norm(), 1e-12);
  EXPECT_LT((s.force_fabric - Mat3::Identity() / 3).norm(), 1e-12);
  EXPECT_LT(s.anisotropy, 1e-12);
  EXPECT_EQ(s.rattlers, 0);
  EXPECT_EQ(s.tangential_ratio, 0);
}

TEST(NetworkStatistics, TellTheDirectionInWhichForceIsCarried) {
  const Sample sample = test::cubic_lattice(5, 0.002, Vec3(0.1, 0.1, 0.4));
  const NetworkStatistics s = describe_network(sample.network, sample.mass.size());
  EXPECT_LT(s.anisotropy, 1e-12) << "contacts are as even as before";
  EXPECT_NEAR(s.force_fabric(2, 2), 4.0 / 6, 1e-12);
  EXPECT_NEAR(s.force_anisotropy, 3.0 / 6, 1e-12);
  EXPECT_NEAR(s.mean_normal, 0.2, 1e-12);
  EXPECT_NEAR(s.strong_contacts, 1.0 / 3, 1e-12);
  EXPECT_NEAR(s.strong_share, 2.0 / 3, 1e-12);
  EXPECT_NEAR(s.largest_normal, 0.4, 1e-12);
}

TEST(NetworkStatistics, CountContactsByKindAndTakeForcesOfGrainsAlone) {
  Sample sample = test::cubic_lattice(2, 0.002, Vec3(0.1, 0.1, 0.1));
  sample.lean(0, Vec3(0, 0, -0.001), Vec3(0, 0, 50));
  sample.network.add(ContactKind::fibre, 1, 3, Vec3(0.001, 0, 0), Vec3(-1, 0, 0), Vec3(-70, 0, 0), 1e-5);
  const NetworkStatistics s = describe_network(sample.network, sample.mass.size());
  EXPECT_EQ(s.contacts, (std::array<std::size_t, contact_kinds>{12, 0, 1, 1}));
  EXPECT_NEAR(s.mean_normal, 0.1, 1e-12);
  EXPECT_NEAR(s.coordination, 3, 1e-12);
}

TEST(NetworkStatistics, SplitForcesIntoNormalAndTangentialParts) {
  Sample sample;
  sample.add(Vec3(0, 0, 0), Vec3::Zero(), 1e-6);
  sample.add(Vec3(0, 0, 0.002), Vec3::Zero(), 1e-6);
  sample.touch(0, 1, Vec3(0.3, 0, -1));
  EXPECT_LT((sample.network.normal_force[0] - Vec3(0, 0, -1)).norm(), 1e-15);
  EXPECT_LT((sample.network.tangential_force[0] - Vec3(0.3, 0, 0)).norm(), 1e-15);
  EXPECT_NEAR(describe_network(sample.network, 2).tangential_ratio, 0.3, 1e-12);
  EXPECT_EQ(describe_network(sample.network, 2).rattlers, 1) << "one contact holds no grain";
}

TEST(NetworkStatistics, OfNoContactsAreZeroAndFinite) {
  const NetworkStatistics s = describe_network({}, 10);
  for (const NamedValue& value : named_values(s)) EXPECT_EQ(value.value, 0) << value.name;
}

TEST(ForceDistribution, HasTheAreaOneAndTheMeanOne) {
  const Sample sample = test::cloud(400, 0.01);
  const std::vector<double> density = force_distribution(sample.network, {80, 0.1});
  const double area = 0.1 * std::accumulate(density.begin(), density.end(), 0.0);
  EXPECT_NEAR(area, 1, 1e-12);
  double mean = 0;
  for (std::size_t b = 0; b < density.size(); ++b)
    mean += density[b] * 0.1 * 0.1 * (static_cast<double>(b) + 0.5);
  EXPECT_NEAR(mean, 1, 0.05) << "up to the width of a bin";
}

}  // namespace
}  // namespace tuft::micro

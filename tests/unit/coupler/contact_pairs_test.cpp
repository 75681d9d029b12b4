#include "coupler/contact_pairs.h"

#include <gtest/gtest.h>

#include <set>

#include "coupler/particle_grid.h"

namespace tuft::coupler {
namespace {

TEST(CarryOver, KeepsTheMemoryOfPairsThatStayAndStartsOthersFresh) {
  std::vector<PairKey> before{make_key(1, 2), make_key(1, 5), make_key(7, 0)};
  std::vector<ContactHistory> memory(3);
  for (int i = 0; i < 3; ++i) memory[i].offset = 10.0 + i;
  const std::vector<PairKey> after{make_key(0, 9), make_key(1, 5), make_key(3, 3), make_key(7, 0)};
  const auto kept = carry_over(before, memory, after);
  EXPECT_EQ(kept[0].offset, 0);
  EXPECT_EQ(kept[1].offset, 11);
  EXPECT_EQ(kept[2].offset, 0);
  EXPECT_EQ(kept[3].offset, 12);
}

TEST(PairKey, OrdersByPointThenByOther) {
  EXPECT_LT(make_key(1, 5), make_key(2, 0));
  EXPECT_LT(make_key(1, 4), make_key(1, 5));
  EXPECT_EQ(key_point(make_key(123456, 789)), 123456);
  EXPECT_EQ(key_other(make_key(123456, 789)), 789);
}

TEST(ParticleGrid, FindsEveryParticleOfABox) {
  std::vector<double> x, y, z, r;
  std::uint64_t state = 12345;
  const auto uniform = [&] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) / 9007199254740992.0;
  };
  for (int i = 0; i < 500; ++i) {
    x.push_back(uniform());
    y.push_back(2 * uniform() - 5);
    z.push_back(0.1 * uniform());
    r.push_back(0.01);
  }
  ParticleView view;
  view.x = x;
  view.y = y;
  view.z = z;
  view.radius = r;
  const ParticleGrid grid(view, 0.07);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 low(uniform() - 0.1, 2 * uniform() - 5, 0.1 * uniform() - 0.01),
        high = low + Vec3(0.2, 0.3, 0.02);
    std::set<Index> found;
    grid.for_each_in_box(low, high, [&](Index i) { found.insert(i); });
    for (Index i = 0; i < 500; ++i) {
      const Vec3 p = view.position(static_cast<std::size_t>(i));
      if ((p.array() >= low.array()).all() && (p.array() <= high.array()).all()) {
        EXPECT_TRUE(found.contains(i));
      }
    }
  }
}

}  // namespace
}  // namespace tuft::coupler

#pragma once
/// Two runs that must not differ by a bit.
#include <gtest/gtest.h>

#include <algorithm>

#include "sph_infill/sph_infill.h"
#include "tests/verification/same_energy.h"

namespace tuft::sph::test {

inline void expect_same(const SphInfill& a, const SphInfill& b) {
  const ParticleView p = a.particles(), q = b.particles();
  EXPECT_TRUE(std::ranges::equal(p.x, q.x) && std::ranges::equal(p.y, q.y) && std::ranges::equal(p.z, q.z));
  EXPECT_TRUE(std::ranges::equal(p.vx, q.vx) && std::ranges::equal(p.vy, q.vy) &&
              std::ranges::equal(p.vz, q.vz));
  const auto fields_a = a.fields(), fields_b = b.fields();
  for (std::size_t k = 0; k < fields_a.size(); ++k)
    EXPECT_EQ(fields_a[k].values, fields_b[k].values) << fields_a[k].name;
  tuft::test::expect_same_energy(a.energy(), b.energy());
  EXPECT_EQ(a.stable_step(), b.stable_step());
  EXPECT_EQ(a.particle_steps(), b.particle_steps());
}

}  // namespace tuft::sph::test

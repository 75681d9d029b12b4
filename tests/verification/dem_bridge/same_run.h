#pragma once
/// Runs of grains that are saved, and that must not differ by a bit.
#include <gtest/gtest.h>

#include <filesystem>

#include "bridge_scene.h"
#include "tests/verification/same_energy.h"

namespace tuft::dem::test {

inline void save_run(DemInfill& infill, const std::filesystem::path& path) {
  auto file = h5::File::create_atomically(path);
  h5::Group group = file.root();
  infill.save(group);
  file.commit();
}

inline void expect_same_bits(const DemInfill& a, const DemInfill& b) {
  const ParticleView one = a.particles(), two = b.particles();
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one.position(i), two.position(i)) << "position of grain " << i;
    ASSERT_EQ(one.velocity(i), two.velocity(i)) << "velocity of grain " << i;
    ASSERT_EQ(one.spin(i), two.spin(i)) << "spin of grain " << i;
    ASSERT_EQ(one.mass[i], two.mass[i]) << "mass of grain " << i;
  }
  tuft::test::expect_same_energy(a.energy(), b.energy());
  EXPECT_EQ(a.particle_steps(), b.particle_steps());
}

}  // namespace tuft::dem::test

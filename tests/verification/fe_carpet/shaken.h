#pragma once
/// Carpets with every mode excited, and their states compared to the bit.
#include <gtest/gtest.h>

#include <cstring>
#include <span>
#include <vector>

#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {

/// Velocities without any pattern, so that every mode is excited: up to 1 m/s and 100 rad/s.
inline void shake(Carpet& carpet) {
  const NodeView nodes = carpet.nodes();
  for (std::size_t n = 0; n < nodes.x.size(); ++n) {
    if (nodes.clamped[n]) continue;
    const auto wave = [n](double k) { return std::sin(k * static_cast<double>(n) + k); };
    carpet.set_velocity(n, Vec3(wave(1.1), wave(2.3), wave(3.7)),
                        100 * Vec3(wave(0.7), wave(1.9), wave(2.9)));
  }
}

inline double momentum_scale(const Carpet& carpet) {
  const NodeView v = carpet.nodes();
  double sum = 0;
  for (std::size_t n = 0; n < v.x.size(); ++n) sum += v.mass[n] * Vec3(v.vx[n], v.vy[n], v.vz[n]).norm();
  return sum;
}

inline std::vector<ShellMaterial> turf_materials() {
  return {{0.2e9, 0.3, 900}, polyethylene()};
}

/// Fibres struck sideways, at nine tenths of the stable step; hourglassing takes little.
inline void expect_struck_turf_keeps_its_energy(const CarpetOptions& options) {
  Carpet carpet(small_turf(0.04), turf_materials(), options);
  const NodeView nodes = carpet.nodes();
  for (std::size_t n = 0; n < nodes.x.size(); ++n)
    if (!nodes.clamped[n])
      carpet.set_velocity(n, std::pow(nodes.z[n] / 0.03, 2) * Vec3(0, 1, 0), Vec3(0, 0, 0));
  const double start = total(carpet.energy()), dt = 0.9 * carpet.stable_step();
  const Vec3Array load = no_load(nodes.x.size());
  double largest_error = 0, largest_hourglass = 0;
  for (int i = 0; i < 4000; ++i) {
    carpet.step(dt, load);
    if (i % 10 != 0) continue;
    const CarpetEnergy e = carpet.energy();
    largest_error = std::max(largest_error, std::abs(total(e) / start - 1));
    largest_hourglass = std::max(largest_hourglass, e.hourglass / start);
  }
  EXPECT_LT(largest_error, 2e-3);
  EXPECT_LT(largest_hourglass, 0.05);
}

inline bool same_bits(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

inline void expect_same_state(const Carpet& a, const Carpet& b) {
  const NodeView u = a.nodes(), v = b.nodes();
  EXPECT_TRUE(same_bits(u.x, v.x) && same_bits(u.y, v.y) && same_bits(u.z, v.z));
  EXPECT_TRUE(same_bits(u.vx, v.vx) && same_bits(u.vy, v.vy) && same_bits(u.vz, v.vz));
  EXPECT_TRUE(a.energy() == b.energy());
  EXPECT_EQ(a.impulse_received(), b.impulse_received());
  EXPECT_EQ(a.element_steps(), b.element_steps());
}

inline void run_turf(Carpet& carpet, int first, int last) {
  Vec3Array load = no_load(carpet.nodes().x.size());
  for (int i = first; i < last; ++i) {
    for (std::size_t n = 0; n < load.size(); ++n)
      load.z[n] = 1e-5 * std::sin(0.01 * i + static_cast<double>(n));
    carpet.step(8e-7, load);
  }
}

}  // namespace tuft::fe::test

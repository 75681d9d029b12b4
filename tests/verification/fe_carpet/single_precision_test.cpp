/// What single precision would do to the shells: why none of their state is in it (docs/performance.md).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "fe_carpet/shell_strain.h"

namespace tuft::fe::test {
namespace {

/// Largest strain, summed up as stresses are, that a square of 3 mm shows, 0.1 m from the origin, after a
/// full turn in `steps`.
template <class Real>
double strain_of_a_full_turn(int steps) {
  std::array<Real, 3> sum{};
  const double angle = 2 * std::numbers::pi / steps, side = 0.003, away = 0.1;
  const auto corner = [&](int c, double turned) {
    const double x = away + (c == 1 || c == 2 ? side : 0), z = c >= 2 ? side : 0;
    return std::array<double, 3>{x * std::cos(turned) - z * std::sin(turned), 0.0,
                                 x * std::sin(turned) + z * std::cos(turned)};
  };
  double largest = 0;
  for (int s = 0; s < steps; ++s) {
    std::array<Triple<Real>, 4> middle, moved, turn;
    for (int c = 0; c < 4; ++c) {
      const auto a = corner(c, s * angle), b = corner(c, (s + 1) * angle);
      const auto at = [&](int k) { return std::pair{Real(a[k]), Real(b[k])}; };
      const auto [ax, bx] = at(0);
      const auto [ay, by] = at(1);
      const auto [az, bz] = at(2);
      middle[c] = {Real(0.5) * (ax + bx), Real(0.5) * (ay + by), Real(0.5) * (az + bz)};
      moved[c] = {bx - ax, by - ay, bz - az};
      turn[c] = {Real(0), Real(-2 * std::tan(0.5 * angle)), Real(0)};
    }
    const auto modes = [](const std::array<Triple<Real>, 4>& f) {
      return corner_modes(f[0], f[1], f[2], f[3]);
    };
    const ShellModes<Real> de = strain_increments(shell_frame(modes(middle)), modes(moved), modes(turn),
                                                  corner_mean(turn[0], turn[1], turn[2], turn[3]));
    sum = {sum[0] + de.exx, sum[1] + de.eyy, sum[2] + de.gxy};
    for (const Real strain : sum) largest = std::max(largest, std::abs(static_cast<double>(strain)));
  }
  return largest;
}

TEST(SinglePrecision, OfGeometryStrainsARigidTurnADoubleDoesNot) {
  const double in_double = strain_of_a_full_turn<double>(10000),
               in_single = strain_of_a_full_turn<float>(10000);
  RecordProperty("strain_double", std::to_string(in_double));
  EXPECT_LT(in_double, 1e-10);
  EXPECT_GT(in_single, 1e-7) << "three orders more than a turn may cost: single precision would do after all";
  std::printf("strain after a full turn in 10 000 steps: double %.2g, single %.2g\n", in_double, in_single);
}

/// Sum over its exact value of equal increments of strain, as a stress in rate form adds them up.
template <class Real>
double ramp(double rate, double dt, double strain) {
  Real sum(0);
  const long steps = std::lround(strain / (rate * dt));
  for (long s = 0; s < steps; ++s) sum += static_cast<Real>(rate * dt);
  return static_cast<double>(sum) / (rate * dt * static_cast<double>(steps));
}

TEST(SinglePrecision, OfStressDriftsInASlowPull) {
  constexpr double rate = 0.1, dt = 1.7e-6, strain = 0.2;  // strand_tension at its slowest
  const double in_double = ramp<double>(rate, dt, strain), in_single = ramp<float>(rate, dt, strain);
  EXPECT_NEAR(in_double, 1, 1e-9);
  EXPECT_GT(std::abs(in_single - 1), 1e-3);
  std::printf("stress over exact at strain 0.2, 0.1 1/s: double 1 %+.1e, single 1 %+.1e\n", in_double - 1,
              in_single - 1);
}

}  // namespace
}  // namespace tuft::fe::test

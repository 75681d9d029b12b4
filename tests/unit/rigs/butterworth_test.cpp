#include "rigs/butterworth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace tuft::rigs {
namespace {

double amplitude_after_filter(double frequency, double cutoff) {
  const double dt = 2e-5;
  std::vector<double> values(10000);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = std::sin(2 * std::numbers::pi * frequency * static_cast<double>(i) * dt);
  const auto out = zero_phase_lowpass(values, dt, cutoff);
  double in_phase = 0, out_of_phase = 0;
  for (std::size_t i = 2000; i < 8000; ++i) {
    const double angle = 2 * std::numbers::pi * frequency * static_cast<double>(i) * dt;
    in_phase += out[i] * std::sin(angle) / 3000;
    out_of_phase += out[i] * std::cos(angle) / 3000;
  }
  EXPECT_NEAR(out_of_phase, 0, 2e-3) << "no phase shift at " << frequency << " Hz";
  return in_phase;
}

TEST(ZeroPhaseLowpass, IsThreeDecibelDownAtTheCutoff) {
  EXPECT_NEAR(amplitude_after_filter(1000, 1000), std::numbers::sqrt2 / 2, 3e-3);
}

TEST(ZeroPhaseLowpass, PassesSlowAndStopsFastSignals) {
  EXPECT_NEAR(amplitude_after_filter(50, 1000), 1, 1e-3);
  // Four poles: 24 dB an octave far above the cutoff, a little more by the bilinear transform.
  EXPECT_LT(amplitude_after_filter(4000, 1000), 1.0 / 90);
}

TEST(ZeroPhaseLowpass, LeavesAConstantAndARampUnchangedToTheEnds) {
  std::vector<double> ramp(500);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = 3 + 0.1 * static_cast<double>(i);
  const auto out = zero_phase_lowpass(ramp, 2e-5, 1000);
  for (std::size_t i = 0; i < ramp.size(); ++i) EXPECT_NEAR(out[i], ramp[i], 2e-2 * ramp[i]) << i;
  for (std::size_t i = 200; i < 300; ++i) EXPECT_NEAR(out[i], ramp[i], 1e-6);
}

TEST(ZeroPhaseLowpass, RefusesACutoffThatTheSamplingCannotShow) {
  EXPECT_THROW((void)zero_phase_lowpass({1, 2, 3}, 1e-3, 1000), InputError);
}

}  // namespace
}  // namespace tuft::rigs

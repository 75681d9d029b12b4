#pragma once
/// Seeded random numbers that are the same everywhere: the standard fixes the engine but not its
/// distributions.
#include <cmath>
#include <cstdint>
#include <random>

namespace tuft::fe {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [0, 1), from the upper 53 bits.
  [[nodiscard]] double uniform() { return static_cast<double>(engine_() >> 11U) * 0x1.0p-53; }
  /// Whole number in [0, count), count > 0; the bias of the remainder is under count / 2^64.
  [[nodiscard]] std::uint64_t below(std::uint64_t count) { return engine_() % count; }

 private:
  std::mt19937_64 engine_;
};

/// Inverse of the standard normal distribution, p in (0, 1): rational approximation 26.2.23 of Abramowitz &
/// Stegun, absolute error under 4.5e-4, ample for drawing angles.
[[nodiscard]] inline double normal_quantile(double p) {
  const double tail = p < 0.5 ? p : 1 - p;
  const double t = std::sqrt(-2 * std::log(tail));
  const double z =
      t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  return p < 0.5 ? -z : z;
}

}  // namespace tuft::fe

#include "rigs/butterworth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace tuft::rigs {
namespace {

/// Bilinear transform of 1 / (s^2 + sqrt(2) s + 1), prewarped.
struct Biquad {
  std::array<double, 3> b{};
  std::array<double, 2> a{};

  Biquad(double cutoff, double interval) {
    const double w = std::tan(std::numbers::pi * cutoff * interval);
    const double scale = 1 / (1 + std::numbers::sqrt2 * w + w * w);
    b = {w * w * scale, 2 * w * w * scale, w * w * scale};
    a = {2 * (w * w - 1) * scale, (1 - std::numbers::sqrt2 * w + w * w) * scale};
  }

  void run(std::vector<double>& values) const {
    // Started as if the first value had been there for ever.
    double x1 = values.front(), x2 = x1, y1 = x1, y2 = x1;
    for (double& value : values) {
      const double x = value;
      const double y = b[0] * x + b[1] * x1 + b[2] * x2 - a[0] * y1 - a[1] * y2;
      x2 = x1;
      x1 = x;
      y2 = y1;
      y1 = y;
      value = y;
    }
  }
};

}  // namespace

std::vector<double> zero_phase_lowpass(const std::vector<double>& values, double interval, double cutoff) {
  if (!(cutoff > 0) || !(cutoff * interval < 0.4))
    throw_input_error(
        "rig.filter_cutoff = {:.4g} Hz cannot be applied to samples every {:.3g} s (output.histories): "
        "choose "
        "a cutoff under {:.4g} Hz or a smaller interval",
        cutoff, interval, 0.4 / interval);
  if (values.size() < 2) return values;
  const double pass_cutoff = cutoff / std::pow(std::numbers::sqrt2 - 1, 0.25);
  const Biquad pass(std::min(pass_cutoff, 0.499 / interval), interval);
  const std::size_t pad =
      std::min(values.size() - 1, static_cast<std::size_t>(std::ceil(3 / (cutoff * interval))));
  std::vector<double> work;
  work.reserve(values.size() + 2 * pad);
  for (std::size_t i = pad; i > 0; --i) work.push_back(2 * values.front() - values[i]);
  work.insert(work.end(), values.begin(), values.end());
  for (std::size_t i = 1; i <= pad; ++i) work.push_back(2 * values.back() - values[values.size() - 1 - i]);
  pass.run(work);
  std::reverse(work.begin(), work.end());
  pass.run(work);
  std::reverse(work.begin(), work.end());
  return {work.begin() + static_cast<std::ptrdiff_t>(pad),
          work.begin() + static_cast<std::ptrdiff_t>(pad + values.size())};
}

}  // namespace tuft::rigs

#include "rigs/window_remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tuft::rigs {
namespace {

constexpr double us = 1e6;

/// As if rows were no bound, nearly.
double longest_window(const coupler::StableSteps& stable, const Numerics& numerics, double interval) {
  const double apart = 1000 * std::max(interval, numerics.coupling_window);
  return coupler::plan_steps(stable, numerics.step_safety, numerics.coupling_window, apart).window;
}

std::string remark_on_asked(const coupler::StableSteps& stable, const Numerics& numerics, double interval,
                            const std::string& rows, double window) {
  const double asked = numerics.coupling_window, longest = longest_window(stable, numerics, interval);
  constexpr double rounding = 1e-6, of_rows_apart = 2e-3;
  if (window > (1 - rounding) * asked) return "";
  const bool by_stability = longest < (1 - of_rows_apart) * asked,
             by_rows = window < (1 - of_rows_apart) * std::min(asked, longest);
  std::string reasons;
  if (by_stability)
    reasons = fmt::format("no more than {:.3g} us are stable in contact with the infill", us * longest);
  if (by_rows)
    reasons += fmt::format("{}whole numbers of windows make up {} ({:.3g} us)", by_stability ? ", and " : "",
                           rows, us * interval);
  return fmt::format("windows of {:.3g} us, where numerics.coupling_window asks for {:.3g} us: {}",
                     us * window, us * asked, reasons);
}

/// What is proposed leaves room for infill that stiffens: beyond it there would be as many windows as before.
std::string remark_on_rows(const coupler::StableSteps& stable, const Numerics& numerics, double interval,
                           const std::string& rows, double window) {
  constexpr double room = 0.95, worth_saying = 1.25;
  const double longest = longest_window(stable, numerics, interval);
  const double windows = std::max(1.0, std::round(interval / window) - 1), digits = 2;
  const double most = room * windows * longest;
  const double unit = std::pow(10, std::floor(std::log10(most)) + 1 - digits);
  const double other = unit * std::floor(most / unit * (1 + 1e-9));  // an interval that fits
  const double gain = other / (windows * window);
  if (gain < worth_saying) return "";
  return fmt::format(
      "windows of {:.3g} us, where {:.3g} us would be stable: whole numbers of them make up {} ({:.3g} us); "
      "with {} "
      "= \"{:.3g} us\" the run begins with {:.2g} times fewer",
      us * window, us * longest, rows, us * interval, rows, us * other, gain);
}

}  // namespace

std::string remark_on_windows(const coupler::StableSteps& stable, const Numerics& numerics, double interval,
                              const std::string& rows) {
  const double window =
      coupler::plan_steps(stable, numerics.step_safety, numerics.coupling_window, interval).window;
  return numerics.coupling_window > 0 ? remark_on_asked(stable, numerics, interval, rows, window)
                                      : remark_on_rows(stable, numerics, interval, rows, window);
}

}  // namespace tuft::rigs

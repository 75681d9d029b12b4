#include "dem_bridge/grain_sizes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/error.h"

namespace tuft::dem {
namespace {

double power(double x, int n) {
  double result = 1;
  for (int i = 0; i < std::abs(n); ++i) result *= x;
  return n < 0 ? 1 / result : result;
}

/// Integral of x^p from a to b.
double power_integral(double a, double b, int p) {
  if (p == -1) return std::log(b / a);
  return (power(b, p + 1) - power(a, p + 1)) / (p + 1);
}

/// x in [a, b] up to which a share of the integral of x^p lies.
double power_quantile(double a, double b, int p, double share) {
  if (p == -1) return a * std::pow(b / a, share);
  const double from = power(a, p + 1), to = power(b, p + 1);
  return std::clamp(std::pow(from + share * (to - from), 1.0 / (p + 1)), a, b);
}

double normal_below(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// Share of a normal distribution between a and b. Far above the middle the two ends are equal to rounding:
/// there it is taken from the other side, where they are small.
double normal_between(double a, double b) {
  return a > 0 ? normal_below(-a) - normal_below(-b) : normal_below(b) - normal_below(a);
}

/// z below which a share p in (0, 0.5] of a normal distribution lies: Abramowitz & Stegun 26.2.23 (error
/// under 4.5e-4), then two of Halley's steps, each of which cubes the error.
double lower_normal_quantile(double p) {
  const double t = std::sqrt(-2 * std::log(p));
  double z =
      (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308))) - t;
  for (int i = 0; i < 2; ++i) {
    const double slope = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    const double newton = (normal_below(z) - p) / slope;
    z -= newton / (1 + 0.5 * z * newton);
  }
  return z;
}

/// z in [a, b] up to which a share of what lies between a and b does.
double normal_quantile_between(double a, double b, double share) {
  if (share <= 0) return a;
  if (share >= 1) return b;
  if (a > 0) return -normal_quantile_between(-b, -a, 1 - share);
  const double below = normal_below(a) + share * (normal_below(b) - normal_below(a));
  const double z = below <= 0.5 ? lower_normal_quantile(below) : -lower_normal_quantile(1 - below);
  return std::clamp(z, a, b);
}

double sphere_mass(double diameter, double density) {
  return std::numbers::pi / 6 * diameter * diameter * diameter * density;
}

/// Where in [0, 1] a function that rises from below 0 to above it is nearest to 0 (regula falsi, Illinois
/// rule, every third time the middle). Where it jumps over 0, on the nearer side.
double root_of_rising(const std::function<double(double)>& f, double at_0, double at_1, double tolerance) {
  double low = 0, high = 1, best = at_1 < -at_0 ? 1 : 0, error = std::min(at_1, -at_0);
  int side = 0;
  for (int i = 0; i < 150 && error > tolerance && high - low > 1e-15; ++i) {
    const double u = i % 3 == 2 ? 0.5 * (low + high) : (low * at_1 - high * at_0) / (at_1 - at_0);
    const double value = f(u);
    if (std::abs(value) < error) {
      best = u;
      error = std::abs(value);
    }
    const int now = value < 0 ? -1 : 1;
    if (now < 0) {
      low = u;
      at_0 = value;
      if (side == now) at_1 *= 0.5;
    } else {
      high = u;
      at_1 = value;
      if (side == now) at_0 *= 0.5;
    }
    side = now;
  }
  return best;
}

}  // namespace

GrainSizeDistribution::GrainSizeDistribution(const GrainMaterial& grain, double scale) {
  const GrainSizes& sizes = grain.sizes;
  const bool sieve = sizes.law == SizeLaw::sieve && sizes.sieve.x.size() > 1;
  low_ = scale * (sieve ? sizes.sieve.x.front() : grain.diameter_min);
  high_ = scale * (sieve ? sizes.sieve.x.back() : grain.diameter_max);
  if (!(low_ > 0) || !(high_ >= low_) || !(scale > 0))
    throw_input_error("grain sizes: diameters {} to {} m, times {}; all must be positive, and not falling",
                      low_ / scale, high_ / scale, scale);
  switch (sizes.law) {
    case SizeLaw::uniform:
      if (high_ > low_) add_piece(low_, high_, sizes.by == SizeShares::mass ? -3 : 0, 1);
      break;
    case SizeLaw::lognormal:
      make_lognormal(sizes, scale);
      return;
    case SizeLaw::sieve:
      make_sieve(sizes, scale);
      break;
  }
  if (pieces_.empty()) mean_cube_ = power(low_, 3);
  number_pieces();
}

/// Straight in ln d: what the shares count goes by 1/d.
void GrainSizeDistribution::make_sieve(const GrainSizes& sizes, double scale) {
  const Curve& curve = sizes.sieve;
  if (curve.x.size() < 2 || curve.y.size() != curve.x.size() || !(curve.y.back() > curve.y.front()))
    throw_input_error(
        "grain sizes: a sieve curve needs two openings or more, with the share that passes each, rising");
  for (std::size_t i = 1; i < curve.x.size(); ++i) {
    const double share = curve.y[i] - curve.y[i - 1];
    if (!(share >= 0) || !(curve.x[i] > curve.x[i - 1]))
      throw_input_error("grain sizes: the sieve curve falls at {} m", curve.x[i]);
    const double low = scale * curve.x[i - 1], high = scale * curve.x[i];
    if (share > 0)
      add_piece(low, high, sizes.by == SizeShares::mass ? -4 : -1, share / power_integral(low, high, -1));
  }
}

void GrainSizeDistribution::add_piece(double low, double high, int power, double factor) {
  pieces_.push_back({low, high, power, factor, 0, 0, 0});
}

/// Shares of number that add up to 1, whatever the factors came from.
void GrainSizeDistribution::number_pieces() {
  double sum = 0;
  for (const Piece& piece : pieces_) sum += piece.factor * power_integral(piece.low, piece.high, piece.power);
  double number = 0;
  for (Piece& piece : pieces_) {
    piece.factor /= sum;
    piece.inside = piece.factor * power_integral(piece.low, piece.high, piece.power);
    piece.before = number;
    piece.mass_before = mean_cube_;
    number += piece.inside;
    mean_cube_ += piece.factor * power_integral(piece.low, piece.high, piece.power + 3);
  }
}

void GrainSizeDistribution::make_lognormal(const GrainSizes& sizes, double scale) {
  if (!(sizes.median > 0) || !(sizes.geometric_deviation > 1) || !(high_ > low_))
    throw_input_error(
        "grain sizes: lognormal with median {} m and geometric deviation {}; the first must be above 0, the "
        "other above 1, and the limits apart",
        sizes.median, sizes.geometric_deviation);
  deviation_ = std::log(sizes.geometric_deviation);
  median_ = scale * sizes.median;
  if (sizes.by == SizeShares::mass) median_ *= std::exp(-3 * deviation_ * deviation_);
  const double a = std::log(low_ / median_) / deviation_, b = std::log(high_ / median_) / deviation_;
  mean_cube_ = power(median_, 3) * std::exp(4.5 * deviation_ * deviation_) *
               normal_between(a - 3 * deviation_, b - 3 * deviation_) / normal_between(a, b);
}

double GrainSizeDistribution::number_below(double diameter) const {
  if (diameter >= high_) return 1;
  if (diameter <= low_) return 0;
  if (deviation_ > 0) {
    const double a = std::log(low_ / median_) / deviation_, b = std::log(high_ / median_) / deviation_;
    return normal_between(a, std::log(diameter / median_) / deviation_) / normal_between(a, b);
  }
  double share = 0;
  for (const Piece& piece : pieces_)
    if (diameter > piece.low)
      share = piece.before +
              piece.factor * power_integral(piece.low, std::min(diameter, piece.high), piece.power);
  return share;
}

double GrainSizeDistribution::mass_below(double diameter) const {
  if (diameter >= high_) return 1;
  if (diameter <= low_) return 0;
  if (deviation_ > 0) {
    const double shift = 3 * deviation_, a = std::log(low_ / median_) / deviation_ - shift,
                 b = std::log(high_ / median_) / deviation_ - shift;
    return normal_between(a, std::log(diameter / median_) / deviation_ - shift) / normal_between(a, b);
  }
  double cubes = 0;
  for (const Piece& piece : pieces_)
    if (diameter > piece.low)
      cubes = piece.mass_before +
              piece.factor * power_integral(piece.low, std::min(diameter, piece.high), piece.power + 3);
  return cubes / mean_cube_;
}

double GrainSizeDistribution::diameter_of(double number_share) const {
  if (deviation_ > 0) {
    const double a = std::log(low_ / median_) / deviation_, b = std::log(high_ / median_) / deviation_;
    return std::clamp(median_ * std::exp(deviation_ * normal_quantile_between(a, b, number_share)), low_,
                      high_);
  }
  if (pieces_.empty()) return low_;
  const auto above = std::upper_bound(pieces_.begin(), pieces_.end(), number_share,
                                      [](double share, const Piece& piece) { return share < piece.before; });
  const Piece& piece = *std::prev(above);
  return power_quantile(piece.low, piece.high, piece.power,
                        std::clamp((number_share - piece.before) / piece.inside, 0.0, 1.0));
}

std::vector<double> quota_diameters(const GrainSizeDistribution& sizes, double mass, double density) {
  if (mass < 0.5 * sphere_mass(sizes.smallest(), density)) return {};
  const double mean = std::numbers::pi / 6 * density * sizes.mean_cube();
  const auto count = static_cast<std::size_t>(std::max(1.0, std::round(mass / mean)));
  std::vector<double> diameters(count);
  const auto excess = [&](double u) {
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      diameters[k] = sizes.diameter_of((static_cast<double>(k) + u) / static_cast<double>(count));
      sum += sphere_mass(diameters[k], density);
    }
    return sum - mass;
  };
  const double most = excess(1);
  if (most <= 0) return diameters;
  const double least = excess(0);
  if (least >= 0) return diameters;
  (void)excess(root_of_rising(excess, least, most, 1e-12 * mass));
  return diameters;
}

}  // namespace tuft::dem

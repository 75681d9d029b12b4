#pragma once
/// Distributions of grain sizes, and grains drawn from them.
///
/// A law is given by shares of number or of mass; grains are counted, so a law by mass is turned into that of
/// numbers: dN ~ dM / d^3, since all grains of a kind have one density.
#include <vector>

#include "core/scene.h"

namespace tuft::dem {

/// Diameters of one kind of grain. Two families hold all laws of GrainSizes:
/// - powers in pieces, dN ~ d^p dd between two diameters, p a whole number: uniform in number (p = 0) or mass
///   (-3), sieve curves straight in ln d by number (-1) or mass (-4);
/// - lognormal in number, cut off; one by mass with median m and deviation s is one by number with median
///   m exp(-3 s^2) and the same s (Hatch & Choate 1929, doi 10.1016/S0016-0032(29)91451-4).
class GrainSizeDistribution {
 public:
  /// `scale` multiplies all diameters (coarse graining). Throws InputError where the law is not one: limits
  /// that are not positive and rising, a curve that falls.
  GrainSizeDistribution(const GrainMaterial& grain, double scale);

  [[nodiscard]] double smallest() const { return low_; }  ///< m
  [[nodiscard]] double largest() const { return high_; }  ///< m
  /// Share of all grains, and of their mass, that is finer than a diameter (m): 0 to 1.
  [[nodiscard]] double number_below(double diameter) const;
  [[nodiscard]] double mass_below(double diameter) const;
  /// Diameter, m, that a share of all grains, 0 to 1, is finer than.
  [[nodiscard]] double diameter_of(double number_share) const;
  /// Mean over all grains of d^3, m^3.
  [[nodiscard]] double mean_cube() const { return mean_cube_; }

 private:
  struct Piece {
    double low, high;       ///< m
    int power;              ///< p
    double factor;          ///< of d^p, number per m^(p+1), shares of number add up to 1
    double before, inside;  ///< share of number below the piece, and in it
    double mass_before;     ///< sum of d^3 below the piece, m^3
  };
  void add_piece(double low, double high, int power, double factor);
  void number_pieces();
  void make_sieve(const GrainSizes& sizes, double scale);
  void make_lognormal(const GrainSizes& sizes, double scale);

  double low_ = 0, high_ = 0, mean_cube_ = 0;
  std::vector<Piece> pieces_;          ///< empty: lognormal, or all of one size
  double median_ = 0, deviation_ = 0;  ///< m, by number; of ln d; 0: not lognormal
};

/// Diameters, m, rising, that follow the distribution and weigh `mass` (kg) together, at `density` (kg/m^3).
/// Quotas, not chance: grain k of n has the diameter of which a share (k + u)/n of grains is finer, with one
/// u in [0, 1] for all, which sets the mass. So no share of number is off by more than 1/n, where drawing at
/// random is off by about 1/sqrt(n). The mass is met to rounding; for a handful of grains within half a mean
/// grain, where no grain lies in a gap of the curve within half of the step in mass across the gap. None are
/// drawn for less than half of the smallest grain's mass.
[[nodiscard]] std::vector<double> quota_diameters(const GrainSizeDistribution& sizes, double mass,
                                                  double density);

/// What is drawn at random one by one instead: sizes uniform in number, as in all versions so far.
[[nodiscard]] constexpr bool is_drawn_at_random(const GrainSizes& sizes) {
  return sizes.law == SizeLaw::uniform && sizes.by == SizeShares::number;
}

}  // namespace tuft::dem

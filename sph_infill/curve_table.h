#pragma once
/// Rising curves made of straight and exponential pieces, evaluated exactly (no resampling error) in constant
/// time.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/lane_columns.h"
#include "core/lane_math.h"
#include "core/vector.h"

namespace tuft::sph {

/// y = y0 + slope (exp(rate d) - 1) / rate with d = x - x0; a straight line for rate = 0. Its derivative is
/// linear in y, dy/dx = slope + rate (y - y0), which is how a modulus that grows linearly with pressure
/// reads.
///
/// Real: double, or Pack for a piece a lane.
template <class Real>
struct CurvePieceOf {
  Real x0 = 0, y0 = 0, slope = 0, rate = 0;
  Real area0 = 0;  ///< integral of the curve from 0 to x0; CurveTable's to set

  [[nodiscard]] Real value(const Real& x) const {
    const Real d = x - x0, grown = rate * d;
    const auto straight = grown == Real(0);
    if (all(straight)) return y0 + slope * d;
    return y0 + slope * d * select(straight, Real(1), expm1(grown) / select(straight, Real(1), grown));
  }
  [[nodiscard]] Real derivative_at_value(const Real& y) const { return slope + rate * (y - y0); }
  [[nodiscard]] Real argument(const Real& y) const {
    const Real d = (y - y0) / slope, grown = rate * d;
    const auto straight = grown == Real(0);
    return x0 + d * select(straight, Real(1), log1p(grown) / select(straight, Real(1), grown));
  }
  /// Integral of the curve from 0 to x.
  [[nodiscard]] Real area(const Real& x) const {
    const Real d = x - x0, grown = rate * d;
    // (exp(g) - 1 - g)/g^2 by its series where the difference would lose its digits.
    const auto small = grown < Real(1e-3) && grown > Real(-1e-3);
    const Real series =
        Real(0.5) + grown * (Real(1.0 / 6) + grown * (Real(1.0 / 24) + grown * Real(1.0 / 120)));
    const Real held = select(small, Real(1), grown);
    return area0 + d * (y0 + slope * d * select(small, series, (expm1(grown) - grown) / (held * held)));
  }
};
using CurvePiece = CurvePieceOf<double>;

/// Rising numbers, among which the last that is not above some x is found in constant time unless they crowd:
/// bins of equal width say where to begin, and from there it goes upwards.
class RisingStarts {
 public:
  RisingStarts() = default;
  /// starts: at least one, rising.
  explicit RisingStarts(const std::vector<double>& starts) {
    // The first serves everything below it, too.
    for (std::size_t k = 1; k < starts.size(); ++k) next_.push_back(starts[k]);
    if (!next_.empty()) {
      low_ = next_.front();
      const double span = next_.back() - low_;
      if (span > 0) bins_per_x_ = static_cast<double>(bin_count) / span;
    }
    first_of_bin_.assign(bin_count + 1, 0);
    // Each looks up half a bin lower than it begins, so that rounding of the bin number cannot skip one.
    for (std::size_t b = 0; bins_per_x_ > 0 && b <= bin_count; ++b) {
      const double x = low_ + (static_cast<double>(b) - 0.5) / bins_per_x_;
      first_of_bin_[b] = static_cast<Index>(std::upper_bound(next_.begin(), next_.end(), x) - next_.begin());
    }
    next_.push_back(std::numeric_limits<double>::quiet_NaN());  // nothing is above the last
  }

  /// Its place. NaN: some place.
  [[nodiscard]] std::size_t at(double x) const {
    auto k = static_cast<std::size_t>(first_of_bin_[bin_of(clamped(x))]);
    while (x >= next_[k]) ++k;
    return k;
  }
  /// The same for a number a lane.
  [[nodiscard]] std::array<Index, lanes> at(const Pack& x) const {
    std::array<Index, lanes> place;
    const Pack bin = clamped(x);
    for (std::size_t l = 0; l < lanes; ++l) place[l] = first_of_bin_[bin_of(bin[l])];
    // All lanes together, so that which of them go on is no branch.
    for (PackMask above = x >= next(place); stdx::any_of(above); above = x >= next(place))
      for (std::size_t l = 0; l < lanes; ++l) place[l] += static_cast<Index>(above[l]);
    return place;
  }

 private:
  static constexpr std::size_t bin_count = 256;

  /// The bin's number and what follows the point.
  template <class Real>
  [[nodiscard]] Real clamped(const Real& x) const {
    const Real bin = (x - low_) * bins_per_x_, most = static_cast<double>(bin_count);
    const Real risen = select(bin > Real(0), bin, Real(0));  // of NaN: 0, for it must not become an index
    return select(risen < most, risen, most);
  }
  static std::size_t bin_of(double clamped) { return static_cast<std::size_t>(static_cast<int>(clamped)); }
  [[nodiscard]] Pack next(const std::array<Index, lanes>& place) const {
    return Pack([&](auto l) { return next_[static_cast<std::size_t>(place[l])]; });
  }

  std::vector<double> next_;  ///< what a place ends before; NaN for the last
  std::vector<Index> first_of_bin_;
  double low_ = 0, bins_per_x_ = 0;
};

/// A curve from pieces that join. The first piece also serves all smaller x, the last all larger ones.
class CurveTable {
 public:
  struct Point {
    double value, derivative;
  };

  CurveTable() = default;
  /// pieces: at least one, x0 and y0 strictly rising, slopes > 0.
  explicit CurveTable(std::vector<CurvePiece> pieces) : pieces_(std::move(pieces)) {
    const auto starts = [this](double CurvePiece::*member) {
      std::vector<double> all;
      for (const CurvePiece& piece : pieces_) all.push_back(piece.*member);
      return RisingStarts(all);
    };
    by_argument_ = starts(&CurvePiece::x0), by_value_ = starts(&CurvePiece::y0);
    for (std::size_t k = 1; k < pieces_.size(); ++k) pieces_[k].area0 = pieces_[k - 1].area(pieces_[k].x0);
    const double area_at_zero = piece(0).area(0);
    for (CurvePiece& each : pieces_) each.area0 -= area_at_zero;
  }

  /// The piece that serves x.
  [[nodiscard]] const CurvePiece& piece(double x) const { return pieces_[by_argument_.at(x)]; }
  /// The piece that takes the value y.
  [[nodiscard]] const CurvePiece& piece_of_value(double y) const { return pieces_[by_value_.at(y)]; }
  /// The same for a number a lane.
  [[nodiscard]] CurvePieceOf<Pack> piece(const Pack& x) const { return pieces_at(by_argument_.at(x)); }
  [[nodiscard]] CurvePieceOf<Pack> piece_of_value(const Pack& y) const { return pieces_at(by_value_.at(y)); }

  [[nodiscard]] Point operator()(double x) const {
    const CurvePiece& serves = piece(x);
    const double y = serves.value(x);
    return {y, serves.derivative_at_value(y)};
  }
  /// x at which the curve takes the value y.
  [[nodiscard]] double argument(double y) const { return piece_of_value(y).argument(y); }
  [[nodiscard]] const std::vector<CurvePiece>& pieces() const { return pieces_; }

 private:
  [[nodiscard]] CurvePieceOf<Pack> pieces_at(const std::array<Index, lanes>& place) const {
    RowsOf<double, sizeof(CurvePiece)> rows{&pieces_.data()->x0, {}};
    for (std::size_t l = 0; l < lanes; ++l) rows.at[l] = static_cast<std::size_t>(place[l]);
    const auto [x0, y0, slope, rate] = load_columns<4>(rows);
    return {x0, y0, slope, rate,
            Pack([&](auto l) { return pieces_[static_cast<std::size_t>(place[l])].area0; })};
  }

  std::vector<CurvePiece> pieces_;
  RisingStarts by_argument_, by_value_;
};

}  // namespace tuft::sph

#pragma once
/// Rising curves made of straight and exponential pieces, evaluated exactly (no resampling error) in constant
/// time.
#include <algorithm>
#include <cmath>
#include <vector>

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
    using std::expm1;
    const Real d = x - x0, grown = rate * d;
    const auto straight = grown == Real(0);
    return y0 + slope * d * select(straight, Real(1), expm1(grown) / select(straight, Real(1), grown));
  }
  [[nodiscard]] Real derivative_at_value(const Real& y) const { return slope + rate * (y - y0); }
  [[nodiscard]] Real argument(const Real& y) const {
    using std::log1p;
    const Real d = (y - y0) / slope, grown = rate * d;
    const auto straight = grown == Real(0);
    return x0 + d * select(straight, Real(1), log1p(grown) / select(straight, Real(1), grown));
  }
  /// Integral of the curve from 0 to x.
  [[nodiscard]] Real area(const Real& x) const {
    using std::expm1;
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

/// A curve from pieces that join. The first piece also serves all smaller x, the last all larger ones.
class CurveTable {
 public:
  struct Point {
    double value, derivative;
  };

  CurveTable() = default;
  /// pieces: at least one, x0 and y0 strictly rising, slopes > 0.
  explicit CurveTable(std::vector<CurvePiece> pieces) : pieces_(std::move(pieces)) {
    // Bins cover the starts of all pieces but the first, which has no end below.
    first_start_ = pieces_[std::min<std::size_t>(1, pieces_.size() - 1)].x0;
    const double span = pieces_.back().x0 - first_start_;
    if (span > 0) bins_per_x_ = static_cast<double>(bin_count) / span;
    first_piece_.assign(bin_count + 1, 0);
    // Each looks up half a bin lower than it begins, so that rounding of the bin number cannot skip a piece.
    for (std::size_t b = 0; span > 0 && b <= bin_count; ++b)
      first_piece_[b] =
          static_cast<Index>(search_argument(first_start_ + (static_cast<double>(b) - 0.5) / bins_per_x_));
    for (std::size_t k = 1; k < pieces_.size(); ++k) pieces_[k].area0 = pieces_[k - 1].area(pieces_[k].x0);
    const double area_at_zero = piece(0).area(0);
    for (CurvePiece& each : pieces_) each.area0 -= area_at_zero;
  }

  /// The piece that serves x.
  [[nodiscard]] const CurvePiece& piece(double x) const { return pieces_[piece_at(x)]; }
  /// The piece that takes the value y.
  [[nodiscard]] const CurvePiece& piece_of_value(double y) const {
    const auto above = std::upper_bound(pieces_.begin() + 1, pieces_.end(), y,
                                        [](double v, const CurvePiece& piece) { return v < piece.y0; });
    return *std::prev(above);
  }

  [[nodiscard]] Point operator()(double x) const {
    const CurvePiece& piece = pieces_[piece_at(x)];
    const double y = piece.value(x);
    return {y, piece.derivative_at_value(y)};
  }
  /// x at which the curve takes the value y.
  [[nodiscard]] double argument(double y) const { return piece_of_value(y).argument(y); }
  [[nodiscard]] const std::vector<CurvePiece>& pieces() const { return pieces_; }

 private:
  static constexpr std::size_t bin_count = 256;

  [[nodiscard]] std::size_t search_argument(double x) const {
    const auto above = std::upper_bound(pieces_.begin() + 1, pieces_.end(), x,
                                        [](double v, const CurvePiece& piece) { return v < piece.x0; });
    return static_cast<std::size_t>(above - pieces_.begin()) - 1;
  }
  [[nodiscard]] std::size_t piece_at(double x) const {
    const double bin = std::clamp((x - first_start_) * bins_per_x_, 0.0, static_cast<double>(bin_count));
    // A NaN passes clamp unchanged; it must not become an index.
    auto k = static_cast<std::size_t>(first_piece_[bin >= 0 ? static_cast<std::size_t>(bin) : 0]);
    while (k + 1 < pieces_.size() && x >= pieces_[k + 1].x0) ++k;
    return k;
  }

  std::vector<CurvePiece> pieces_;
  std::vector<Index> first_piece_;  ///< by bin: the last piece that begins no later than the bin
  double first_start_ = 0, bins_per_x_ = 0;
};

}  // namespace tuft::sph

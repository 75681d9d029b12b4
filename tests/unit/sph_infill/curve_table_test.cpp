#include "sph_infill/curve_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace tuft::sph {
namespace {

/// Straight, then exponential, then straight pieces of very unlike length.
std::vector<CurvePiece> joined_pieces() {
  std::vector<CurvePiece> pieces{{0, 0, 1, 0}};
  double rate = 0;
  for (const double length : {1e-6, 0.3, 0.0101, 0.2, 0.05}) {
    const CurvePiece& last = pieces.back();
    const double x = last.x0 + length;
    rate = rate == 0 ? 4 : 0;
    pieces.push_back({x, last.value(x), 1 + x, rate});
  }
  return pieces;
}

TEST(CurveTable, FindsTheRightPieceEverywhere) {
  const auto pieces = joined_pieces();
  const CurveTable table(pieces);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> anywhere(-0.2, 1.0);
  for (int k = 0; k < 20000; ++k) {
    const double x = anywhere(random);
    std::size_t piece = 0;
    while (piece + 1 < pieces.size() && x >= pieces[piece + 1].x0) ++piece;
    ASSERT_EQ(table(x).value, pieces[piece].value(x)) << "at x = " << x;
  }
  for (const CurvePiece& piece : pieces) EXPECT_EQ(table(piece.x0).value, piece.y0);
}

/// Thirty pieces within the first hundredth of the span: many starts share a bin.
std::vector<CurvePiece> crowded_pieces() {
  std::vector<CurvePiece> pieces{{0, 0, 1, 0}};
  for (double x = 1e-4; x < 0.02; x *= 1.2) pieces.push_back({x, pieces.back().value(x), 1 + x, 0});
  pieces.push_back({1, pieces.back().value(1), 3, 0.5});
  return pieces;
}

TEST(CurveTable, FindsForAPackWhatItFindsForEachLane) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> extremes{-infinity, infinity, std::nan(""), -1e300, 1e300, 0.0};
  for (const auto& pieces : {joined_pieces(), crowded_pieces(), std::vector<CurvePiece>{{0, 0, 1, 0}}}) {
    const CurveTable table(pieces);
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> anywhere(-0.1, 1.1), near(0, 0.02);
    for (int k = 0; k < 20000; ++k) {
      const auto next = [&](std::size_t l) {
        if (k < 6) return extremes[(static_cast<std::size_t>(k) + l) % extremes.size()];
        return k % 2 ? anywhere(random) : near(random);
      };
      const Pack x(next);
      const CurvePieceOf<Pack> serves = table.piece(x), takes = table.piece_of_value(x);
      for (std::size_t l = 0; l < lanes; ++l) {
        const CurvePiece &one = table.piece(x[l]), &of_value = table.piece_of_value(x[l]);
        ASSERT_EQ(serves.x0[l], one.x0) << "at x = " << x[l];
        ASSERT_EQ(serves.rate[l], one.rate);
        ASSERT_EQ(serves.area0[l], one.area0);
        ASSERT_EQ(takes.y0[l], of_value.y0) << "at y = " << x[l];
        ASSERT_EQ(takes.slope[l], of_value.slope);
        std::size_t piece = 0;
        while (piece + 1 < pieces.size() && x[l] >= pieces[piece + 1].y0) ++piece;
        if (x[l] == x[l]) {
          ASSERT_EQ(of_value.y0, pieces[piece].y0) << "at y = " << x[l];
        }
      }
    }
  }
}

TEST(CurveTable, ArgumentInvertsValue) {
  const CurveTable table(joined_pieces());
  for (double x = -0.1; x < 1; x += 0.00713) EXPECT_NEAR(table.argument(table(x).value), x, 1e-14);
}

TEST(CurveTable, DerivativeMatchesDifferences) {
  const CurveTable table(joined_pieces());
  for (const double x : {-0.05, 0.1, 0.25, 0.305, 0.4, 0.9})
    EXPECT_NEAR(table(x).derivative, (table(x + 1e-7).value - table(x - 1e-7).value) / 2e-7, 1e-6);
}

TEST(CurveTable, PassesNanOn) {
  const CurveTable table(joined_pieces());
  EXPECT_TRUE(std::isnan(table(std::nan("")).value));
}

}  // namespace
}  // namespace tuft::sph

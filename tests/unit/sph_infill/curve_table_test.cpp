#include "sph_infill/curve_table.h"

#include <gtest/gtest.h>

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

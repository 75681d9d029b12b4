/// Fields against each other.
#include "micro_scale/field_comparison.h"

#include <gtest/gtest.h>

namespace tuft::micro {
namespace {

TEST(FieldComparison, OfAFieldWithItselfFindsNoDifferenceAndFullCorrelation) {
  const std::vector<double> field{1, -2, 4, 0.5};
  const std::vector<char> all(4, 1);
  const FieldComparison same = compare_fields(field, field, all);
  EXPECT_EQ(same.cells, 4u);
  EXPECT_EQ(same.difference, 0);
  EXPECT_NEAR(same.correlation, 1, 1e-15);
}

TEST(FieldComparison, MeasuresAConstantOffsetAndAFactor) {
  const std::vector<double> a{1, 2, 3}, shifted{1.5, 2.5, 3.5}, opposite{-1, -2, -3};
  const std::vector<char> all(3, 1);
  EXPECT_NEAR(compare_fields(a, shifted, all).difference, 0.5, 1e-15);
  EXPECT_NEAR(compare_fields(a, shifted, all).correlation, 1, 1e-15);
  EXPECT_NEAR(compare_fields(a, opposite, all).correlation, -1, 1e-15);
  const std::vector<double> twice{3, 6, 9};  // mean of both 2 a, difference 2 a
  EXPECT_NEAR(compare_fields(a, twice, all).relative, 1, 1e-15);
}

TEST(FieldComparison, LooksAtTheCellsThatBothFillAlone) {
  const std::vector<double> density_a{100, 100, 5, 0}, density_b{80, 4, 90, 0};
  const std::vector<char> taken = filled_in_both(density_a, density_b, 0.1);
  EXPECT_EQ(taken, (std::vector<char>{1, 0, 0, 0}));
  const FieldComparison one = compare_fields(density_a, density_b, taken);
  EXPECT_EQ(one.cells, 1u);
  EXPECT_EQ(one.difference, 20);
  EXPECT_EQ(one.correlation, 0) << "one cell has none";
}

TEST(Profile, IsTheMeanOfEachLayerOfCells) {
  CoarseGrid grid;
  grid.cells = {2, 1, 2};
  const std::vector<double> scalar{1, 3, 10, 20}, vectors{0, 1, 0, 3, 0, 10, 0, 20};
  EXPECT_EQ(profile(grid, scalar), (std::vector<double>{2, 15}));
  EXPECT_EQ(profile(grid, vectors, 2, 1), (std::vector<double>{2, 15}));
}

}  // namespace
}  // namespace tuft::micro

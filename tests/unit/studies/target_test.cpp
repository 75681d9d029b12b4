// How far results are from targets.
#include <gtest/gtest.h>

#include <cmath>

#include "studies/calibration_target.h"

namespace tuft::studies {
namespace {

ModelOutcome outcome_of(double value) {
  ModelOutcome outcome;
  outcome.results["q"] = value;
  return outcome;
}

Target range(double low, double high, double margin = 0) {
  Target target;
  target.quantity = "q";
  target.form = TargetForm::range;
  target.low = low, target.high = high, target.margin = margin;
  return target;
}

TEST(RangeResidual, IsNothingInsideAndGrowsFromTheEndsInHalvesOfTheWidth) {
  for (const double inside : {2.0, 2.5, 4.0}) EXPECT_EQ(range_residual(inside, 2, 4, 0), 0);
  EXPECT_DOUBLE_EQ(range_residual(5, 2, 4, 0), 1);
  EXPECT_DOUBLE_EQ(range_residual(1.5, 2, 4, 0), -0.5);
}

TEST(RangeResidual, BeginsAtTheMargin) {
  EXPECT_EQ(range_residual(2.2, 2, 4, 0.1), 0);
  EXPECT_NEAR(range_residual(2.1, 2, 4, 0.1), -0.1, 1e-12);
  EXPECT_NEAR(range_residual(4.0, 2, 4, 0.1), 0.2, 1e-12);
}

TEST(RangeMisfit, IsSmoothAtTheEnds) {
  // Squared, the one-sided slope at the end vanishes with the distance.
  for (const double h : {1e-2, 1e-4, 1e-6}) {
    const TargetOutcome judged = judge(range(2, 4), outcome_of(4 + h), 1e4);
    EXPECT_LE(judged.misfit / h, h * (1 + 1e-6));
  }
}

TEST(RangeTarget, IsMetBetweenItsEndsTheMarginNotCounted) {
  const Target target = range(2, 4, 0.1);
  for (const double value : {2.0, 2.1, 4.0})
    EXPECT_TRUE(is_inside(target, judge(target, outcome_of(value), 1e4))) << value;
  EXPECT_FALSE(is_inside(target, judge(target, outcome_of(std::nextafter(4.0, 5.0)), 1e4)));
  EXPECT_DOUBLE_EQ(scale_of(target), 1);
}

TEST(NumberTarget, CountsInTolerancesAndWeight) {
  Target target;
  target.quantity = "q";
  target.number = 10, target.tolerance = 0.5, target.weight = 4;
  const TargetOutcome judged = judge(target, outcome_of(11), 1e4);
  EXPECT_DOUBLE_EQ(judged.misfit, 16);
  EXPECT_FALSE(is_inside(target, judged));
  EXPECT_TRUE(is_inside(target, judge(target, outcome_of(10.5), 1e4)));
}

TEST(CurveTarget, IsComparedAtItsOwnPointsOverItsLargestValue) {
  ModelOutcome outcome;
  outcome.curves.push_back({"c", "1", "Pa", "", "", {0, 1, 3}, {0, 10, 30}});
  Target target;
  target.quantity = "c";
  target.form = TargetForm::curve;
  target.tolerance = 0.1;
  target.x = {0.5, 2}, target.y = {5, 22};
  const TargetOutcome judged = judge(target, outcome, 1e4);
  ASSERT_TRUE(judged.measured);
  EXPECT_NEAR(judged.value, 2.0 / 22, 1e-12);
  EXPECT_NEAR(judged.misfit, 0.5 * std::pow(2.0 / 22 / 0.1, 2), 1e-12) << "mean over its points";
  EXPECT_TRUE(is_inside(target, judged));
}

TEST(CurveTarget, BeyondTheModelsCurveIsComparedWithItsContinuationButNotMet) {
  ModelOutcome outcome;
  outcome.curves.push_back({"c", "1", "Pa", "", "", {0, 1}, {0, 10}});
  Target target;
  target.quantity = "c";
  target.form = TargetForm::curve;
  target.tolerance = 0.1;
  target.x = {0.5, 1.2}, target.y = {5, 12};
  TargetOutcome judged = judge(target, outcome, 1e4);
  EXPECT_TRUE(judged.measured);
  EXPECT_NEAR(judged.misfit, 0, 1e-20);
  EXPECT_FALSE(is_inside(target, judged));
  target.x[1] = 1.005, target.y[1] = 10;
  EXPECT_TRUE(is_inside(target, judge(target, outcome, 1e4))) << "rows of a rig end a little off";
  target.x[1] = 2.5;
  judged = judge(target, outcome, 1e4);
  EXPECT_FALSE(judged.measured) << "farther out than its width";
  EXPECT_EQ(judged.misfit, 1e4);
}

TEST(ValueAt, FollowsTheCurveBothWaysAndGoesOnStraightBeyondItsEnds) {
  const ModelCurve down{"", "1", "Pa", "", "", {3, 1, 0}, {30, 10, 5}};
  EXPECT_DOUBLE_EQ(value_at(down, 2)->y, 20);
  EXPECT_DOUBLE_EQ(value_at(down, 0.5)->y, 7.5);
  EXPECT_EQ(value_at(down, 0.5)->beyond, 0);
  EXPECT_DOUBLE_EQ(value_at(down, -0.3)->y, 3.5);
  EXPECT_DOUBLE_EQ(value_at(down, -0.3)->beyond, 0.1);
  EXPECT_DOUBLE_EQ(value_at(down, 4.5)->y, 45);
  EXPECT_DOUBLE_EQ(value_at(down, 4.5)->beyond, 0.5);
  EXPECT_FALSE(value_at(down, 6.5));
  EXPECT_FALSE(value_at(down, -3.5));
  EXPECT_FALSE(value_at({"", "1", "Pa", "", "", {1}, {1}}, 1));
}

TEST(FailedModel, IsALargeFiniteMisfitWhateverTheTarget) {
  ModelOutcome failed;
  failed.error = "lost";
  for (const TargetForm form : {TargetForm::number, TargetForm::range, TargetForm::curve}) {
    Target target;
    target.quantity = "q";
    target.form = form;
    const TargetOutcome judged = judge(target, failed, 123);
    EXPECT_FALSE(judged.measured);
    EXPECT_EQ(judged.misfit, 123);
  }
}

}  // namespace
}  // namespace tuft::studies

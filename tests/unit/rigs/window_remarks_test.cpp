// Whatever makes windows shorter than a scene asks for is said in one line.
#include "rigs/window_remarks.h"

#include <gtest/gtest.h>

namespace tuft::rigs {
namespace {

/// Carpet, infill and contact bear 4, 20 and 100 us.
constexpr coupler::StableSteps soft{4e-6, 2e-5, 1e-4, 1};

std::string remark(double asked, double interval, const coupler::StableSteps& stable = soft) {
  Numerics numerics;
  numerics.step_safety = 0.8;
  numerics.coupling_window = asked;
  return remark_on_windows(stable, numerics, interval, "output.histories");
}

TEST(WindowRemark, SaysThatRowsAreCloserThanTheWindowAskedFor) {
  EXPECT_EQ(
      remark(3e-5, 1e-5),
      "windows of 10 us, where numerics.coupling_window asks for 30 us: whole numbers of windows make up "
      "output.histories (10 us)");
}

TEST(WindowRemark, SaysThatRowsAreNoWholeNumberOfTheWindowsAskedFor) {
  EXPECT_EQ(
      remark(3e-5, 4e-5),
      "windows of 20 us, where numerics.coupling_window asks for 30 us: whole numbers of windows make up "
      "output.histories (40 us)");
}

TEST(WindowRemark, SaysThatContactBearsNoWindowAsLong) {
  EXPECT_EQ(
      remark(1e-3, 5.5e-3),
      "windows of 56.1 us, where numerics.coupling_window asks for 1e+03 us: no more than 56.6 us are stable "
      "in contact with the infill, and whole numbers of windows make up output.histories (5.5e+03 us)");
  EXPECT_EQ(remark(1e-4, 5.65685e-3),
            "windows of 56.6 us, where numerics.coupling_window asks for 100 us: no more than 56.6 us are "
            "stable in "
            "contact with the infill");
}

TEST(WindowRemark, SaysBoth) {
  EXPECT_EQ(
      remark(1e-4, 1e-5),
      "windows of 10 us, where numerics.coupling_window asks for 100 us: no more than 56.6 us are stable in "
      "contact with the infill, and whole numbers of windows make up output.histories (10 us)");
}

TEST(WindowRemark, SaysNothingWhereWindowsAreAsAskedFor) {
  EXPECT_EQ(remark(2e-5, 2e-5), "");
  EXPECT_EQ(remark(2e-5, 4e-5), "");
  EXPECT_EQ(remark(4e-6, 2e-5), "");
}

/// The windows of one part's own step, where none are asked for.
TEST(WindowRemark, ProposesAnotherIntervalOfRowsWhereTheseCutWindowsMuchShorterThanIsStable) {
  const std::string said = remark(0, 2e-5);
  EXPECT_NE(said.find("windows of 10 us, where 15.7 us would be stable"), std::string::npos) << said;
  EXPECT_NE(said.find("with output.histories = \"14 us\""), std::string::npos) << said;
  EXPECT_EQ(remark(0, 1.5e-5), "");
}

}  // namespace
}  // namespace tuft::rigs

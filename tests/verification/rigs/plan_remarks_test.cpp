// What a plan says of a run before it is run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rigs/run.h"
#include "tests/verification/coupler/coarse_scene.h"

namespace tuft::rigs {
namespace {

/// SPH on its floor, where the infill alone sets the windows.
RunPlan plan_of_bed(double interval) {
  return plan(coarse_scene({{"effects.fibres", "false"},
                            {"numerics.settle_time", "1 ms"},
                            {"scene.duration", "1 ms"},
                            {"numerics.threads", "1"},
                            {"output.frames", fmt::format("{:.17g} s", 20 * interval)},
                            {"output.histories", fmt::format("{:.17g} s", interval)}}));
}

std::string remark_on_windows(const RunPlan& plan) {
  const auto found = std::ranges::find_if(
      plan.remarks, [](const std::string& r) { return r.find("output.histories") != std::string::npos; });
  return found == plan.remarks.end() ? "" : *found;
}

/// s, of a row to the next by the remark.
double proposed(const std::string& remark) {
  const std::string before = "with output.histories = \"";
  return 1e-6 * std::stod(remark.substr(remark.find(before) + before.size()));
}

class WindowsAndHistories : public testing::Test {
 protected:
  // A row of many windows is divided as finely as steps ask for.
  const double longest_ = plan_of_bed(1e-3).window;
};

TEST_F(WindowsAndHistories, ThatFitAreNotSpokenOf) {
  EXPECT_EQ(remark_on_windows(plan_of_bed(0.97 * longest_)), "");
  EXPECT_EQ(remark_on_windows(plan_of_bed(4.5 * longest_)), "");
}

TEST_F(WindowsAndHistories, ThatHalveTheStepGetAnIntervalProposedWhichNeedsFewer) {
  const RunPlan cut = plan_of_bed(1.1 * longest_);
  EXPECT_NEAR(cut.window, 0.55 * longest_, 1e-3 * longest_);
  const std::string remark = remark_on_windows(cut);
  ASSERT_NE(remark, "");
  EXPECT_LE(proposed(remark), longest_ * 1.01);
  EXPECT_EQ(remark_on_windows(plan_of_bed(proposed(remark))), "");
  EXPECT_LT(1.6 * static_cast<double>(plan_of_bed(proposed(remark)).windows),
            static_cast<double>(cut.windows));
}

TEST_F(WindowsAndHistories, OfRowsCloserThanAStepGetAWiderIntervalProposed) {
  const std::string remark = remark_on_windows(plan_of_bed(0.3 * longest_));
  ASSERT_NE(remark, "");
  EXPECT_NEAR(proposed(remark), longest_, 0.1 * longest_);
}

}  // namespace
}  // namespace tuft::rigs

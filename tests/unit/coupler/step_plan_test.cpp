#include "coupler/step_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"

namespace tuft::coupler {
namespace {

TEST(StepPlan, WindowsFillTheIntervalExactly) {
  for (const double infill : {1e-6, 2.9e-6, 1e-5, 1e-3}) {
    const StepPlan p = plan_steps({3e-6, infill, 1e-4}, 0.8, 0, 2e-5);
    EXPECT_NEAR(p.windows * p.window, 2e-5, 1e-18);
  }
}

TEST(StepPlan, NoPartStepsOverItsShareOfTheStableStep) {
  for (const double carpet : {1e-6, 2e-6, 7e-6})
    for (const double infill : {1e-6, 4e-6, 1e-5})
      for (const double contact : {2e-6, 1e-5, 1e-4})
        for (const double requested : {0.0, 1e-6, 1e-4}) {
          const StepPlan p = plan_steps({carpet, infill, contact}, 0.8, requested, 2e-5);
          EXPECT_LE(p.window / p.carpet_substeps, 0.8 * carpet * (1 + 1e-9));
          EXPECT_LE(p.window / p.infill_substeps, 0.8 / std::hypot(1 / infill, 1 / contact) * (1 + 1e-9));
          EXPECT_LE(p.window, 0.8 * contact * (1 + 1e-9)) << "contact impulses of a window stay stable";
        }
}

TEST(StepPlan, TheWindowIsTheLargerOfBothStepsUnlessTheSceneAsksForAnother) {
  const StepPlan soft_infill = plan_steps({3e-6, 1e-5, 1e-3}, 1.0, 0, 2e-5);
  EXPECT_EQ(soft_infill.infill_substeps, 1);
  EXPECT_GT(soft_infill.carpet_substeps, 2);
  const StepPlan stiff_infill = plan_steps({3e-6, 1e-6, 1e-3}, 1.0, 0, 2e-5);
  EXPECT_EQ(stiff_infill.carpet_substeps, 1);
  EXPECT_EQ(stiff_infill.infill_substeps, 3);
  const StepPlan asked = plan_steps({3e-6, 1e-6, 1e-3}, 1.0, 0.9e-6, 2e-5);
  EXPECT_EQ(asked.carpet_substeps, 1);
  EXPECT_EQ(asked.infill_substeps, 1);
  const StepPlan stiff_contact = plan_steps({3e-6, 1e-6, 2e-6}, 1.0, 0, 2e-5);
  EXPECT_LT(stiff_contact.window, 2e-6 / std::sqrt(2.0) * (1 + 1e-9));
}

TEST(StepPlan, GivesWholeWindowsOfTheCarpetsSlowElementsToAnIntervalWithinEveryStableStep) {
  for (const double carpet : {1e-6, 2e-6, 7e-6, 1e-4})
    for (const double infill : {1e-6, 4e-6, 1e-5})
      for (const int ratio : {1, 2, 3, 5, 8, 32}) {
        const StepPlan p = plan_steps({carpet, infill, 1e-4, ratio}, 0.8, 0, 2e-5);
        EXPECT_EQ(p.windows * p.carpet_substeps % p.carpet_subcycle, 0);
        EXPECT_LE(p.carpet_subcycle, ratio);
        EXPECT_NEAR(p.windows * p.window, 2e-5, 1e-18);
        EXPECT_LE(p.window / p.carpet_substeps, 0.8 * carpet * (1 + 1e-9));
        EXPECT_LE(p.window / p.infill_substeps, 0.8 / std::hypot(1 / infill, 1 / 1e-4) * (1 + 1e-9));
        const StepPlan without = plan_steps({carpet, infill, 1e-4, 1}, 0.8, 0, 2e-5);
        EXPECT_LE(p.windows * p.carpet_substeps, 1.05 * without.windows * without.carpet_substeps);
      }
  // 10 steps of the carpet: of 7 and fewer, 5 divides them.
  EXPECT_EQ(plan_steps({2e-6, 2e-6, 1e-3, 7}, 1.0, 2e-6, 2e-5).carpet_subcycle, 5);
}

TEST(StepPlan, APartWithoutAStableStepIsAnError) {
  EXPECT_THROW((void)plan_steps({3e-6, std::numeric_limits<double>::quiet_NaN(), 1e-3}, 1.0, 0, 2e-5),
               RunError);
  EXPECT_THROW((void)plan_steps({0, 1e-6, 1e-3}, 1.0, 0, 2e-5), RunError);
}

}  // namespace
}  // namespace tuft::coupler

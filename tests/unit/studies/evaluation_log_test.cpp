// The table of evaluations: what it gives back, and what it does with a row that was cut off.
#include "studies/evaluation_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "unit/core/scratch_folder.h"

namespace tuft::studies {
namespace {

Problem two_parameters() {
  Problem problem;
  for (const char* key : {"a", "b"}) {
    Parameter p;
    p.material_name = "soil";
    p.key = key;
    p.unit = "1";
    p.lower = 0, p.upper = 1, p.start = 0.5;
    problem.parameters.push_back(p);
  }
  for (const char* quantity : {"q", "r"}) {
    Target t;
    t.model_name = "m";
    t.quantity = quantity;
    t.unit = "Pa";
    problem.targets.push_back(t);
  }
  problem.file.regularisation = 0;
  return problem;
}

Evaluation evaluation(double a, double b) {
  Evaluation e;
  e.values = {a, b};
  e.targets.resize(2);
  e.targets[0].measured = true;
  e.targets[0].value = 1.0 / 3 * a;
  e.targets[0].misfit = 0.1;
  e.targets[1].misfit = 7;
  e.target_misfit = 7.1;
  e.misfit = 7.1;
  e.failed = true;
  e.error = "lost, \"all\" of it";
  return e;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(EvaluationLog, GivesBackItsRowsToTheBit) {
  const test::ScratchFolder folder;
  const Problem problem = two_parameters();
  const double third = 1.0 / 3;
  {
    EvaluationLog log(folder / "e.csv", problem);
    log.add("search", evaluation(third, 0.1));
    log.add("search", evaluation(0.25, 0.1));
  }
  const EvaluationLog again(folder / "e.csv", problem);
  EXPECT_EQ(again.found_before(), 2U);
  const Evaluation* found = again.find({third, 0.1});
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->targets[0].value, third * third);
  EXPECT_TRUE(found->targets[0].measured);
  EXPECT_FALSE(found->targets[1].measured);
  EXPECT_EQ(found->target_misfit, 7.1);
  EXPECT_TRUE(found->failed);
  EXPECT_EQ(found->error, "lost; 'all' of it");
  EXPECT_EQ(again.find({third, 0.2}), nullptr);
}

TEST(EvaluationLog, DropsARowThatWasCutOffAndGoesOn) {
  const test::ScratchFolder folder;
  const Problem problem = two_parameters();
  {
    EvaluationLog log(folder / "e.csv", problem);
    log.add("search", evaluation(0.1, 0.2));
    log.add("search", evaluation(0.3, 0.4));
  }
  const std::string whole = text_of(folder / "e.csv");
  std::ofstream(folder / "e.csv", std::ios::trunc) << whole.substr(0, whole.size() - 9);
  {
    EvaluationLog log(folder / "e.csv", problem);
    EXPECT_EQ(log.rows(), 1U);
    EXPECT_EQ(log.find({0.3, 0.4}), nullptr);
    log.add("search", evaluation(0.3, 0.4));
  }
  EXPECT_EQ(text_of(folder / "e.csv"), whole);
}

TEST(EvaluationLog, OfOtherTargetsIsRefused) {
  const test::ScratchFolder folder;
  Problem problem = two_parameters();
  { const EvaluationLog log(folder / "e.csv", problem); }
  problem.targets[0].quantity = "other";
  EXPECT_THAT(test::message_of<InputError>([&] { EvaluationLog(folder / "e.csv", problem); }),
              testing::HasSubstr("other parameters or targets"));
}

}  // namespace
}  // namespace tuft::studies

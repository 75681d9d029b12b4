// The calibrations of inputs/: their fitted materials are what their command gives, and every target is met.
#include <gtest/gtest.h>

#include "studies/calibrate.h"
#include "unit/core/scratch_folder.h"

namespace tuft::studies {
namespace {

class InputCalibration : public testing::TestWithParam<const char*> {};

TEST_P(InputCalibration, GivesTheFittedMaterialOfInputsAndMeetsItsTargets) {
  const std::string name = GetParam();
  const Problem problem = make_problem(read_calibration("inputs/calibrations/" + name + ".toml"));
  const tuft::test::ScratchFolder folder;
  EvaluationLog log(folder / "e.csv", problem);
  CalibrationRequest request;
  request.problem = &problem;
  request.log = &log;
  const CalibrationResult result = calibrate(request);
  const MaterialFile fitted =
      read_material_file("inputs/materials/" + name + "_calibrated.toml", name + "_calibrated");
  std::vector<double> values;
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    values.push_back(
        std::ranges::find(fitted.numbers, problem.parameters[i].key, &MaterialNumber::key)->value);
    EXPECT_FALSE(result.at_lower[i] || result.at_upper[i]) << problem.parameters[i].name();
  }
  // Rounding differs between machines, and the misfit is a flat valley (docs/calibration.md): as good, not
  // the same.
  const Evaluation written = evaluate(problem, {values}, nullptr).front();
  EXPECT_NEAR(written.misfit / result.fitted.misfit, 1, 0.01);
  for (std::size_t t = 0; t < problem.targets.size(); ++t)
    EXPECT_TRUE(is_inside(problem.targets[t], written.targets[t])) << problem.targets[t].name();
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    EXPECT_TRUE(is_inside(problem.targets[t], result.fitted.targets[t])) << problem.targets[t].name();
    const std::string& provenance = problem.targets[t].provenance;
    EXPECT_EQ(provenance.starts_with("literature: "), provenance.ends_with("not seen first hand"))
        << provenance;
  }
  EXPECT_EQ(result.failed, 0U);
}

INSTANTIATE_TEST_SUITE_P(All, InputCalibration, testing::Values("sand", "mixture", "sbr"),
                         [](const auto& which) { return std::string(which.param); });

}  // namespace
}  // namespace tuft::studies

// A calibration that was interrupted goes on from its table, to the same end as one that was not.
#include <gtest/gtest.h>

#include "verification/studies/soil_calibration.h"

namespace tuft::studies {
namespace {

using test::SoilCalibration;

struct Case {
  SoilCalibration soil;
  Problem problem;
  Case(const std::string& options, bool with_curve) : problem(soil.problem(targets(with_curve), options)) {}

  static std::string targets(bool with_curve) {
    std::string text = SoilCalibration::number("ring", "low", "\"4 MPa\"", "\"0.1 MPa\"") +
                       SoilCalibration::number("box", "angle", "\"30 degree\"", "\"1 degree\"");
    if (with_curve)
      text +=
          "[[targets]]\nmodel = \"ring\"\nquantity = \"segment_1_stress\"\nprovenance = \"assumed: any\"\n"
          "[targets.curve]\nx = [0.0, 0.05, 0.1]\ny = [0, 150, 400]\ny_unit = \"kPa\"\n";
    return text;
  }

  /// Stops as by Ctrl-C after so many evaluations of the search.
  CalibrationResult interrupted(std::size_t after) {
    EvaluationLog log(soil.path("broken.csv"), problem);
    std::atomic<bool> stop{false};
    CalibrationRequest request;
    request.problem = &problem;
    request.log = &log;
    request.stop = &stop;
    request.on_progress = [&](std::size_t count, double) {
      if (count >= after) stop = true;
    };
    return calibrate(request);
  }
};

void expect_same_end(Case& c) {
  const CalibrationResult whole = c.soil.fit(c.problem, "whole.csv");
  const CalibrationResult stopped = c.interrupted(17);
  EXPECT_EQ(stopped.status, "stopped");
  EXPECT_EQ(stopped.fitted.misfit, stopped.search.back().least) << "the best so far";
  EXPECT_FALSE(stopped.identifiability);
  const std::size_t before = c.soil.rows("broken.csv").size() - 1;
  EXPECT_LT(before, c.soil.rows("whole.csv").size() - 1);
  const CalibrationResult resumed = c.soil.fit(c.problem, "broken.csv");
  EXPECT_EQ(resumed.status, "completed");
  EXPECT_EQ(resumed.reused, before);
  EXPECT_EQ(resumed.fitted.values, whole.fitted.values);
  EXPECT_EQ(resumed.fitted.misfit, whole.fitted.misfit);
  EXPECT_EQ(c.soil.rows("broken.csv"), c.soil.rows("whole.csv")) << "as if it had not been interrupted";
  ASSERT_TRUE(resumed.identifiability && whole.identifiability);
  EXPECT_EQ(resumed.identifiability->together, whole.identifiability->together);
}

TEST(InterruptedCalibration, GoesOnToTheSameEnd) {
  Case c("[optimiser]\nmax_evaluations = 50\n", false);
  expect_same_end(c);
}

TEST(InterruptedCalibration, WithCurvesAndRandomNumbersToo) {
  Case c("[optimiser]\nalgorithm = \"crs2\"\nmax_evaluations = 90\nseed = 7\n", true);
  expect_same_end(c);
}

TEST(CompletedCalibration, RunAgainEvaluatesNothingNewButForItsCurves) {
  Case c("[optimiser]\nmax_evaluations = 40\n", false);
  const CalibrationResult first = c.soil.fit(c.problem), again = c.soil.fit(c.problem);
  EXPECT_EQ(again.evaluations, first.evaluations);
  EXPECT_EQ(again.reused, first.evaluations);
  EXPECT_EQ(again.fitted.values, first.fitted.values);
}

TEST(Problem, ChangesItsFingerprintWithWhatAnEvaluationDependsOn) {
  const SoilCalibration soil;
  const std::string target = SoilCalibration::number("ring", "low", "\"4 MPa\"", "\"0.1 MPa\"");
  const std::string first = soil.problem(target).fingerprint;
  EXPECT_EQ(soil.problem(target, "[optimiser]\nmax_evaluations = 7\n").fingerprint, first)
      << "more evaluations may be asked for";
  EXPECT_NE(soil.problem(SoilCalibration::number("ring", "low", "\"4 MPa\"", "\"0.2 MPa\"")).fingerprint,
            first);
  const Problem before = soil.problem(target);
  soil.write("materials/soil.toml", before.materials[0].text + "# the same\n");
  EXPECT_EQ(soil.problem(target).fingerprint, first) << "comments say nothing";
  std::string text = before.materials[0].text;
  soil.write("materials/soil.toml", text.replace(text.find("400 kPa^2"), 9, "500 kPa^2"));
  EXPECT_NE(soil.problem(target).fingerprint, first);
}

}  // namespace
}  // namespace tuft::studies

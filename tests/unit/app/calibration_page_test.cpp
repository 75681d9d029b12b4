// The page of a calibration from results made by hand: what is out of reach, undetermined or not from us.
#include "app/calibration_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "app/calibration_summary.h"

namespace tuft::app {
namespace {

using studies::CalibrationResult;
using studies::Problem;
using testing::HasSubstr;
using testing::Not;

/// Two parameters, of which one is not seen; a range that is far off at the start and met, a number that is
/// not.
struct Made {
  Problem problem;
  CalibrationResult result;

  Made() {
    for (const char* key : {"continuum.a", "continuum.b"}) {
      studies::Parameter p;
      p.material_name = "soil";
      p.key = key;
      p.unit = "Pa";
      p.lower = 1e6, p.upper = 3e6, p.start = 2e6;
      problem.parameters.push_back(p);
    }
    studies::Target range;
    range.model_name = "ring", range.quantity = "modulus", range.unit = "Pa";
    range.form = studies::TargetForm::range;
    range.low = 2e6, range.high = 4e6;
    range.provenance = "literature: <script>";
    studies::Target number = range;
    number.form = studies::TargetForm::number;
    number.quantity = "loss", number.unit = "1";
    number.number = 0.3, number.tolerance = 0.05;
    problem.targets = {range, number};
    problem.file.name = "soil & more";
    result.status = "completed";
    result.end_reason = "40 evaluations";
    result.start = outcome(90e6, 0.31);
    result.fitted = outcome(3e6, 0.5);
    result.fitted.values = {3e6, 2e6};
    result.at_lower = {false, false};
    result.at_upper = {true, false};
    result.search = {{5, 5, false}, {1e4, 5, true}, {2, 2, false}};
    result.failed = 1;
    result.errors = {"a stress is not met"};
    Eigen::MatrixXd s(2, 2);
    s << 3, 0, 1, 0;
    result.identifiability = studies::identify(s, 0.03);
  }
  static studies::Evaluation outcome(double modulus, double loss) {
    studies::Evaluation e;
    e.values = {2e6, 2e6};
    e.targets.resize(2);
    e.targets[0].measured = e.targets[1].measured = true;
    e.targets[0].value = modulus;
    e.targets[1].value = loss;
    return e;
  }
};

TEST(CalibrationPage, SaysWhatIsMetWhatIsNotAndWhatNoTargetSees) {
  const Made made;
  const std::string page = calibration_page(made.problem, made.result);
  EXPECT_THAT(page, HasSubstr("1 of 2 targets not met: ring.loss (0.500, wanted 0.300 ± 0.0500)"));
  EXPECT_THAT(page, HasSubstr("at its upper bound"));
  EXPECT_THAT(page, HasSubstr("no target sees it"));
  EXPECT_THAT(page, HasSubstr("a stress is not met"));
  EXPECT_THAT(page, HasSubstr("2 to 4 MPa"));
  EXPECT_THAT(page, HasSubstr("The targets do not see a change of the parameters in the proportions 1.0 b"));
  EXPECT_THAT(page, HasSubstr("literature: &lt;script&gt;"));
  EXPECT_THAT(page, HasSubstr("soil &amp; more"));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  EXPECT_THAT(page, Not(HasSubstr(">inf")));
}

TEST(CalibrationPage, OfAStoppedCalibrationHasWhatThereIs) {
  Made made;
  made.result.status = "stopped";
  made.result.identifiability.reset();
  const std::string page = calibration_page(made.problem, made.result);
  EXPECT_THAT(page, HasSubstr("Not measured: the calibration was stopped"));
  EXPECT_THAT(page, HasSubstr("</html>"));
}

TEST(TargetChart, DrawsWhatLiesFarOutsideAsAnArrowAtTheEdge) {
  const Made made;
  const std::string chart = target_chart(made.problem, made.result);
  EXPECT_THAT(chart, HasSubstr("<path class=\"mark start\""));
  EXPECT_THAT(chart, HasSubstr("<circle class=\"mark met\" cx=\"560.0\"")) << "the middle of the range";
  EXPECT_THAT(chart, HasSubstr("mark missed"));
}

TEST(CalibrationJson, HasNullWhereNothingIsKnown) {
  const Made made;
  const std::string json = calibration_json(made.problem, made.result);
  EXPECT_THAT(json, HasSubstr("\"change_for_one_tolerance_alone\": null"));
  EXPECT_THAT(json, HasSubstr("\"at_upper_bound\": true"));
  EXPECT_THAT(json, Not(HasSubstr("NaN")));
}

TEST(ShortNames, AreWholeWhereTheirEndsAreTheSame) {
  Made made;
  EXPECT_EQ(short_names(made.problem), (std::vector<std::string>{"a", "b"}));
  made.problem.parameters[1].key = "grain.a";
  EXPECT_EQ(short_names(made.problem), (std::vector<std::string>{"soil.continuum.a", "soil.grain.a"}));
}

}  // namespace
}  // namespace tuft::app

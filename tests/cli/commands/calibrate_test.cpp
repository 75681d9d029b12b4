/// Calibrations as a user gives them.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/commands/command.h"

namespace tuft::test {
namespace {

const std::string head = R"toml([optimiser]
max_evaluations = 60

[[parameters]]
material = "sand_calibrated"
key = "continuum.pressure_exponential.modulus"
lower = "5 MPa"
upper = "20 MPa"
start = "10 MPa"
scale = "log"

[[parameters]]
material = "sand_calibrated"
key = "continuum.yield_a2"
lower = 0.05
upper = 1.0
start = 0.2

[[models]]
name = "ring"
file = "ring.toml"
set = ["point.step=1e-3"]

)toml",
                  target = R"toml([[targets]]
model = "ring"
quantity = "modulus"
range = ["30 MPa", "40 MPa"]
provenance = "literature: somewhere"
)toml",
                  ring = R"toml([point]
material = "sand_calibrated"

[[segments]]
path = "oedometric"
stress = "300 kPa"

[[measures]]
name = "modulus"
segment = 1
between = ["100 kPa", "200 kPa"]
)toml";

/// A calibration beside its model.
void lay_out(const Workplace& place, const std::string& text = head + target) {
  place.write("ring.toml", ring);
  place.write("c.toml", text);
}

std::size_t lines_of(const std::string& file) {
  const std::string text = read_text(file);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(Calibrate, LeavesFittedMaterialsSummaryTableAndPage) {
  const Workplace place;
  lay_out(place);
  const Outcome outcome = run_tuft({"calibrate", place.path("c.toml"), "--out", place.path("out")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("the target is met"), std::string::npos) << outcome.out;
  const auto json = nlohmann::json::parse(read_text(place.path("out/calibration.json")));
  EXPECT_EQ(json["status"], "completed");
  EXPECT_EQ(json["parameters"][0]["start"], 10e6);
  EXPECT_FALSE(json["parameters"][0]["at_upper_bound"]);
  EXPECT_FALSE(json["targets"][0]["start"]["inside"]);
  EXPECT_TRUE(json["targets"][0]["fitted"]["inside"]);
  EXPECT_GT(json["misfit"]["start"], json["misfit"]["fitted"]);
  EXPECT_EQ(json["evaluations_failed"], 0);
  EXPECT_GT(json["seconds_per_model"]["ring"]["seconds"], 0);
  EXPECT_EQ(lines_of(place.path("out/evaluations.csv")), json["evaluations"].get<std::size_t>() + 1);
  const std::string page = read_text(place.path("out/report.html"));
  for (const char* part : {"target-chart", "search-plot", "sensitivity-table", "correlation-table",
                           "cost-table", "literature: somewhere", "</html>"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_EQ(page.find("nan"), std::string::npos);

  // The fitted file is an input like any other.
  const std::string fitted = read_text(place.path("out/materials/sand_calibrated.toml"));
  EXPECT_NE(fitted.find("# calibrated: tuft calibrate " + place.path("c.toml")), std::string::npos);
  place.write("materials/sand_calibrated.toml", fitted);
  const Outcome point =
      run_tuft({"point", place.path("ring.toml"), "--set", "point.step=1e-3", "--out", place.path("point")});
  ASSERT_EQ(point.exit_code, 0) << point.error;
  const auto summary = nlohmann::json::parse(read_text(place.path("point/summary.json")));
  EXPECT_EQ(summary["results"]["modulus"]["value"], json["targets"][0]["fitted"]["value"]);
}

TEST(Calibrate, IntoItsOwnFolderAgainTakesWhatIsThere) {
  const Workplace place;
  lay_out(place);
  const std::vector<std::string> words{"calibrate",       place.path("c.toml"), "--out",
                                       place.path("out"), "--threads",          "1"};
  ASSERT_EQ(run_tuft(words).exit_code, 0);
  const std::string table = read_text(place.path("out/evaluations.csv")),
                    material = read_text(place.path("out/materials/sand_calibrated.toml"));
  const Outcome again = run_tuft(words);
  ASSERT_EQ(again.exit_code, 0) << again.error;
  EXPECT_NE(again.out.find("evaluations of an earlier run are taken as they are"), std::string::npos);
  EXPECT_EQ(read_text(place.path("out/evaluations.csv")), table);
  EXPECT_EQ(read_text(place.path("out/materials/sand_calibrated.toml")), material);
}

TEST(Calibrate, IsNotWrittenOverAnotherCalibrationOrARun) {
  const Workplace place;
  lay_out(place);
  ASSERT_EQ(run_tuft({"calibrate", place.path("c.toml"), "--out", place.path("out")}).exit_code, 0);
  std::string other = head + target;
  other.replace(other.find("40 MPa"), 6, "50 MPa");
  place.write("c.toml", other);
  expect_bad_input(run_tuft({"calibrate", place.path("c.toml"), "--out", place.path("out")}),
                   {"out", "holds another calibration", "choose another --out"});
  place.write("run/summary.json", "{}");
  expect_bad_input(run_tuft({"calibrate", place.path("c.toml"), "--out", place.path("run")}),
                   {"already holds a run"});
}

TEST(Calibrate, InterruptedWritesTheBestSoFarAndGoesOnByTheSameCommand) {
  const Workplace place;
  // At random over the whole box, in steps so short that it takes many times as long as one waits.
  std::string text = head + target;
  text.replace(text.find("max_evaluations = 60"), 20,
               "algorithm = \"crs2\"\nmax_evaluations = 1000000\nglobal_share = 0.9");
  std::string model = ring;
  lay_out(place, text.replace(text.find("point.step=1e-3"), 15, "point.step=3e-8"));
  const Outcome outcome = run_tuft({"calibrate", place.path("c.toml"), "--out", place.path("out")}, {2.0, 0});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.error;
  EXPECT_NE(outcome.out.find("stopped; the best so far is written"), std::string::npos) << outcome.out;
  const auto json = nlohmann::json::parse(read_text(place.path("out/calibration.json")));
  EXPECT_EQ(json["status"], "stopped");
  EXPECT_NE(read_text(place.path("out/materials/sand_calibrated.toml")).find("# calibrated"),
            std::string::npos);
  EXPECT_EQ(read_text(place.path("out/report.html")).find("nan"), std::string::npos);
  EXPECT_GE(lines_of(place.path("out/evaluations.csv")), 2U);
}

TEST(Calibrate, OfABadFileIsRefusedWithLineKeyAndWhatToDo) {
  const Workplace place;
  const auto said = [&](const std::string& from, const std::string& to,
                        const std::vector<std::string>& parts) {
    std::string text = head + target;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    lay_out(place, text.replace(at, from.size(), to));
    expect_bad_input(run_tuft({"calibrate", place.path("c.toml"), "--out", place.path("out")}), parts);
  };
  said("[optimiser]", "[optimizer]", {"c.toml:1", "optimizer", "did you mean \"optimiser\""});
  said("max_evaluations = 60", "algorithm = \"bobyka\"", {"c.toml:2", "did you mean \"bobyqa\""});
  said("\"sand_calibrated\"", "\"sand_calibratd\"", {"c.toml:5", "did you mean \"sand_calibrated\""});
  said("exponential.modulus", "exponential.modulos",
       {"c.toml:6", "parameters.0.key", "did you mean \"continuum.pressure_exponential.modulus\""});
  said("continuum.yield_a2", "continuum.dilation_angle", {"c.toml:14", "is no single number written in"});
  said("\"5 MPa\"", "5", {"c.toml:7", "parameters.0.lower", "with its unit"});
  said("\"5 MPa\"", "\"5 mm\"", {"c.toml:7", "parameters.0.lower", "is not the unit"});
  said("\"5 MPa\"", "\"25 MPa\"", {"c.toml:8", "parameters.0.upper", "must be above lower"});
  said("\"5 MPa\"", "\"0 MPa\"", {"c.toml:7", "out of the range"});
  said("lower = 0.05", "lower = 0.0\nscale = \"log\"", {"parameters.1.scale", "above 0"});
  said("start = 0.2", "start = 2", {"c.toml:17", "between lower and upper"});
  said("ring.toml", "rang.toml", {"c.toml:21", "models.0.file", "no such file"});
  said("point.step=1e-3", "point.step", {"c.toml:22", "key=value"});
  said("point.step=1e-3", "point.stop=1e-3", {"--set", "point.stop", "unknown key", "\"step\""});
  said("model = \"ring\"", "model = \"rung\"", {"c.toml:25", "did you mean \"ring\""});
  said("\"modulus\"", "\"modulos\"", {"c.toml:26", "targets.0.quantity", "did you mean \"modulus\""});
  said("[\"30 MPa\", \"40 MPa\"]", "[\"30 MPa\"]", {"c.toml:27", "two values are needed"});
  said("[\"30 MPa\", \"40 MPa\"]", "[\"40 MPa\", \"30 MPa\"]",
       {"c.toml:27", "the smaller value comes first"});
  said("[\"30 MPa\", \"40 MPa\"]", "[\"30 kg\", \"40 kg\"]", {"c.toml:27", "targets.0.range.0", "30 kg"});
  said("range =", "tolerance = \"1 MPa\"\nrange =", {"targets.0.tolerance", "is for a number"});
  said("range = [\"30 MPa\", \"40 MPa\"]", "number = \"30 MPa\"", {"targets.0.number", "needs a tolerance"});
  said("range = [\"30 MPa\", \"40 MPa\"]", "", {"targets.0", "give one of number"});
  said("provenance = \"literature: somewhere\"", "", {"targets.0.provenance", "missing"});
  said("literature: somewhere", "literature", {"c.toml:28", "begin with one of published, literature"});
  said("literature: somewhere", "hearsay: somewhere", {"begin with one of published, literature"});
  expect_bad_input(run_tuft({"calibrate", place.path("gone.toml")}), {"gone.toml", "cannot be read"});
}

TEST(Calibrate, OfABadCurveIsRefusedWithItsPlace) {
  const Workplace place;
  place.write("good.csv", "strain,stress\n1,100\n2,200\n");
  place.write("bad.csv", "strain,stress\n1,100\n2,two\n");
  const auto said = [&](const std::string& curve, const std::vector<std::string>& parts) {
    lay_out(place,
            head +
                "[[targets]]\nmodel = \"ring\"\nquantity = \"segment_1_stress\"\nprovenance = \"measured: "
                "here\"\n[targets.curve]\n" +
                curve);
    expect_bad_input(run_tuft({"calibrate", place.path("c.toml"), "--out", place.path("out")}), parts);
  };
  const std::string units = "x_unit = \"%\"\ny_unit = \"kPa\"\n";
  said(units + "file = \"gone.csv\"\n", {"targets.0.curve.file", "no such file"});
  said(units + "file = \"bad.csv\"\n", {"bad.csv:3", "\"two\"", "a number is needed"});
  said(units + "file = \"good.csv\"\ny_column = \"stres\"\n", {"y_column", "did you mean \"stress\""});
  said(units + "file = \"good.csv\"\nx = [1]\n", {"targets.0.curve", "give either file, or x and y"});
  said(units + "x = [1, 2]\ny = [1]\n", {"targets.0.curve.y", "1 numbers, but x has 2"});
  said("x = [1, 2]\ny = [1, 2]\ny_unit = \"mm\"\n", {"targets.0.curve.y_unit", "mm"});
}

TEST(Calibrate, OfARigThatTestsNoInfillAloneIsRefused) {
  const Workplace place;
  std::string text = head + target;
  text.replace(text.find("ring.toml\"\nset = [\"point.step=1e-3\"]"), 37, "drop.toml\"");
  lay_out(place, text);
  place.write("drop.toml", read_text("inputs/clegg_small.toml"));
  expect_bad_input(run_tuft({"calibrate", place.path("c.toml"), "--out", place.path("out")}),
                   {"rig.type", "oedometer and direct_shear"});
}

TEST(Calibrate, IsListedByHelp) {
  EXPECT_NE(run_tuft({"--help"}).out.find("calibrate"), std::string::npos);
  const Outcome help = run_tuft({"calibrate", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* option : {"CALIBRATION", "--out", "--threads"})
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
}

}  // namespace
}  // namespace tuft::test

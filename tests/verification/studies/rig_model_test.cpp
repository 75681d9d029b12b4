// Rigs as models: what they give without a folder is what a run gives.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/scene_reader.h"
#include "rigs/run.h"
#include "rigs/run_folder.h"
#include "studies/calibrate.h"
#include "unit/core/scratch_folder.h"

namespace tuft::studies {
namespace {

Overrides ring() {
  return {{"rig.diameter", "16 mm"},
          {"rig.height", "8 mm"},
          {"infill.sph.pitch", "2 mm"},
          {"rig.preloads", "[\"10 N\", \"20 N\"]"},
          {"rig.seating_force", "2 N"},
          {"rig.cycles", "1"},
          {"rig.speed_factor", "500.0"},
          {"rig.sample_travel", "20 um"},
          {"numerics.contact_pressure", "100 kPa"}};
}

Overrides box() {
  return {{"rig.size", "[\"12 mm\", \"12 mm\"]"}, {"rig.height", "10 mm"},
          {"infill.sph.pitch", "2.4 mm"},         {"rig.normal_stresses", "[\"50 kPa\", \"100 kPa\"]"},
          {"rig.yield_strain", "0.02"},           {"rig.load_time", "2 ms"},
          {"rig.sample_travel", "10 um"},         {"numerics.contact_pressure", "100 kPa"}};
}

std::string write_rig_scene() {
  return "[rig]\ntype = 'oedometer'\nmaterial = 'sbr_calibrated'\nwall_friction = 0.0\n";
}

void expect_as_run(const std::string& scene, const Overrides& overrides) {
  const tuft::test::ScratchFolder folder;
  rigs::RunRequest request;
  request.scene = read_scene(scene, overrides);
  request.folder = folder / "run";
  rigs::prepare_run_folder(request.folder, request.scene);
  const rigs::RunSummary run = rigs::run(request);
  ASSERT_EQ(run.status, "completed") << run.error;

  const auto model = make_calibration_model(scene, overrides, {});
  EXPECT_EQ(model->kind(), request.scene.rig.type);
  const ModelOutcome outcome = model->prepare({})(nullptr);
  EXPECT_EQ(outcome.error, "");
  ASSERT_EQ(outcome.results.size(), run.results.size());
  const auto units = model->result_units();
  for (const auto& [name, quantity] : run.results) {
    EXPECT_EQ(outcome.results.at(name), quantity.value) << name;
    ASSERT_TRUE(units.contains(name)) << name;
    EXPECT_EQ(units.at(name), quantity.unit) << name;
  }
  const auto names = model->curve_names();
  ASSERT_EQ(outcome.curves.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(outcome.curves[i].name, names[i].name);
    EXPECT_GT(outcome.curves[i].x.size(), 2U) << names[i].name;
    EXPECT_EQ(outcome.curves[i].x.size(), outcome.curves[i].y.size());
  }
}

TEST(RigModel, OfAnOedometerGivesWhatItsRunGives) {
  expect_as_run("inputs/oedometer_sbr.toml", ring());
}

TEST(RigModel, OfAShearBoxGivesWhatItsRunGives) {
  expect_as_run("inputs/direct_shear_sbr.toml", box());
}

TEST(RigModel, IsFittedLikeAPoint) {
  const tuft::test::ScratchFolder folder;
  std::ofstream(folder / "ring.toml") << write_rig_scene();
  std::string settings;
  for (const auto& [key, value] : ring()) settings += fmt::format("'{}={}', ", key, value);
  const double modulus = 0.52e6;
  const auto calibration = [&](double target) {
    std::ofstream(folder / "c.toml") << fmt::format(
        "[calibration]\nregularisation = 0.0\n[optimiser]\ntolerance = 1e-3\nmax_evaluations = "
        "25\n[[parameters]]\n"
        "material = 'sbr_calibrated'\nkey = 'continuum.pressure_exponential.modulus'\nlower = '0.4 "
        "MPa'\nupper = "
        "'0.7 MPa'\nstart = '0.43 MPa'\n[[models]]\nname = 'ring'\nfile = 'ring.toml'\nset = "
        "[{}'rig.preloads=[\"10 "
        "N\"]']\n[[targets]]\nmodel = 'ring'\nquantity = 'preload_10_cycle_1_loading_modulus'\nnumber = '{} "
        "Pa'\n"
        "tolerance = '10 kPa'\nprovenance = 'derived: by the same rig'\n",
        settings, target);
    return make_problem(read_calibration(folder / "c.toml"));
  };
  const double made = evaluate(calibration(1e6), {{modulus}}, nullptr).front().targets[0].value;
  const Problem problem = calibration(made);
  EvaluationLog log(folder / "e.csv", problem);
  CalibrationRequest request;
  request.problem = &problem;
  request.log = &log;
  const CalibrationResult result = calibrate(request);
  // A rig's curve answers a millionth of the parameter with up to 0.3 % of the modulus.
  EXPECT_NEAR(result.fitted.values[0] / modulus, 1, 0.015);
  EXPECT_TRUE(is_inside(problem.targets[0], result.fitted.targets[0]));
}

TEST(RigModel, IsStoppedInTheMiddleWithoutAnEvaluation) {
  const auto model = make_calibration_model("inputs/oedometer_sbr.toml", ring(), {});
  const std::atomic<bool> stop{true};
  EXPECT_TRUE(model->prepare({})(&stop).stopped);
}

}  // namespace
}  // namespace tuft::studies

/// Oedometer, direct shear and pull-out through the command line, as small as they can be.
#include <nlohmann/json.hpp>

#include "cli/commands/command.h"

namespace tuft::test {
namespace {

std::vector<std::string> tiny_ring(const std::string& folder) {
  return {"run",   "inputs/oedometer_sbr.toml", "--out", folder,
          "--set", "rig.diameter=16 mm",        "--set", "rig.height=8 mm",
          "--set", "infill.sph.pitch=2 mm",     "--set", "rig.preloads=[\"10 N\"]",
          "--set", "rig.seating_force=2 N",     "--set", "rig.cycles=1",
          "--set", "rig.speed_factor=500.0",    "--set", "rig.sample_travel=20 um",
          "--set", "rig.checkpoint_rows=10",    "--set", "numerics.contact_pressure=100 kPa"};
}

std::vector<std::string> tiny_box(const std::string& folder) {
  return {
      "run",   "inputs/direct_shear_sbr.toml",    "--out", folder,
      "--set", "rig.size=[\"12 mm\", \"12 mm\"]", "--set", "rig.height=10 mm",
      "--set", "infill.sph.pitch=2.4 mm",         "--set", "rig.normal_stresses=[\"50 kPa\", \"100 kPa\"]",
      "--set", "rig.yield_strain=0.02",           "--set", "rig.load_time=2 ms",
      "--set", "rig.sample_travel=10 um",         "--set", "numerics.contact_pressure=100 kPa"};
}

nlohmann::json summary_in(const std::string& folder) {
  return nlohmann::json::parse(read_text(folder + "/summary.json"));
}

TEST(Specimen, OedometerLeavesItsFilesAndCanBeStoppedAndResumed) {
  const Workplace place;
  auto words = tiny_ring(place.path("run"));
  words.insert(words.end(), {"--stop-after-checkpoints", "1"});
  const Outcome stopped = run_tuft(words);
  ASSERT_EQ(stopped.exit_code, 0) << stopped.error;
  EXPECT_EQ(summary_in(place.path("run"))["status"], "stopped");
  const Outcome resumed = run_tuft({"resume", place.path("run")});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.error;
  for (const char* name :
       {"scene.toml", "summary.json", "run.h5", "run.xdmf", "checkpoint.h5", "log.txt", "report.html"})
    EXPECT_TRUE(std::filesystem::exists(place.path(std::string("run/") + name))) << name;
  const nlohmann::json summary = summary_in(place.path("run"));
  EXPECT_EQ(summary["status"], "completed");
  EXPECT_EQ(summary["results"]["preload_10_cycle_1_loading_modulus"]["unit"], "Pa");
  EXPECT_GT(summary["results"]["preload_10_cycle_1_loss"]["value"], 0.0);
  const std::string page = read_text(place.path("run/report.html"));
  for (const char* id : {"oedometer-table", "curve-stress-strain", "curve-force", "energy-error"})
    EXPECT_NE(page.find(std::string("id=\"") + id), std::string::npos) << id;
  EXPECT_EQ(page.find("Not recorded"), std::string::npos);
}

TEST(Specimen, DirectShearGivesALineThroughItsYields) {
  const Workplace place;
  const Outcome outcome = run_tuft(tiny_box(place.path("run")));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json summary = summary_in(place.path("run"));
  EXPECT_EQ(summary["results"]["cohesion"]["unit"], "Pa");
  EXPECT_EQ(summary["results"]["friction_angle"]["unit"], "deg");
  EXPECT_LT(summary["energy_error"], 1e-3);
  const std::string page = read_text(place.path("run/report.html"));
  for (const char* id : {"shear-table", "line-table", "curve-shear", "curve-mohr-coulomb", "curve-height"})
    EXPECT_NE(page.find(std::string("id=\"") + id), std::string::npos) << id;
  EXPECT_EQ(page.find("Not recorded"), std::string::npos);
}

TEST(Specimen, OfBothInfillsSideBySideGivesOnePageThatTellsThemApart) {
  const Workplace place;
  auto words = tiny_ring(place.path("both"));
  words[0] = "compare";
  words.insert(words.end(), {"--set", "infill.dem.material_coarse_graining.sbr=2.5"});
  const Outcome outcome = run_tuft(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* approach : {"sph", "dem"}) {
    const nlohmann::json summary = summary_in(place.path(std::string("both/") + approach));
    EXPECT_EQ(summary["approach"], approach);
    EXPECT_GT(summary["results"]["preload_10_cycle_1_loading_modulus"]["value"], 0.0);
    EXPECT_LT(summary["energy_error"], 1e-3);
  }
  const std::string page = read_text(place.path("both/report.html"));
  for (const char* label : {"sbr · SPH, 10 N", "sbr · DEM, 10 N"})
    EXPECT_NE(page.find(label), std::string::npos) << label;
}

TEST(Specimen, OfGrainsThatHadNotComeToRestSaysSoOnce) {
  const Workplace place;
  auto words = tiny_ring(place.path("run"));
  words.insert(words.end(),
               {"--infill", "dem", "--set", "infill.dem.material_coarse_graining.sbr=2.5", "--set",
                "infill.dem.use_cache=false", "--set", "infill.dem.settle_time=1 ms", "--set",
                "infill.dem.settle_time_limit=1 ms", "--set", "rig.preloads=[\"5 N\", \"10 N\"]"});
  const Outcome outcome = run_tuft(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json summary = summary_in(place.path("run"));
  int said = 0;
  for (const auto& remark : summary["remarks"])
    said += remark.get<std::string>().find("not at rest after 1 ms of packing") != std::string::npos;
  EXPECT_EQ(said, 1);
}

TEST(Specimen, PullOutComparesBothInfillsAndRecordsEveryContact) {
  const Workplace place;
  const Outcome outcome = run_tuft({"compare", "inputs/pull_out_sbr.toml",
                                    "--out",   place.path("both"),
                                    "--set",   "rig.size=[\"12 mm\", \"8 mm\"]",
                                    "--set",   "rig.height=10 mm",
                                    "--set",   "rig.embedded_length=10 mm",
                                    "--set",   "rig.normal_stress=20 kPa",
                                    "--set",   "rig.speeds=[\"1 mm/s\"]",
                                    "--set",   "rig.run_speed=400 mm/s",
                                    "--set",   "rig.travel=1 mm",
                                    "--set",   "rig.load_time=2 ms",
                                    "--set",   "infill.sph.pitch=2 mm",
                                    "--set",   "infill.dem.material_coarse_graining.sbr=1.5",
                                    "--set",   "rig.frame_rows=100",
                                    "--set",   "output.micro.contacts=true"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* approach : {"sph", "dem"}) {
    const nlohmann::json summary = summary_in(place.path(std::string("both/") + approach));
    EXPECT_EQ(summary["results"]["speed_1_mm_s_steady_force"]["unit"], "N");
    EXPECT_GT(summary["results"]["speed_1_mm_s_peak_force"]["value"], 0.0);
    EXPECT_GT(summary["shells"], 0);
    EXPECT_LT(summary["energy_error"], 0.01);
  }
  const std::string page = read_text(place.path("both/report.html"));
  for (const char* id : {"pull-out-table", "curve-pull", "curve-strand-pressure", "curve-platens"})
    EXPECT_NE(page.find(std::string("id=\"") + id), std::string::npos) << id;
  const Outcome micro = run_tuft({"micro", place.path("both/dem")});
  EXPECT_EQ(micro.exit_code, 0) << micro.error;
  EXPECT_NE(micro.out.find("contacts_fibre"), std::string::npos);
}

TEST(Specimen, IsCheckedAndExplainedWithoutAPatch) {
  const Outcome checked = run_tuft({"check", "inputs/oedometer_sbr.toml"});
  EXPECT_EQ(checked.exit_code, 0) << checked.error;
  EXPECT_NE(checked.out.find("2 382 particles"), std::string::npos) << checked.out;
  const Outcome explained = run_tuft({"explain", "inputs/direct_shear_sbr.toml"});
  EXPECT_EQ(explained.exit_code, 0) << explained.error;
  EXPECT_NE(explained.out.find("300 kPa"), std::string::npos) << explained.out;
  EXPECT_EQ(explained.out.find("fibres"), std::string::npos) << "no effect of a carpet";
}

TEST(Specimen, RefusesBadInputByOneLine) {
  const auto with = [](const char* scene, const std::string& set) {
    return run_tuft({"check", std::string("inputs/") + scene, "--set", set});
  };
  const Outcome too_coarse =
      run_tuft({"check", "inputs/oedometer_sbr.toml", "--infill", "dem", "--set",
                "infill.dem.material_coarse_graining.sbr=30", "--set", "infill.dem.use_cache=false"});
  expect_bad_input(too_coarse, {"grains of sbr are up to 0.06 m wide", "less coarse graining"});
  expect_bad_input(with("oedometer_sand.toml", "rig.material=snad"),
                   {"rig.material", "did you mean \"sand\""});
  expect_bad_input(with("oedometer_sand.toml", "rig.normal_stresses=[\"1 kPa\"]"), {"normal_stresses"});
  expect_bad_input(with("oedometer_sand.toml", "rig.seating_force=800 N"),
                   {"rig.preloads", "more than twice rig.seating_force (800 N)"});
  expect_bad_input(with("oedometer_sand.toml", "rig.preloads=[\"100 N\", \"100 N\"]"), {"given twice"});
  expect_bad_input(with("oedometer_sand.toml", "infill.sph.pitch=6 mm"),
                   {"infill.sph.pitch", "make it 3.17 mm or less"});
  expect_bad_input(with("oedometer_sand.toml", "rig.sample_travel=1 mm"), {"rig.sample_travel", "hundredth"});
  expect_bad_input(with("direct_shear_sand.toml", "turf.tray_depth=70 mm"), {"turf"});
  expect_bad_input(with("direct_shear_sand.toml", "effects.fibres=true"), {"effects.fibres", "no carpet"});
  expect_bad_input(with("direct_shear_sand.toml", "rig.yield_strain=0.6"), {"rig.yield_strain"});
  expect_bad_input(with("pull_out_sand.toml", "rig.embedded_length=40 mm"),
                   {"rig.embedded_length", "more than the box is long (30 mm)"});
  expect_bad_input(with("pull_out_sand.toml", "output.frames=1 ms"), {"output.frames"});
}

}  // namespace
}  // namespace tuft::test

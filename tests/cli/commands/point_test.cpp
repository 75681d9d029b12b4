/// Tests of a material point, as a user gives them.
#include <nlohmann/json.hpp>

#include "cli/commands/command.h"

namespace tuft::test {
namespace {

const std::string good = R"toml([point]
material = "mixture"
step = 1e-3
samples = 20

[[segments]]
path = "oedometric"
stress = "300 kPa"

[[segments]]
path = "triaxial"
strain = 0.02

[[segments]]
path = "velocity_gradient"
velocity_gradient = ["0 Hz", "2 Hz", "0 Hz", "0 Hz", "0 Hz", "0 Hz", "0 Hz", "0 Hz", "0 Hz"]
duration = "20 ms"
)toml";

TEST(Point, OfEachMaterialRunsAndLeavesTableSummaryAndPage) {
  for (const std::string name : {"sand", "mixture", "sbr"}) {
    const Workplace place;
    const Outcome outcome = run_tuft(
        {"point", "inputs/point_" + name + ".toml", "--set", "point.step=1e-3", "--out", place.path("out")});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto summary = nlohmann::json::parse(read_text(place.path("out/summary.json")));
    EXPECT_EQ(summary["status"], "completed");
    EXPECT_EQ(summary["material"], name);
    EXPECT_TRUE(summary["effects"]["density_hardening"]["on"]);
    EXPECT_TRUE(summary["effects"]["shear_energy"]["on"]);
    EXPECT_LT(summary["energy_error"], 0.02);
    EXPECT_NEAR(summary["results"]["segment_1_axial_stress"]["value"], 667e3, 1);
    EXPECT_NEAR(summary["results"]["segment_3_axial_stress"]["value"], 813e3, 1);
    EXPECT_EQ(summary["results"]["segment_7_pressure"]["value"], -20e3) << "at the tension cutoff";
    const std::string page = read_text(place.path("out/report.html"));
    for (const char* part : {"curve-compression", "curve-yield", "curve-shear", "</html>"})
      EXPECT_NE(page.find(part), std::string::npos) << part;
    EXPECT_EQ(page.find("nan"), std::string::npos);
  }
}

TEST(Point, AsResolvedGivesTheSameTable) {
  const Workplace place;
  place.write("a.toml", good);
  ASSERT_EQ(run_tuft({"point", place.path("a.toml"), "--out", place.path("one")}).exit_code, 0);
  const Outcome again = run_tuft({"point", place.path("one/point.toml"), "--out", place.path("two")});
  ASSERT_EQ(again.exit_code, 0) << again.error;
  EXPECT_EQ(read_text(place.path("one/path.csv")), read_text(place.path("two/path.csv")));
}

TEST(Point, OfABadFileIsRefusedWithLineKeyAndWhatToDo) {
  const Workplace place;
  const auto said = [&](const std::string& from, const std::string& to,
                        const std::vector<std::string>& parts) {
    std::string text = good;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    place.write("bad.toml", text.replace(at, from.size(), to));
    expect_bad_input(run_tuft({"point", place.path("bad.toml"), "--out", place.path("out")}), parts);
  };
  said("samples = 20", "sample = 20", {"bad.toml:4", "point.sample", "unknown key", "\"samples\""});
  said("\"300 kPa\"", "\"300 kg\"", {"bad.toml:8", "segments.0.stress", "300 kg"});
  said("\"300 kPa\"", "300", {"bad.toml:8", "segments.0.stress", "with its unit"});
  said("\"triaxial\"", "\"triaxail\"", {"bad.toml:11", "did you mean \"triaxial\""});
  said("\"mixture\"", "\"mixtrue\"", {"bad.toml:2", "did you mean \"mixture\""});
  said("strain = 0.02", "", {"bad.toml:10", "segments.1", "give one of strain and stress"});
  said("strain = 0.02", "strain = 0.02\nstress = \"1 kPa\"", {"segments.1", "give one of strain and stress"});
  said("strain = 0.02", "duration = \"1 s\"", {"bad.toml:12", "velocity_gradient"});
  said("\"0 Hz\"]", "\"0 Hz\", \"0 Hz\"]", {"segments.2.velocity_gradient", "there are 10"});
  said("[point]", "[effects]\ndilation = true\n[point]", {"effects.dilation", "dilation_angle"});
  said("[point]", "[effects]\nfibres = true\n[point]", {"effects.fibres", "unknown key"});
  said("[point]",
       "[materials.mixture.continuum]\nmohr_coulomb = { cohesion = \"5 kPa\", friction_angle = \"30 degree\" "
       "}\n[point]",
       {"mohr_coulomb", "strength is given twice"});
  expect_bad_input(run_tuft({"point", place.path("gone.toml")}), {"gone.toml", "cannot be read"});
}

TEST(Point, WhoseStressIsNotMetFailsByNameAndLeavesWhatItReached) {
  const Workplace place;
  std::string text = good;
  text.replace(text.find("strain = 0.02"), 13, "stress = \"900 MPa\"");
  place.write("far.toml", text);
  expect_failed_run(run_tuft({"point", place.path("far.toml"), "--set", "point.strain_limit=0.1", "--out",
                              place.path("out")}),
                    {"segments.1 (triaxial)", "9e+08 Pa is not met", "strain_limit"});
  const auto summary = nlohmann::json::parse(read_text(place.path("out/summary.json")));
  EXPECT_EQ(summary["status"], "failed");
  EXPECT_NE(read_text(place.path("out/path.csv")).find("\n2,"), std::string::npos);
}

TEST(Point, IsNotWrittenOverARun) {
  const Workplace place;
  place.write("out/summary.json", "{}");
  place.write("a.toml", good);
  expect_bad_input(run_tuft({"point", place.path("a.toml"), "--out", place.path("out")}), {"out"});
}

}  // namespace
}  // namespace tuft::test

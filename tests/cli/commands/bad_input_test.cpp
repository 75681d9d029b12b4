/// Words on the command line and scenes that cannot be read.
#include "cli/commands/command.h"

namespace tuft::test {
namespace {

TEST(CommandLine, NamesTheNearestVerbForAnUnknownOne) {
  expect_bad_input(run_tuft({"rnu", "scene.toml"}), {"unknown verb 'rnu'", "did you mean 'run'"});
}

TEST(CommandLine, ListsTheVerbsWhereNoneIsNear) {
  expect_bad_input(run_tuft({"frobnicate"}), {"unknown verb 'frobnicate'", "run, resume, check"});
}

TEST(CommandLine, AsksForAVerb) {
  expect_bad_input(run_tuft({}), {"no verb given"});
}

TEST(CommandLine, NamesTheNearestOptionForAnUnknownOne) {
  expect_bad_input(run_tuft({"run", "inputs/clegg_small.toml", "--thread", "2"}),
                   {"unknown option '--thread'", "did you mean '--threads'"});
}

TEST(CommandLine, RefusesAnArgumentTooMany) {
  expect_bad_input(run_tuft({"check", "inputs/clegg_small.toml", "surplus"}),
                   {"unexpected argument 'surplus'"});
}

TEST(CommandLine, AsksForTheScene) {
  expect_bad_input(run_tuft({"run"}), {"SCENE"});
}

TEST(CommandLine, RefusesAnUnknownApproachAndNamesThePossibleOnes) {
  expect_bad_input(run_tuft({"run", "inputs/clegg_small.toml", "--infill", "mpm"}), {"mpm", "sph", "dem"});
}

TEST(CommandLine, RefusesThreadsThatAreNoCount) {
  expect_bad_input(run_tuft({"run", "inputs/clegg_small.toml", "--threads", "-1"}), {"--threads"});
  expect_bad_input(run_tuft({"run", "inputs/clegg_small.toml", "--threads", "many"}), {"--threads"});
}

TEST(CommandLine, GivesHelpForEveryVerb) {
  EXPECT_EQ(run_tuft({"--help"}).exit_code, 0);
  for (const char* verb :
       {"run", "resume", "check", "explain", "carpet", "compare", "point", "report", "show"}) {
    const Outcome outcome = run_tuft({verb, "--help"});
    EXPECT_EQ(outcome.exit_code, 0) << verb;
    EXPECT_NE(outcome.out.find("Usage"), std::string::npos) << verb;
    EXPECT_TRUE(outcome.error.empty()) << outcome.error;
  }
}

TEST(Scene, ThatDoesNotExistIsNamed) {
  for (const char* verb : {"run", "check", "explain", "carpet", "compare"})
    expect_bad_input(run_tuft({verb, "no/such/scene.toml"}), {"no/such/scene.toml"});
}

TEST(Scene, ThatIsAFolderIsRefused) {
  expect_bad_input(run_tuft({"check", "inputs"}), {"inputs"});
}

TEST(Scene, ThatIsNotTomlIsNamedWithItsLine) {
  const Workplace place;
  place.write("bad.toml", "[scene]\nname = \"x\"\nthis is not toml\n");
  expect_bad_input(run_tuft({"check", place.path("bad.toml")}), {"bad.toml:3"});
}

TEST(Scene, ThatIsBinaryIsRefused) {
  const Workplace place;
  place.write("bad.toml", std::string("\x00\xff\xfe\x01garbage", 11));
  expect_bad_input(run_tuft({"check", place.path("bad.toml")}), {"bad.toml"});
}

TEST(Set, OfAKeyThatDoesNotExistNamesTheNearest) {
  expect_bad_input(run_tuft({"check", "inputs/clegg_small.toml", "--set", "numerics.sed=2"}),
                   {"numerics.sed", "seed"});
}

TEST(Set, WithoutAnEqualsSignIsRefused) {
  expect_bad_input(run_tuft({"check", "inputs/clegg_small.toml", "--set", "numerics.seed"}),
                   {"--set numerics.seed", "key=value"});
}

TEST(Set, OfAWrongUnitIsRefused) {
  expect_bad_input(run_tuft({"check", "inputs/clegg_small.toml", "--set", "infill.sph.pitch=2 kg"}),
                   {"pitch", "2 kg"});
}

TEST(Set, DoesNotSwallowTheSceneBehindIt) {
  expect_bad_input(run_tuft({"check", "--set", "numerics.seed=2", "no/such/scene.toml"}),
                   {"no/such/scene.toml"});
}

TEST(Show, OfAFolderWithoutARunIsRefused) {
  const Workplace place;
  expect_bad_input(run_tuft({"show", place.path("")}), {"no summary.json"});
  expect_bad_input(run_tuft({"show", place.path("missing")}), {"missing", "no summary.json"});
}

TEST(Report, OfAFolderWithoutARunIsRefused) {
  const Workplace place;
  expect_bad_input(run_tuft({"report", place.path("")}), {"no summary.json"});
}

TEST(BadInput, OfATensionRigIsNamedInOneLine) {
  const std::string scene = "inputs/strand_tension.toml";
  expect_bad_input(run_tuft({"check", scene, "--set", "rig.gauge=40 mm"}), {"rig.gauge", "unknown key"});
  expect_bad_input(run_tuft({"check", scene, "--set", "rig.mass=2 kg"}), {"rig.mass", "not for the rig"});
  expect_bad_input(run_tuft({"check", scene, "--infill", "dem"}), {"infill", "not for the rig"});
  expect_bad_input(run_tuft({"check", scene, "--set", "rig.rates=[\"0.1 Hz\", \"1 Hz\"]"}),
                   {"rig.gauge_lengths", "3 lengths for 2 rates"});
  expect_bad_input(run_tuft({"check", "inputs/clegg_small.toml", "--set", "rig.strain_limit=0.5"}),
                   {"rig.strain_limit", "not for the rig"});
}

}  // namespace
}  // namespace tuft::test

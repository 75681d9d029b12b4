// `tuft explain --cost`: what it lists and says. Times are the machine's and are not looked at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/commands/command.h"

namespace tuft::test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<std::string> explain_cost(const std::vector<std::string>& more) {
  std::vector<std::string> words{"explain"};
  const auto scene = tiny_scene();
  words.insert(words.end(), scene.begin(), scene.end());
  words.insert(words.end(), {"--cost", "--threads", "1"});
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// The line of the table of costs that begins with an effect's name, or empty.
std::string row_of(const Outcome& outcome, const std::string& effect) {
  const std::size_t table = outcome.out.find("Cost of effects");
  if (table == std::string::npos) return {};
  const std::size_t at = outcome.out.find("\n  " + effect, table);
  return at == std::string::npos ? "" : outcome.out.substr(at + 1, outcome.out.find('\n', at + 1) - at - 1);
}

TEST(ExplainCost, MeasuresWhatCanBeSwitchedAndSaysWhyTheRestIsNot) {
  const Outcome outcome = run_tuft(explain_cost({}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* effect :
       {"artificial_viscosity", "zero_energy_control", "tension_cutoff", "contact_damping"}) {
    EXPECT_THAT(row_of(outcome, effect), HasSubstr("on")) << outcome.out;
    EXPECT_THAT(row_of(outcome, effect), HasSubstr("%")) << outcome.out;
  }
  EXPECT_THAT(row_of(outcome, "shear_energy"), HasSubstr("off"));
  EXPECT_THAT(row_of(outcome, "shear_energy"), HasSubstr("%"));
  EXPECT_THAT(row_of(outcome, "the scene against itself"), HasSubstr("%"));
  EXPECT_THAT(row_of(outcome, "strength_rate"), HasSubstr("no material has a continuum.strength_rate"));
  EXPECT_THAT(row_of(outcome, "rolling_resistance"), HasSubstr("only for dem infill"));
  EXPECT_THAT(outcome.out, HasSubstr("in which the rig presses"));
}

TEST(ExplainCost, OfOneEffectAloneWhichTheMaterialsBear) {
  const Outcome outcome = run_tuft(
      explain_cost({"--only", "strength_rate", "--set",
                    "materials.sbr.continuum.strength_rate={ coefficient = 0.1, reference = '1 Hz' }"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(row_of(outcome, "strength_rate"), HasSubstr("on")) << outcome.out;
  EXPECT_THAT(row_of(outcome, "tension_cutoff"), Not(HasSubstr("%")));
}

TEST(ExplainCost, AVariantThatFailsSpoilsNoOther) {
  // Strands that are let in shake the bed, which this limit does not bear; the scene without them keeps to
  // it.
  const Outcome outcome = run_tuft(explain_cost(
      {"--set", "numerics.energy_error_limit=9e-5", "--only", "fibres", "--only", "tension_cutoff"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(row_of(outcome, "fibres"), HasSubstr("energy error")) << outcome.out;
  EXPECT_THAT(row_of(outcome, "tension_cutoff"), HasSubstr("%")) << outcome.out;
}

TEST(ExplainCost, OfGrainsCountsTheHostToo) {
  const Outcome outcome = run_tuft(explain_cost(
      {"--infill", "dem", "--set", "infill.dem.material_coarse_graining={ sbr = 7.0, sand = 9.0 }", "--set",
       "infill.dem.use_cache=false", "--set", "infill.dem.settle_time=1 ms", "--only",
       "rolling_resistance"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(row_of(outcome, "rolling_resistance"), HasSubstr("%")) << outcome.out;
}

TEST(ExplainCost, OfASpecimenIsThatOfItsFirstTest) {
  const Outcome outcome = run_tuft({"explain", "inputs/oedometer_sbr.toml", "--cost", "--cost-seconds", "6",
                                    "--only", "tension_cutoff", "--threads", "1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(row_of(outcome, "tension_cutoff"), HasSubstr("%")) << outcome.out;
}

TEST(ExplainCost, StopsCleanly) {
  const Outcome outcome = run_tuft(explain_cost({"--set", "scene.duration=1 s", "--cost-seconds", "300"}),
                                   {.interrupt_after = 4});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.out << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("stopped before the end"));
}

TEST(ExplainCost, KeepsToItsTime) {
  const Outcome outcome = run_tuft(explain_cost({"--cost-seconds", "0.001"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("give more with --cost-seconds"));
}

TEST(ExplainCost, RefusesWhatItCannotMeasure) {
  expect_bad_input(run_tuft(explain_cost({"--only", "dilatation"})), {"'dilatation'", "dilation"});
  expect_bad_input(run_tuft({"explain", "inputs/strand_tension.toml", "--cost"}),
                   {"infill", "strand_tension"});
  expect_bad_input(run_tuft({"explain", "inputs/clegg_small.toml", "--cost-seconds", "20"}), {"--cost"});
}

}  // namespace
}  // namespace tuft::test

#include "app/effect_cost_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tuft::app {
namespace {

using studies::EffectCosts;
using studies::MeasuredCost;
using studies::TurnRecord;
using testing::HasSubstr;
using testing::Not;

EffectCosts made_up() {
  EffectCosts costs;
  costs.base = {800e-9, 1e5, 1e9, {0.002, -0.01, 0.012, true}, {0.002, -0.01, 0.012, true}};
  costs.effects.push_back(
      {"artificial_viscosity",
       true,
       {},
       MeasuredCost{
           {0.053, 0.048, 0.058, true}, {40e-9, 36e-9, 44e-9, true}, {0.053, 0.048, 0.058, true}, 0, 0},
       {}});
  costs.effects.push_back(
      {"density_hardening",
       false,
       {"shear_energy"},
       MeasuredCost{
           {0.004, -0.006, 0.011, true}, {3e-9, -5e-9, 9e-9, true}, {0.26, 0.25, 0.27, true}, 0.25, 0.25},
       {}});
  costs.effects.push_back(
      {"strength_rate", false, {}, std::nullopt, "no material has a continuum.strength_rate"});
  costs.turns = 12;
  costs.turn_s = 4e-4;
  costs.from = 5e-3;
  costs.to = 9.8e-3;
  costs.struck = true;
  costs.end = TurnRecord::End::struck;
  return costs;
}

/// The line of a text that begins, spaces aside, with these words.
std::string line_of(const std::string& text, const std::string& start) {
  const std::size_t at = text.find("  " + start);
  return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
}

TEST(EffectCostTable, SaysWhatIsToldAndWhatIsNot) {
  EXPECT_EQ(cost_words({0.053, 0.048, 0.058, true}, {0, -0.01, 0.012, true}), "+5.3 % (+4.8 to +5.8)");
  EXPECT_EQ(cost_words({0.004, -0.006, 0.011, true}, {0, -0.01, 0.012, true}),
            "not told from 0: within 1.2 %");
  EXPECT_EQ(cost_words({0.004, 0.001, 0.006, true}, {0, -0.01, 0.012, true}), "not told from 0: within 1.2 %")
      << "the scene differs by more from itself";
  EXPECT_EQ(cost_words({0.053, 0.048, 0.058, false}, {}), "not told from 0: within 5.8 %") << "too few turns";
}

TEST(EffectCostTable, KeepsStepsAndTheirNumberApart) {
  const std::string text = effect_cost_text(made_up());
  const std::string hardening = line_of(text, "density_hardening and shear_energy");
  EXPECT_THAT(hardening, HasSubstr("off"));
  EXPECT_THAT(hardening, HasSubstr("not told from 0"));
  EXPECT_THAT(hardening, HasSubstr("+25 %"));
  EXPECT_THAT(hardening, HasSubstr("+26 % (+25 to +27)"));
  const std::string viscosity = line_of(text, "artificial_viscosity");
  EXPECT_THAT(viscosity, HasSubstr("+40 "));
  EXPECT_THAT(viscosity, HasSubstr("same"));
}

TEST(EffectCostTable, SaysHowAndWhatElse) {
  EffectCosts costs = made_up();
  std::string text = effect_cost_text(costs);
  EXPECT_THAT(text, HasSubstr("12 turns of 400 µs, 5 to 9.8 ms after the release, in which the rig presses"));
  EXPECT_THAT(text, HasSubstr("800 ns a particle-step"));
  EXPECT_THAT(line_of(text, "strength_rate"), HasSubstr("no material has a continuum.strength_rate"));
  EXPECT_THAT(text, HasSubstr("the scene against itself"));
  EXPECT_THAT(text, Not(HasSubstr("Remarks")));

  costs.struck = false;
  costs.end = TurnRecord::End::out_of_time;
  costs.remarks = {"conditioning is left out"};
  text = effect_cost_text(costs);
  EXPECT_THAT(text, HasSubstr("fewer than six turns"));
  EXPECT_THAT(text, HasSubstr("--cost-seconds"));
  EXPECT_THAT(text, HasSubstr("conditioning is left out"));
}

TEST(EffectCostTable, WithoutTurnsHasNoNumbers) {
  EffectCosts costs = made_up();
  costs.turns = 0;
  costs.struck = false;
  for (auto& effect : costs.effects) effect.measured.reset();
  const std::string text = effect_cost_text(costs);
  EXPECT_THAT(text, HasSubstr("nothing was measured"));
  EXPECT_THAT(text, Not(HasSubstr("against itself")));
}

TEST(EffectCostTable, FollowsTheMeasurementInALine) {
  using Stage = studies::TurnProgress::Stage;
  EXPECT_THAT(effect_cost_progress({Stage::building, "without fibres", 9, 2, 0, 1, 50}, 2e-5),
              HasSubstr("3 of 9 scenes: without fibres"));
  EXPECT_THAT(effect_cost_progress({Stage::settling, "", 9, 0, 50, 1, 50}, 2e-5),
              HasSubstr("1.00 ms  1.00 s, 50.0 s to go at most"));
  EXPECT_THAT(effect_cost_progress({Stage::turns, "", 9, 4, 50, 31, 20}, 2e-5),
              testing::AllOf(HasSubstr("turn 4"), HasSubstr("31.0 s, 20.0 s to go at most")));
}

}  // namespace
}  // namespace tuft::app

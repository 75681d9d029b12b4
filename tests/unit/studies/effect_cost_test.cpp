// What is said of measured turns. Times are made up: nothing here looks at a clock.
#include "studies/effect_cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "core/scene_reader.h"

namespace tuft::studies {
namespace {

constexpr double interval = 2e-5;

Stretch stretch(double step_s, std::uint64_t steps, std::uint64_t windows, double push = 1) {
  return {step_s * static_cast<double>(steps), windows, steps, push};
}

/// The scene twice, and one other.
TurnRecord record_of(std::vector<Stretch> base, std::vector<Stretch> again, std::vector<Stretch> other) {
  TurnRecord record;
  record.stretches = {std::move(base), std::move(again), std::move(other)};
  record.failures.resize(3);
  record.turn = 10;
  return record;
}

/// Twelve turns of 100 ns a particle-step against some factor of it, each off by up to `scatter` of it.
TurnRecord scattered(double factor, double scatter, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(1 - scatter, 1 + scatter);
  std::vector<Stretch> a, b, c;
  for (int t = 0; t < 12; ++t) {
    a.push_back(stretch(100e-9 * off(random), 1000, 50));
    b.push_back(stretch(100e-9 * off(random), 1000, 50));
    c.push_back(stretch(100e-9 * factor * off(random), 1000, 50));
  }
  return record_of(a, b, c);
}

EffectCost named(const std::string& effect, bool on) {
  return {effect, on, {}, std::nullopt, {}};
}

MeasuredCost only_cost(const TurnRecord& record, bool on) {
  const EffectCosts costs = evaluate_turns(record, {named("dilation", on)}, interval);
  EXPECT_TRUE(costs.effects.at(0).measured) << costs.effects.at(0).why_not;
  return costs.effects.at(0).measured.value_or(MeasuredCost{});
}

TEST(EffectCost, IsOfTheSceneWithItOverTheSceneWithout) {
  const MeasuredCost off = only_cost(scattered(1.25, 0, 1), false);
  EXPECT_NEAR(off.step.median, 0.25, 1e-12);
  EXPECT_NEAR(off.step_s.median, 25e-9, 1e-18);
  const MeasuredCost on = only_cost(scattered(0.8, 0, 1), true);
  EXPECT_NEAR(on.step.median, 0.25, 1e-12);
  EXPECT_NEAR(on.step_s.median, 20e-9, 1e-18);
  EXPECT_NEAR(on.total.median, 0.25, 1e-12);
  EXPECT_EQ(on.windows, 0);
}

TEST(EffectCost, TellsShorterStepsFromDearerOnes) {
  std::vector<Stretch> base(8, stretch(100e-9, 1000, 50)), other(8, stretch(110e-9, 2000, 100));
  const EffectCosts costs =
      evaluate_turns(record_of(base, base, other), {named("shear_energy", false)}, interval);
  const MeasuredCost& cost = *costs.effects[0].measured;
  EXPECT_NEAR(cost.step.median, 0.1, 1e-12);
  EXPECT_NEAR(cost.windows, 1, 1e-12);
  EXPECT_NEAR(cost.particle_steps, 1, 1e-12);
  EXPECT_NEAR(cost.total.median, 1.2, 1e-12);
  EXPECT_NEAR(costs.base.windows, 50 / (10 * interval), 1e-6);
  EXPECT_NEAR(costs.base.particle_steps, 1000 / (10 * interval), 1e-6);
}

TEST(EffectCost, NoiseIsNotToldFromNothing) {
  int told = 0;
  constexpr int trials = 200;
  for (unsigned seed = 0; seed < trials; ++seed) {
    const EffectCosts costs = evaluate_turns(scattered(1, 0.05, seed), {named("dilation", false)}, interval);
    told += is_told(costs.effects[0].measured->step, costs.base.step);
  }
  EXPECT_LE(told, trials / 50) << "1 in 20 by its bounds alone, fewer by the scene's own noise";
}

TEST(EffectCost, LargerThanNoiseIsTold) {
  int told = 0;
  constexpr int trials = 200;
  for (unsigned seed = 0; seed < trials; ++seed) {
    const EffectCosts costs =
        evaluate_turns(scattered(1.12, 0.05, seed), {named("dilation", false)}, interval);
    told += is_told(costs.effects[0].measured->step, costs.base.step);
  }
  EXPECT_GE(told, trials * 9 / 10);
}

TEST(EffectCost, OfFewTurnsIsNotTold) {
  const std::vector<Stretch> base(5, stretch(100e-9, 1000, 50)), other(5, stretch(200e-9, 1000, 50));
  const EffectCosts costs =
      evaluate_turns(record_of(base, base, other), {named("dilation", false)}, interval);
  EXPECT_FALSE(is_told(costs.effects[0].measured->step, costs.base.step));
  EXPECT_FALSE(costs.struck);
}

TEST(EffectCost, CountsTheTurnsInWhichTheRigPresses) {
  std::vector<Stretch> base, other;
  for (int t = 0; t < 20; ++t) {
    const bool pressed = t >= 8 && t < 16;
    base.push_back(stretch(100e-9, 1000, 50, pressed ? 10 : 0.5));
    other.push_back(stretch(pressed ? 130e-9 : 100e-9, 1000, 50, 0));
  }
  const EffectCosts costs =
      evaluate_turns(record_of(base, base, other), {named("dilation", false)}, interval);
  EXPECT_TRUE(costs.struck);
  EXPECT_EQ(costs.turns, 8u);
  EXPECT_NEAR(costs.from, 80 * interval, 1e-12);
  EXPECT_NEAR(costs.to, 160 * interval, 1e-12);
  EXPECT_NEAR(costs.effects[0].measured->step.median, 0.3, 1e-12);
}

TEST(EffectCost, AFaultyVariantSpoilsNoOther) {
  const std::vector<Stretch> base(8, stretch(100e-9, 1000, 50)), other(8, stretch(150e-9, 1000, 50));
  TurnRecord record = record_of(base, base, {});
  record.stretches.push_back(other);
  record.failures = {"", "", "the energy balance is off", ""};
  EffectCost lacking = named("clumps", false);
  lacking.why_not = "only for dem infill";
  const EffectCosts costs =
      evaluate_turns(record, {named("tension_cutoff", true), lacking, named("dilation", false)}, interval);
  EXPECT_FALSE(costs.effects[0].measured);
  EXPECT_EQ(costs.effects[0].why_not, "the energy balance is off");
  EXPECT_EQ(costs.effects[1].why_not, "only for dem infill");
  ASSERT_TRUE(costs.effects[2].measured);
  EXPECT_NEAR(costs.effects[2].measured->step.median, 0.5, 1e-12);
}

TEST(EffectCost, OfNoTurnsIsNoNumber) {
  const EffectCosts costs = evaluate_turns(record_of({}, {}, {}), {named("dilation", false)}, interval);
  EXPECT_EQ(costs.turns, 0u);
  EXPECT_FALSE(costs.effects[0].measured);
  EXPECT_EQ(costs.effects[0].why_not, "no turn was finished");
}

TEST(EffectCost, AsksForInfillAndForEffectsThatAreThere) {
  CostRequest request;
  request.scene = read_scene("inputs/strand_tension.toml");
  EXPECT_THROW(static_cast<void>(measure_effect_costs(request)), InputError);
  request.scene = read_scene("inputs/clegg_small.toml");
  request.only = {"dilatation"};
  try {
    static_cast<void>(measure_effect_costs(request));
    ADD_FAILURE() << "an unknown effect is refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("'dilatation'"), testing::HasSubstr("dilation")));
  }
  request.only.clear();
  request.memory_bytes = std::uint64_t{1} << 50U;
  try {
    static_cast<void>(measure_effect_costs(request));
    ADD_FAILURE() << "too much memory is refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("--only"));
  }
}

}  // namespace
}  // namespace tuft::studies

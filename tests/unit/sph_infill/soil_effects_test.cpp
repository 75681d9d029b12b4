// Effects of the soil law, one by one; what they do to its energy: soil_energy_test.cpp.
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/unit/sph_infill/soil_steps.h"

namespace tuft::sph {
namespace {

using namespace test;

TEST(DensityHardening, CompactionRaisesModulusAndStrengthTogetherAndTheyStay) {
  const SoilFoamMaterial m = mixture_with_effects();
  const SoilLaw law = make_soil_law(m, true, hardening);
  SoilState pressed = reference_state(law);
  const double loose_modulus = pressed.bulk_modulus, loose_strength = strength(law, pressed);
  const double largest = 0.1;
  go_to(law, pressed, largest, 100);
  const double left = largest * (1 - 1 / (1.2 * std::exp(4 * largest)));
  go_to(law, pressed, left, 100);
  EXPECT_NEAR(pressed.pressure, 0, 1e-6) << "free of stress at the density it keeps";
  EXPECT_NEAR(pressed.bulk_modulus, std::exp(4 * largest) * loose_modulus, 1e-9 * loose_modulus);
  EXPECT_NEAR(strength(law, pressed), std::exp(2 * largest) * loose_strength, 1e-6 * loose_strength);
}

TEST(DensityHardening, FirstLoadingIsTheSameAndReloadingRejoinsIt) {
  const SoilFoamMaterial m = mixture_with_effects();
  const SoilLaw law = make_soil_law(m, true, hardening);
  const auto first_loading = [](double e) { return 1.5e5 * std::expm1(10 * e); };
  SoilState state = reference_state(law);
  for (const double e : {0.02, 0.07, 0.12}) {
    go_to(law, state, e, 20);
    EXPECT_NEAR(state.pressure, first_loading(e), 1e-9 * first_loading(e));
    go_to(law, state, 0.9 * e, 7);
    EXPECT_LT(state.pressure, first_loading(0.9 * e));
    go_to(law, state, e, 13);
    EXPECT_NEAR(state.pressure, first_loading(e), 1e-9 * first_loading(e));
  }
}

TEST(DensityHardening, CompactedStateIsWhatPressingAndReleasingLeaves) {
  for (const SoilEffects& effects : {SoilEffects{}, hardening}) {
    const SoilLaw law = make_soil_law(mixture_with_effects(), true, effects);
    const SoilState made = compacted_state(law, 0.03);
    SoilState pressed = reference_state(law);
    go_to(law, pressed, made.largest_compression, 50);
    go_to(law, pressed, 0.03, 50);
    EXPECT_NEAR(pressed.plastic_compression, 0.03, 1e-12);
    EXPECT_NEAR(pressed.pressure, made.pressure, 1e-5);
    EXPECT_NEAR(pressed.bulk_modulus, made.bulk_modulus, 1e-6 * made.bulk_modulus);
  }
  const SoilLaw elastic = make_soil_law(test::elastic_material(1e6, 1000));
  EXPECT_THROW((void)compacted_state(elastic, 0.1), InputError);
  EXPECT_EQ(compacted_state(elastic, 0).compression, 0);
}

TEST(StrengthSoftening, LosesStrengthWithPlasticShearDownToItsResidual) {
  SoilFoamMaterial m = mixture_with_effects();
  m.yield_a1 = m.yield_a2 = 0;  // cohesion alone, 20 kPa
  const SoilLaw law = make_soil_law(m, true, softening);
  SoilState state = reference_state(law);
  const double shear_modulus = 0.5 * 1.2 * 1.5e6, step = 1e-4;
  // To the yield point, then by plastic shear gamma: 0.2 + 0.8 exp(-gamma/0.05) of the cohesion.
  double plastic = 0, before = 0;
  for (int k = 0; k < 5000; ++k) {
    update_soil(law, shear(step), state);
    plastic += step - (state.deviator.xy - before) / shear_modulus;
    before = state.deviator.xy;
    if (k % 500 == 499) {
      EXPECT_NEAR(state.deviator.xy, 20e3 * (0.2 + 0.8 * std::exp(-plastic / 0.05)), 40) << k;
    }
  }
  EXPECT_NEAR(state.deviator.xy, 0.2 * 20e3, 10);
  EXPECT_GT(state.lost_strength, 0.999);
}

TEST(StrengthSoftening, TornInfillHasLostItsStrength) {
  const SoilLaw law = make_soil_law(mixture_with_effects(), true, softening);
  SoilState state = reference_state(law);
  go_to(law, state, -0.5, 100);
  EXPECT_GT(state.lost_strength, 0.999);
}

TEST(StrengthRecovery, ComesBackWithTimeAndWithCompressionAndNotWithout) {
  const SoilFoamMaterial m = mixture_with_effects();
  const SoilLaw law = make_soil_law(m, true, recovery);
  SoilState lost = reference_state(law);
  lost.lost_strength = 0.9;
  SoilState state = lost;
  for (int k = 0; k < 100; ++k) update_soil(law, compress(0, 0.01), state);  // 1 s
  EXPECT_NEAR(state.lost_strength, 0.9 * std::exp(-1 / 0.5), 1e-12);
  state = lost;
  go_to(law, state, 0.01, 10);
  EXPECT_NEAR(state.lost_strength, 0.9 * std::exp(-0.01 / 0.02), 1e-12);
  const double kept = state.lost_strength;
  go_to(law, state, 0.005, 10);
  EXPECT_EQ(state.lost_strength, kept) << "unloading heals nothing";
  const SoilLaw without = make_soil_law(m, true, softening);
  state = lost;
  for (int k = 0; k < 100; ++k) update_soil(without, compress(1e-4, 0.01), state);
  EXPECT_NEAR(state.lost_strength, 0.9, 1e-12);
}

TEST(StrengthRate, GrowsWithTheLogarithmOfTheShearRate) {
  const SoilFoamMaterial m = mixture_with_effects();
  const SoilLaw law = make_soil_law(m, true, rate), plain = make_soil_law(m);
  const double slow = strength(plain, reference_state(plain));
  for (const double gamma_rate : {1e-3, 0.1, 10.0, 1000.0})
    EXPECT_NEAR(strength(law, reference_state(law), gamma_rate),
                slow * (1 + 0.05 * std::log1p(gamma_rate / 0.1)), 1e-9 * slow);
  EXPECT_NEAR(strength(law, reference_state(law), 0), slow, 1e-9 * slow) << "no duration: infinitely slow";
}

/// mu(I) of the parameters of mixture_with_effects, as a factor.
double inertial_strength(double gamma_rate, double pressure) {
  const double number = gamma_rate * 0.001 * std::sqrt(2450 / pressure);
  return 1 + 0.7 * number / (number + 0.279);
}

TEST(InertialFriction, SteadyShearBearsMuOfTheInertialNumberAtAnyRatePressureAndStep) {
  const SoilFoamMaterial m = mixture_with_effects();
  const SoilLaw law = make_soil_law(m, true, inertial), plain = make_soil_law(m);
  for (const double compression : {1e-4, 0.02}) {
    SoilState pressed = reference_state(law);
    go_to(law, pressed, compression, 100);
    const double slow = strength(plain, pressed);
    EXPECT_NEAR(strength(law, pressed), slow, 1e-12 * slow) << "no duration: infinitely slow";
    for (const double gamma_rate : {1e-3, 1.0, 100.0, 1e4, 1e7})
      for (const double strain : {1e-5, 1e-3, 0.1}) {
        SoilState state = pressed;
        double before = 0;
        for (int k = 0; k < 20000 && (k < 3 || root_j2(state) != before); ++k) {
          before = root_j2(state);
          update_soil(law, shear(strain, strain / gamma_rate), state);
        }
        const double expected = slow * inertial_strength(gamma_rate, pressed.pressure);
        EXPECT_NEAR(root_j2(state), expected, 1e-9 * expected) << gamma_rate << " 1/s, steps of " << strain;
        const double limit = yield_limit(law, pressed, pressed.pressure, gamma_rate);
        EXPECT_NEAR(std::sqrt(limit), expected, 1e-9 * expected);
      }
  }
}

TEST(InertialFriction, AFastShearThatStopsRelaxesToTheStrengthAtRestAndNeverBelow) {
  const SoilLaw law = make_soil_law(mixture_with_effects(), true, inertial);
  SoilState state = reference_state(law);
  go_to(law, state, 0.02, 100);
  const double rest = std::sqrt(yield_limit(law, state, state.pressure));
  for (int k = 0; k < 100; ++k) update_soil(law, shear(1e-3, 1e-6), state);
  double before = root_j2(state);
  ASSERT_GT(before, 1.2 * rest);
  for (int k = 0; k < 3000; ++k) {
    const SoilWork work = update_soil(law, shear(0, 1e-6), state);
    ASSERT_LE(root_j2(state), before);
    ASSERT_GE(root_j2(state), rest * (1 - 1e-12));
    ASSERT_GE(work.dissipated, 0);
    before = root_j2(state);
  }
  EXPECT_LT(before, 1.01 * rest);
}

TEST(InertialFriction, MultipliesWhatTheRateAddsAndTheOtherWayRound) {
  SoilEffects both = inertial;
  both.strength_rate = true;
  const SoilFoamMaterial m = mixture_with_effects();
  const SoilLaw law = make_soil_law(m, true, both), of_rate = make_soil_law(m, true, rate);
  SoilState state = reference_state(law);
  go_to(law, state, 0.02, 100);
  const double expected = strength(of_rate, state, 100) * inertial_strength(100, state.pressure);
  EXPECT_NEAR(strength(law, state, 100), expected, 1e-9 * expected);
}

TEST(InertialFriction, WithoutPressureAnyFlowIsFast) {
  const SoilLaw law = make_soil_law(mixture_with_effects(), true, inertial);
  SoilState state = reference_state(law);
  const double cohesion = 20e3;
  for (int k = 0; k < 1000; ++k) update_soil(law, shear(1e-3, 1), state);
  EXPECT_NEAR(root_j2(state), 1.7 * cohesion, 1e-9 * cohesion);
}

TEST(Dilation, ShearedAtFixedDensityCompactedInfillPressesUpToFirstLoadingAndStops) {
  const SoilLaw law = make_soil_law(mixture_with_effects(), true, dilation);
  SoilState state = compacted_state(law, 0.02);
  const double virgin = law.virgin(0.02).value;
  double before = state.pressure, plastic_before = state.plastic_compression;
  bool checked = false;
  for (int k = 0; k < 3000; ++k) {
    const double stress = root_j2(state);
    update_soil(law, shear(1e-4), state);
    ASSERT_GE(state.pressure, before - 1e-9);
    // Plastic expansion is tan(psi) times the plastic shear strain.
    if (k == 500) {
      const double shear_modulus = 0.5 * state.bulk_modulus;
      const double plastic_shear = 1e-4 - (root_j2(state) - stress) / shear_modulus;
      EXPECT_NEAR(plastic_before - state.plastic_compression, std::tan(0.15) * plastic_shear,
                  0.01 * std::tan(0.15) * plastic_shear);
      checked = true;
    }
    before = state.pressure;
    plastic_before = state.plastic_compression;
  }
  ASSERT_TRUE(checked);
  EXPECT_NEAR(state.pressure, virgin, 1e-9 * virgin) << "as loose as it can be at this density";
  const double limit = yield_limit_of(LawOfPoint(law), state.pressure);
  EXPECT_NEAR(root_j2(state), std::sqrt(limit), 1e-6 * std::sqrt(limit));
}

TEST(Dilation, OfInfillThatWasNeverCompactedIsNone) {
  const SoilFoamMaterial m = mixture_with_effects();
  const SoilLaw law = make_soil_law(m, true, dilation), plain = make_soil_law(m);
  SoilState a = reference_state(law), b = reference_state(plain);
  for (int k = 0; k < 500; ++k) {
    StrainStep step = shear(2e-4);
    step.strain.zz = -1e-4;
    update_soil(law, step, a);
    update_soil(plain, step, b);
    ASSERT_NEAR(a.pressure, b.pressure, 1e-9 * b.pressure);
    ASSERT_NEAR(a.deviator.xy, b.deviator.xy, 1e-9 * b.pressure);
  }
}

TEST(Dilation, LoosenedInfillReloadsAlongAndThenOnFirstLoading) {
  const SoilLaw law = make_soil_law(mixture_with_effects(), true, dilation);
  SoilState state = compacted_state(law, 0.02);
  for (int k = 0; k < 300; ++k) update_soil(law, shear(1e-4), state);
  ASSERT_LT(state.plastic_compression, 0.0199);
  go_to(law, state, 0.2, 2000);
  EXPECT_NEAR(state.pressure, law.virgin(0.2).value, 1e-9 * state.pressure);
}

TEST(Dilation, BeyondTheLeastFrictionIsRefused) {
  SoilFoamMaterial m = mixture_with_effects();
  m.dilation_angle = 0.5;  // tan 0.546 > 0.35
  EXPECT_THROW((void)make_soil_law(m, true, dilation), InputError);
  m.dilation_angle = 0.33;  // tan 0.343 < 0.35, but softened to 0.28
  EXPECT_NO_THROW((void)make_soil_law(m, true, dilation));
  SoilEffects both = dilation;
  both.strength_softening = true;
  EXPECT_THROW((void)make_soil_law(m, true, both), InputError);
}

}  // namespace
}  // namespace tuft::sph

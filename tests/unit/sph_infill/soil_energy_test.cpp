// Effects of the soil law together: their energy, and parameters that are refused.
#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "tests/unit/sph_infill/soil_steps.h"

namespace tuft::sph {
namespace {

using namespace test;

/// Energy of a volume that was 1 m^3 at the reference density.
struct Ledger {
  double total = 0, dissipated = 0, taken_and_given = 0, least_dissipated = 0;
  void add(const SoilWork& work, double before, double after) {
    const double volume = 0.5 * (std::exp(-before) + std::exp(-after));
    total += volume * work.total;
    dissipated += volume * work.dissipated;
    taken_and_given += volume * std::abs(work.total);
    least_dissipated = std::min(least_dissipated, work.dissipated);
  }
};

/// Shears under pressure, releases most of it, shears back, presses again; elastic all along.
Ledger out_of_phase(const SoilLaw& law, int cycles) {
  SoilState state = reference_state(law);
  go_to(law, state, 0.05, 1000);
  Ledger ledger;
  const auto move = [&](const StrainStep& step, int count) {
    for (int k = 0; k < count; ++k) {
      const double before = state.compression;
      const SoilWork work = update_soil(law, step, state);
      ledger.add(work, before, state.compression);
    }
  };
  for (int k = 0; k < cycles; ++k) {
    move(shear(2e-5), 100);
    move(compress(-1e-5), 1000);
    move(shear(-2e-5), 100);
    move(compress(1e-5), 1000);
  }
  return ledger;
}

TEST(ShearEnergy, WithoutItACycleOfShearAndPressureOutOfPhaseGainsEnergyWithItNone) {
  SoilFoamMaterial m = mixture_with_effects();
  m.yield_a0 = 1e14;  // no yield: what is gained then is bounded by the strength alone
  const SoilLaw plain = make_soil_law(m), safe = make_soil_law(m, true, shear_energy);
  // In: G_high gamma^2/2; out, while s falls from G_high gamma: (G_high - G_low/2) gamma^2; gamma = 2e-3.
  const double high = 0.6 * 1.5e6 * std::exp(0.5), low = high * std::exp(-1.2 * 10 * 0.01);
  const double gain = 4e-6 * (std::exp(-0.04) * (high - 0.5 * low) - std::exp(-0.05) * 0.5 * high);
  EXPECT_NEAR(out_of_phase(plain, 1).total, -gain, 0.003 * gain);
  EXPECT_LT(out_of_phase(plain, 20).total, -20 * gain) << "and on and on";
  for (const int cycles : {1, 20}) EXPECT_GT(out_of_phase(safe, cycles).total, -0.01 * gain);
}

std::vector<SoilEffects> all_combinations() {
  std::vector<SoilEffects> all;
  for (unsigned code = 0; code < 1U << detail::soil_effect_count; ++code)
    if (detail::code_of(detail::effects_of(code)) == code) all.push_back(detail::effects_of(code));
  return all;
}

/// Random steps around a compression that wanders, with turns; Visit sees each.
template <class Visit>
void random_path(const SoilLaw& law, unsigned seed, int steps, double size, SoilState& state, Visit&& visit) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> any(0, size);
  SymmetricTensor direction;
  for (int k = 0; k < steps; ++k) {
    // Directions last for some steps, so that yield, unloading and tension are all reached.
    if (k % 25 == 0)
      direction = {any(random), any(random), any(random), any(random), any(random), any(random)};
    const double back = 0.01 * (0.06 - state.compression) * size / 1e-3;
    StrainStep step{direction, {any(random), any(random), any(random)}, 1e-4};
    step.strain.xx -= back, step.strain.yy -= back, step.strain.zz -= back;
    const double before = state.compression;
    const SoilWork work = update_soil(law, step, state);
    visit(work, before);
  }
}

TEST(SoilEffectsTogether, DissipateAndNeverReturnMoreThanWasPutIn) {
  int combination = 0;
  for (const SoilEffects& effects : all_combinations()) {
    const SoilLaw law = make_soil_law(mixture_with_effects(), true, effects);
    SoilState state = reference_state(law);
    Ledger ledger;
    double least_total = 0;
    random_path(law, 11, 8000, 1e-3, state, [&](const SoilWork& work, double before) {
      ledger.add(work, before, state.compression);
      least_total = std::min(least_total, ledger.total);
    });
    EXPECT_GE(ledger.least_dissipated, -1e-9) << combination;
    EXPECT_GE(least_total, -1e-9 * ledger.taken_and_given) << combination;
    EXPECT_GT(ledger.dissipated, 0) << combination;
    ++combination;
  }
  EXPECT_EQ(combination, 96);
}

TEST(SoilEffectsTogether, WorkLessDissipationIsTheEnergyOfTheStateWhereShearKeepsIts) {
  // The finer the path, the nearer. Without the effect the difference stays.
  for (SoilEffects effects : all_combinations()) {
    if (!effects.shear_energy) continue;
    const SoilLaw law = make_soil_law(mixture_with_effects(), true, effects);
    const auto error = [&](double size, int steps) {
      SoilState state = reference_state(law);
      Ledger ledger;
      random_path(law, 5, steps, size, state,
                  [&](const SoilWork& work, double before) { ledger.add(work, before, state.compression); });
      const double stored = std::exp(-state.compression) * stored_energy(law, state);
      return std::abs(ledger.total - ledger.dissipated - stored) / ledger.taken_and_given;
    };
    EXPECT_LT(error(2e-4, 8000), 0.02) << "effects " << detail::code_of(effects);
  }
}

void expect_rejected(const SoilFoamMaterial& material, const SoilEffects& effects, const std::string& words) {
  try {
    (void)make_soil_law(material, true, effects);
    FAIL() << "accepted, expected: " << words;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(SoilEffectsTogether, RejectParametersOutOfRangeByName) {
  SoilFoamMaterial m = mixture_with_effects();
  m.density_hardening->modulus_exponent = -1;
  expect_rejected(m, hardening, "density_hardening.modulus_exponent is -1");
  EXPECT_NO_THROW((void)make_soil_law(m, true, dilation)) << "of an effect that is off nothing is asked";
  m = mixture_with_effects();
  m.strength_softening->residual_friction = 0;
  expect_rejected(m, softening, "strength_softening.residual_friction is 0");
  m = mixture_with_effects();
  m.strength_softening->strain = 0;
  expect_rejected(m, softening, "strength_softening.strain is 0");
  m = mixture_with_effects();
  m.strength_recovery->time = -1;
  expect_rejected(m, recovery, "strength_recovery.time is -1");
  m = mixture_with_effects();
  m.strength_rate->reference = 0;
  expect_rejected(m, rate, "strength_rate.reference is 0");
  m = mixture_with_effects();
  m.inertial_friction->grain_diameter = 0;
  expect_rejected(m, inertial, "inertial_friction.grain_diameter is 0");
}

}  // namespace
}  // namespace tuft::sph

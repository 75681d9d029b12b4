/// A step over the limit does not go unnoticed.
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

struct Outcome {
  std::string error;
  int steps = 0;
  double energy_error = 0;  ///< over the energy at first, largest until then
};

/// A block with a little random motion at a multiple of its stable step.
Outcome run_at(const test::Numerics& numerics, const SoilFoamMaterial& material, double share, int steps) {
  SphInfill infill(test::block(7, 7, 7, pitch), test::single_material(material),
                   test::settings_of(numerics, pitch, {0, 0, 0}));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-1e-3, 1e-3);
  for (std::size_t i = 0; i < infill.particles().size(); ++i)
    infill.set_velocity(i, {any(random), any(random), any(random)});
  const double dt = share * infill.stable_step();
  Outcome outcome;
  test::EnergyLedger ledger;
  try {
    for (; outcome.steps < steps; ++outcome.steps) {
      infill.advance(dt, 1, {});
      ledger.enter(infill.energy());
      outcome.energy_error = ledger.worst / ledger.first;
    }
  } catch (const RunError& error) {
    outcome.error = error.what();
  }
  return outcome;
}

class UnstableStep : public testing::TestWithParam<test::Numerics> {};
INSTANTIATE_TEST_SUITE_P(NumericsOf, UnstableStep,
                         testing::Values(test::Numerics{test::Preset::accurate, 0},
                                         test::Numerics{test::Preset::accurate, 0.3, 0.05},
                                         test::Numerics{test::Preset::fast, 0},
                                         test::Numerics{test::Preset::fast, 0.3, 0.05},
                                         test::Numerics{test::Preset::paper, 0},
                                         test::Numerics{test::Preset::paper, 0.3, 0.05}));

TEST_P(UnstableStep, OfAnElasticBlockIsCaughtNamingAParticle) {
  const Outcome outcome = run_at(GetParam(), test::elastic_material(1e6, 1000), 1.5, 3000);
  RecordProperty("steps", testing::PrintToString(outcome.steps));
  RecordProperty("error", outcome.error);
  EXPECT_NE(outcome.error.find("particle "), std::string::npos)
      << "not caught in " << outcome.steps << " steps";
  EXPECT_NE(outcome.error.find("t = "), std::string::npos) << outcome.error;
  EXPECT_NE(outcome.error.find("lower numerics.step_safety"), std::string::npos) << outcome.error;
}

TEST_P(UnstableStep, OfABlockThatYieldsAndTearsIsSeenByTheEnergyLedger) {
  const Outcome outcome = run_at(GetParam(), test::mixture_material(), 1.5, 3000);
  RecordProperty("steps", testing::PrintToString(outcome.steps));
  RecordProperty("energy_error", testing::PrintToString(outcome.energy_error));
  EXPECT_TRUE(!outcome.error.empty() || outcome.energy_error > 1) << outcome.energy_error;
}

TEST_P(UnstableStep, IsNotWhatTheStableStepIs) {
  const Outcome outcome = run_at(GetParam(), test::elastic_material(1e6, 1000), 0.95, 3000);
  EXPECT_EQ(outcome.error, "");
  EXPECT_LT(outcome.energy_error, 0.02);
}

}  // namespace
}  // namespace tuft::sph

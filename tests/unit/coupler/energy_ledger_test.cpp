#include "coupler/energy_ledger.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"

namespace tuft::coupler {
namespace {

/// Nothing is the fastest.
std::string nobody() {
  return "";
}

std::string message_of(EnergyLedger& ledger, double time, const EnergyTerms& terms) {
  try {
    ledger.enter(time, terms, [] { return std::string("fastest particle 7 (31 m/s)"); });
  } catch (const RunError& error) {
    return error.what();
  }
  return {};
}

TEST(EnergyLedger, EnergyThatChangesItsFormIsNoError) {
  EnergyLedger ledger(0.01, 10);
  EnergyTerms terms;
  terms.kinetic_bodies = 10;
  ledger.enter(0, terms, nobody);
  terms.kinetic_bodies = 2;
  terms.stored_infill = 3;
  terms.contact_friction = 4;
  terms.strain_carpet = 1;
  ledger.enter(1, terms, nobody);
  EXPECT_EQ(ledger.largest_error(), 0);
}

TEST(EnergyLedger, WorkPutInIsNoError) {
  EnergyLedger ledger(0.01, 1);
  ledger.enter(0, {}, nobody);
  EnergyTerms terms;
  terms.kinetic_bodies = 9;
  terms.external_work = 9;
  ledger.enter(1, terms, nobody);
  EXPECT_EQ(ledger.largest_error(), 0);
}

TEST(EnergyLedger, EveryTermCounts) {
  EnergyTerms base;
  for (std::size_t i = 0; i < EnergyTerms::count; ++i) {
    EnergyLedger ledger(0.5, 10);
    ledger.enter(0, base, nobody);
    EnergyTerms changed;
    double* const all[] = {&changed.kinetic_carpet,  &changed.kinetic_infill,    &changed.kinetic_bodies,
                           &changed.strain_carpet,   &changed.hourglass,         &changed.eroded,
                           &changed.stored_infill,   &changed.dissipated_infill, &changed.contact_elastic,
                           &changed.contact_damping, &changed.contact_friction,  &changed.gravity_potential,
                           &changed.damping,         &changed.expelled,          &changed.conditioning,
                           &changed.external_work};
    *all[i] = 1;
    ledger.enter(1, changed, nobody);
    EXPECT_NEAR(ledger.error(), i + 1 == EnergyTerms::count ? -0.1 : 0.1, 1e-15) << EnergyTerms::names[i];
  }
}

TEST(EnergyLedger, PassingTheLimitNamesTermTimeAndParticle) {
  EnergyLedger ledger(0.02, 10);
  EnergyTerms terms;
  terms.kinetic_bodies = 10;
  ledger.enter(0, terms, nobody);
  terms.contact_elastic = 0.5;
  const std::string message = message_of(ledger, 0.00321, terms);
  EXPECT_NE(message.find("contact_elastic"), std::string::npos) << message;
  EXPECT_NE(message.find("t = 0.00321 s"), std::string::npos) << message;
  EXPECT_NE(message.find("particle 7"), std::string::npos) << message;
  EXPECT_NE(message.find("numerics.energy_error_limit (2 %)"), std::string::npos) << message;
}

TEST(EnergyLedger, ATermThatIsNotFiniteStopsTheRunByName) {
  EnergyLedger ledger(0.02, 10);
  EnergyTerms terms;
  terms.stored_infill = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message_of(ledger, 1, terms).find("stored_infill is not finite"), std::string::npos);
}

}  // namespace
}  // namespace tuft::coupler

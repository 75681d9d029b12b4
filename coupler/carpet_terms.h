#pragma once
/// The carpet's part of the ledger.
#include "coupler/energy_ledger.h"
#include "fe_carpet/carpet.h"

namespace tuft::coupler {

/// The terms of a carpet by itself; its external work is that of all loads on it, contact included.
[[nodiscard]] inline EnergyTerms terms_of(const fe::CarpetEnergy& carpet) {
  EnergyTerms terms;
  terms.kinetic_carpet = carpet.kinetic;
  terms.strain_carpet = carpet.strain;
  terms.hourglass = carpet.hourglass;
  terms.eroded = carpet.eroded;
  terms.gravity_potential = carpet.gravity_potential;
  terms.damping = carpet.damping;
  terms.external_work = carpet.external_work;
  return terms;
}

}  // namespace tuft::coupler

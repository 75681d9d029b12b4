#pragma once
/// Energies of two runs that must not differ by a bit.
#include <gtest/gtest.h>

#include "core/infill.h"

namespace tuft::test {

inline void expect_same_energy(const InfillEnergy& a, const InfillEnergy& b) {
  EXPECT_EQ(a.kinetic, b.kinetic);
  EXPECT_EQ(a.stored, b.stored);
  EXPECT_EQ(a.dissipated, b.dissipated);
  EXPECT_EQ(a.gravity_potential, b.gravity_potential);
  EXPECT_EQ(a.damping, b.damping);
  EXPECT_EQ(a.contact_work, b.contact_work);
}

}  // namespace tuft::test

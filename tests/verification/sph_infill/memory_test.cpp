/// What a bed takes of the machine's memory.
#include <gtest/gtest.h>
#include <malloc.h>

#include "bench/resident_memory.h"
#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph {
namespace {

/// Thrown off its lattice, so that rows of neighbours are of unlike length as in a bed at rest, and stepped
/// until lists have been made again.
double bytes_a_particle(test::Preset preset) {
  ::mallopt(M_MMAP_THRESHOLD, 1 << 16);  // what is given back leaves the process
  constexpr double pitch = 0.002;
  constexpr int side = 64, high = 25;
  Lattice lattice = test::block(side, side, high, pitch);
  test::jitter(lattice, 1.0 / 7);
  SphSettings settings = test::settings_of({preset, 0.3, 0.05}, pitch, {0, 0, -9.81});
  settings.zero_energy_control = preset != test::Preset::paper;
  const double before = resident_memory();
  SphInfill infill(lattice, test::single_material(test::mixture_material()), settings);
  infill.set_damping(2000);
  for (int step = 0; step < 40; ++step) infill.advance(0.4 * infill.stable_step(), 1, {});
  return (resident_memory() - before) / (side * side * high);
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool memory_is_its_own = false;  // a sanitizer keeps books of each byte
#else
constexpr bool memory_is_its_own = true;
#endif

TEST(Memory, OfABedWithThePublishedNeighboursIsUnderFourHundredBytesAParticle) {
  if (!memory_is_its_own) GTEST_SKIP();
  const double bytes = bytes_a_particle(test::Preset::paper);
  RecordProperty("bytes_a_particle", testing::PrintToString(bytes));
  EXPECT_LT(bytes, 400);
  EXPECT_GT(bytes, 200) << "it cannot be: the state alone is more";
}

TEST(Memory, OfABedWithSeventyFiveNeighboursIsUnderEightHundredBytesAParticle) {
  if (!memory_is_its_own) GTEST_SKIP();
  const double bytes = bytes_a_particle(test::Preset::accurate);
  RecordProperty("bytes_a_particle", testing::PrintToString(bytes));
  EXPECT_LT(bytes, 800);
}

}  // namespace
}  // namespace tuft::sph

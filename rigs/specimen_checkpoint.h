#pragma once
/// Where a run of a specimen stands, as its checkpoint.h5 has it.
#include <cstddef>
#include <cstdint>

#include "core/infill.h"
#include "rigs/checkpoint_books.h"

namespace tuft::rigs {

inline constexpr CheckpointFormat specimen_format{"specimen_format", 5};

/// Beside the test at hand and its simulation.
struct SpecimenTally {
  std::uint64_t test = 0, row = 0;  ///< test at hand, rows of it done
  double time_before = 0;           ///< s, of the tests before this one
  std::uint64_t steps_before = 0, particle_steps_before = 0;
  double energy_error = 0, momentum_error = 0;  ///< largest of the tests before this one
  double kinetic_share = 0;                     ///< the same
  Expelled expelled;                            ///< in the tests before this one
  double most_kinetic = 0, most_work = 0;  ///< J, largest energy of motion and work done, of the test at hand
};

void write_tally(h5::Group& root, const SpecimenTally& tally);
/// Throws InputError for one that is not of a rig with so many tests.
[[nodiscard]] SpecimenTally read_tally(const h5::Group& root, std::size_t tests);

}  // namespace tuft::rigs

#include "rigs/specimen_checkpoint.h"

#include <vector>

#include "core/checkpoint_values.h"

namespace tuft::rigs {

void write_tally(h5::Group& root, const SpecimenTally& tally) {
  root.write_scalar("test", tally.test);
  root.write_scalar("row", tally.row);
  root.write_scalar("steps_before", tally.steps_before);
  root.write_scalar("particle_steps_before", tally.particle_steps_before);
  const std::vector<double> numbers{tally.time_before,   tally.energy_error, tally.momentum_error,
                                    tally.kinetic_share, tally.most_kinetic, tally.most_work};
  root.write("numbers", std::span<const double>(numbers));
  const Expelled& gone = tally.expelled;
  root.write("expelled", std::vector{static_cast<double>(gone.particles), gone.mass, gone.momentum.x(),
                                     gone.momentum.y(), gone.momentum.z(), gone.kinetic_energy});
}

SpecimenTally read_tally(const h5::Group& root, std::size_t tests) {
  SpecimenTally tally;
  tally.test = h5::read_count(root, "test", static_cast<double>(tests) - 1);
  tally.row = h5::read_count(root, "row");
  tally.steps_before = h5::read_count(root, "steps_before");
  tally.particle_steps_before = h5::read_count(root, "particle_steps_before");
  const std::vector<double> numbers = h5::read_checked(root, "numbers", 6);
  tally.time_before = numbers[0];
  tally.energy_error = numbers[1];
  tally.momentum_error = numbers[2];
  tally.kinetic_share = numbers[3];
  tally.most_kinetic = numbers[4];
  tally.most_work = numbers[5];
  const std::vector<double> gone = h5::read_checked(root, "expelled", 6);
  tally.expelled = {static_cast<std::uint64_t>(gone[0]), gone[1], Vec3(gone[2], gone[3], gone[4]), gone[5]};
  return tally;
}

}  // namespace tuft::rigs

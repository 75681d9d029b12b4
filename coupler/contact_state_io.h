#pragma once
/// Contact memory in checkpoints.
#include <vector>

#include "core/hdf5_file.h"
#include "coupler/contact_pairs.h"

namespace tuft::coupler {

void save_pairs(h5::Group& group, const std::vector<PairKey>& keys,
                const std::vector<ContactHistory>& histories);
/// points, others: how many there are of what the keys name.
void load_pairs(const h5::Group& group, std::size_t points, std::size_t others, std::vector<PairKey>& keys,
                std::vector<ContactHistory>& histories);
void save_energy(h5::Group& group, const ContactEnergy& energy);
[[nodiscard]] ContactEnergy load_energy(const h5::Group& group);

}  // namespace tuft::coupler

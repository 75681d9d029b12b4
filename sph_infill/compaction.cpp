#include "sph_infill/compaction.h"

#include "core/parallel.h"
#include "sph_infill/neighbour_list.h"
#include "sph_infill/particle_packs.h"

namespace tuft::sph {

CompactionMeasure::CompactionMeasure(const Lattice& lattice, std::vector<double> mass, const SphOptions& options)
    : mass_(std::move(mass)), options_(options), pitch_(lattice.pitch), placed_(sums(lattice.position)) {}

std::vector<double> CompactionMeasure::sums(const Vec3Array& position) const {
  NeighbourList list(position, 2 * options_.smoothing_length, 0.01 * pitch_);
  list.build(position);
  std::vector<double> density(position.size());
  with_kernel(options_, [&](const auto kernel) {
    parallel_for(position.size(), [&](std::size_t i) {
      double sum = mass_[i] * kernel.value(0);
      for (const Index j : list.row(i)) {
        const auto other = static_cast<std::size_t>(j);
        sum += mass_[other] * kernel.value((position[i] - position[other]).norm());
      }
      density[i] = sum;
    });
  });
  return density;
}

std::vector<double> CompactionMeasure::ratio(const Vec3Array& position) const {
  std::vector<double> ratio = sums(position);
  for (std::size_t i = 0; i < ratio.size(); ++i) ratio[i] /= placed_[i];
  return ratio;
}

}  // namespace tuft::sph

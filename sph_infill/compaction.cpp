#include "sph_infill/compaction.h"

#include "core/parallel.h"
#include "sph_infill/neighbour_list.h"
#include "sph_infill/particle_packs.h"

namespace tuft::sph {

CompactionMeasure::CompactionMeasure(const Lattice& lattice, const SphOptions& options)
    : volume_(lattice.volume),
      options_(options),
      pitch_(lattice.pitch),
      placed_(sums(lattice.position, lattice.volume)) {}

std::vector<double> CompactionMeasure::sums(const Vec3Array& position,
                                            const std::vector<double>& weight) const {
  NeighbourList list(position, 2 * options_.smoothing_length, 0.01 * pitch_);
  list.build(position);
  std::vector<double> result(position.size());
  with_kernel(options_, [&](const auto kernel) {
    parallel_for(position.size(), [&](std::size_t i) {
      double sum = weight[i] * kernel.value(0);
      for (const Index j : list.row(i)) {
        const auto other = static_cast<std::size_t>(j);
        sum += weight[other] * kernel.value((position[i] - position[other]).norm());
      }
      result[i] = sum;
    });
  });
  return result;
}

std::vector<double> CompactionMeasure::ratio(const Vec3Array& position) const {
  std::vector<double> ratio = sums(position, volume_);
  for (std::size_t i = 0; i < ratio.size(); ++i) ratio[i] /= placed_[i];
  return ratio;
}

std::vector<double> CompactionMeasure::smoothed(const Vec3Array& position,
                                                const std::vector<double>& ratio) const {
  std::vector<double> volume = volume_;
  for (std::size_t i = 0; i < volume.size(); ++i) volume[i] /= ratio[i];
  // The mean of V0/V weighted by V is the sum of V0 over that of V.
  std::vector<double> mean = sums(position, volume_);
  const std::vector<double> room = sums(position, volume);
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] /= room[i];
  return mean;
}

}  // namespace tuft::sph

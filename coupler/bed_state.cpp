#include "coupler/bed_state.h"

#include <span>

#include "coupler/layer_depth.h"

namespace tuft::coupler {

BedState measure_bed(const dem::DemInfill& infill, std::array<double, 2> size, double floor,
                     std::size_t layers) {
  const ParticleView grains = infill.particles();
  const std::span<const Index> clumps = infill.clumps();
  double mass = 0, volume = 0, count = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    if (grains.is_expelled(i)) continue;
    mass += grains.mass[i];
    volume += infill.solid_volume(i);
    if (i == 0 || clumps.empty() || clumps[i] < 0 || clumps[i] != clumps[i - 1]) ++count;
  }
  BedState bed;
  bed.depth = layer_tops(grains, size, floor, layers).back();
  const double room = size[0] * size[1] * bed.depth;
  if (!(room > 0) || count == 0) return bed;
  bed.bulk_density = mass / room;
  bed.porosity = 1 - volume / room;
  bed.coordination = 2 * static_cast<double>(infill.overlaps().contacts) / count;
  return bed;
}

}  // namespace tuft::coupler

#pragma once
/// How deep the infill's layers lie: the depth that placing, packing and settling really gave.
#include <array>
#include <vector>

#include "core/infill.h"

namespace tuft::coupler {

/// Height of the top of each layer above `floor`, m, layers counted from below. The top is the median, over
/// square cells two mean particle diameters of this layer wide, of the highest top of any particle of this
/// layer or one below it; cells without one do not count, nor particles outside the patch. A median: single
/// grains that climb the pile do not move it. A layer without particles ends where the one below it does.
[[nodiscard]] std::vector<double> layer_tops(const ParticleView& particles, std::array<double, 2> size,
                                             double floor, std::size_t layers);

}  // namespace tuft::coupler

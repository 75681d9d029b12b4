#pragma once
/// How a bed of grains lies: what conditioning is to change.
#include <array>

#include "dem_bridge/dem_infill.h"

namespace tuft::coupler {

struct BedState {
  double depth = 0;         ///< m, of the surface above the backing (coupler/layer_depth.h)
  double bulk_density = 0;  ///< kg/m^3, mass of the grains over patch and depth
  double porosity = 0;  ///< share of that room outside grains; overlaps count twice as grain, fibres as none
  double coordination = 0;  ///< contacts of a grain with others, mean over all that are in the turf
};

/// size: m, of the patch. floor: m, top of the backing. Asks the host for its contacts, which changes
/// nothing.
[[nodiscard]] BedState measure_bed(const dem::DemInfill& infill, std::array<double, 2> size, double floor,
                                   std::size_t layers);

}  // namespace tuft::coupler

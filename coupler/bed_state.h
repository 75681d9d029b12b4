#pragma once
/// How a bed of grains lies, and whether it lies still.
#include <array>
#include <span>
#include <vector>

#include "coupler/simulation.h"
#include "dem_bridge/dem_infill.h"

namespace tuft::coupler {

/// Whether grains are at rest. Drag is left out of the forces: grains that fall as fast as drag lets them
/// have nothing that bears them, however slow they are.
struct RestState {
  /// Sum over the grains of the size of the force that nothing balances, over their weight: of grains that
  /// fall it is 1. Forces of contacts do not measure it, for those of a few grains that are jammed outweigh
  /// the bed.
  double unborne_weight = 1;
  /// Mean size of that force over the mean force of a contact (with grains, strands, backing and walls), as
  /// is usual for packings; 1 where nothing touches.
  double unbalanced_force = 1;
  /// Kinetic energy of translation over the sum of m g d, d the grains' diameters.
  double kinetic_share = 0;
  /// Share of grains that fewer than two contacts of any kind hold.
  double rattlers = 1;
};

/// Of grains as they stand, under the gravity that they feel just now. A clump is one grain. Asks the host
/// for its contacts, which changes nothing.
[[nodiscard]] RestState measure_rest(const Simulation& simulation);

/// At rest: little force is left over, and little motion.
[[nodiscard]] bool is_at_rest(const RestState& rest, double most_unborne);
[[nodiscard]] std::vector<double> numbers_of(const RestState& rest);  ///< for files; rest_of reads them back
[[nodiscard]] RestState rest_of(std::span<const double> numbers);

struct BedState {
  double depth = 0;         ///< m, of the surface above the backing (coupler/layer_depth.h)
  double bulk_density = 0;  ///< kg/m^3, mass of the grains over patch and depth
  double porosity = 0;  ///< share of that room outside grains; overlaps count twice as grain, fibres as none
  double coordination = 0;  ///< contacts of a grain with others, mean over all that are in the turf
  RestState rest;
  double speed_median = 0, speed_percentile_99 = 0, speed_largest = 0;      ///< m/s, of spheres
  double overlap_mean = 0, overlap_percentile_99 = 0, overlap_largest = 0;  ///< over the smaller radius
};

/// Of a simulation with grains. size: m, of the patch. floor: m, top of the backing. Asks the host for its
/// contacts, which changes nothing.
[[nodiscard]] BedState measure_bed(const Simulation& simulation, std::array<double, 2> size, double floor,
                                   std::size_t layers);

[[nodiscard]] std::vector<double> numbers_of(const BedState& bed);
[[nodiscard]] BedState bed_of(std::span<const double> numbers);

}  // namespace tuft::coupler

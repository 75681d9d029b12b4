#pragma once
/// The LIGGGHTS commands and the data file that set up a simulation of grains.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dem_bridge/dem_infill.h"

namespace tuft::dem {

/// Materials that occur among the grains, sorted; LIGGGHTS' atom type is the place in this list plus 1.
[[nodiscard]] std::vector<Index> used_materials(const Grains& grains);

/// Checks what LIGGGHTS would otherwise choke on: every grain inside the box, positive radius and density,
/// finite position, material with grain properties, of one material all grains clumps or none, clumps on one
/// rank. Throws InputError naming the grain or material.
void check_grains(const Grains& grains, const std::vector<Material>& materials, const DemSettings& settings);

/// LIGGGHTS' own box, m: DemSettings::box and expulsion_margin around it.
[[nodiscard]] std::array<Vec3, 2> host_domain(const DemSettings& settings);

/// Of each of the `used` materials, whether its grains are clumps.
[[nodiscard]] std::vector<bool> clumped_materials(const Grains& grains, const std::vector<Index>& used);

/// A `read_data` file (atom style granular). Numbers have 17 digits and read back to the same bits.
[[nodiscard]] std::vector<std::uint8_t> data_file(const Grains& grains, const std::vector<Index>& used,
                                                  const std::array<Vec3, 2>& box);

struct GrainSizes {
  std::size_t count = 0;
  double smallest = 0, largest = 0;  ///< m, radii
};

/// Ranks along x and y that divide a layer of these lengths (m) with the shortest cuts.
[[nodiscard]] std::array<int, 2> rank_grid(int ranks, double length_x, double length_y);

/// All commands, one a line. `source` is "read_data FILE" or "read_restart FILE"; the rest must be the same
/// for both, because LIGGGHTS hands a restart file's history back by the ids of fixes. `clumped`: of each of
/// `used`, whether its grains are clumps; left out: none are.
[[nodiscard]] std::string set_up_commands(const std::string& source, const std::vector<Index>& used,
                                          const std::vector<Material>& materials, const DemSettings& settings,
                                          const GrainSizes& sizes, double step,
                                          const std::vector<bool>& clumped = {});

}  // namespace tuft::dem

#pragma once
/// Beds under their own weight.
#include <vector>

#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph::test {

struct ColumnSizes {
  int width = 10, rows = 20;  ///< particles
  double pitch = 0.002;       ///< m
};

struct ColumnResult {
  double worst_plane = 0;     ///< |sigma_zz - rho g depth| on planes midway between rows, over rho g H
  double mean_plane = 0;      ///< root of its mean square
  double worst_particle = 0;  ///< of single particles, over rho g H
  double floor_force = 0;     ///< over the weight
  double density_spread = 0;  ///< largest |rho/rho_0 - 1| by continuity: what the law compresses by
  /// Largest change of (rho by summation)/(rho by continuity) as it settles, inside the bed: what particles
  /// have moved and the law does not know of.
  double density_drift = 0;
  double kinetic = 0;  ///< over weight x height
};

/// A bed between slip walls, settled under damping. sigma_zz = rho g depth is asked of horizontal planes
/// midway between two rows, where the stress is the mean of the rows', over the particles two columns away
/// from the walls and two rows from floor and surface.
///
/// Single particles scatter about it by an odd-even pattern that makes no force: a zero-energy mode of the
/// one-point gradient, set off at the boundary. Within two rows of the boundary the one-sided gradient
/// doubles the weight of the outermost row in the force, so that it carries about half the stress; the force
/// on the floor is right nevertheless.
[[nodiscard]] ColumnResult geostatic_column(const Numerics& numerics, const ColumnSizes& sizes);

/// Stress under a plate over that of the law at the strain (change of height)/height, for small strains of an
/// elastic block between plates in a slip box, at rest. Contact keeps particles half a pitch away from
/// planes, and what lies between does not yield: `rows` rows are stiffer than their height is, by a share
/// that falls with their number. contact_stiffness: of a particle's spring, over constrained modulus x pitch.
[[nodiscard]] double pressed_block(const Numerics& numerics, int rows, double contact_stiffness);

/// A bed of 6 x 6 x 6, settled under damping, then stepped by dt and dt/2 in turn without: its largest
/// kinetic energy over weight x height.
[[nodiscard]] double kinetic_energy_under_changing_steps(const Numerics& numerics);

struct BedSizes {
  int width = 8, rows = 8;  ///< particles
  double pitch = 0.002;     ///< m
  int steps = 10000;
};

struct BedResult {
  std::vector<double> kinetic;  ///< J over weight x height: its largest value in each tenth of the run
  double energy_error = 0;      ///< over weight x height
  double density_drift = 0;     ///< largest change of (rho by summation)/(rho by continuity), inside the bed
  double mean_density_drift = 0;  ///< its mean
  double largest_move = 0;        ///< in the second half of the run, over the pitch
};

/// A bed put on its floor free of stress and left alone: it swings under its weight, its own viscosity brings
/// it to rest, and there it stays. No damping.
[[nodiscard]] BedResult settled_bed(const Numerics& numerics, const BedSizes& sizes);

/// Density by summation over neighbours, sum_j m_j W_ij, kg/m^3.
[[nodiscard]] std::vector<double> summed_density(const ParticleView& p, const SphOptions& options);

}  // namespace tuft::sph::test

#pragma once
/// Particles that fill a specimen between rigid walls, with rows on the walls themselves.
///
/// A lattice of rows half a pitch off its walls (make_lattice) is stiffer than its material by 2/n of n rows:
/// the half pitch at a wall does not deform. Here the outermost particles stand on the walls, as the nodes of
/// a finite-element mesh do, so that a wall's motion strains the whole depth. Volumes near a wall are such
/// that a uniform stress leaves every row in equilibrium but those on the walls (the patch test); with even
/// volumes the outer rows would give way, and the specimen be 2 to 10 % too soft. docs/theory/sph.md.
#include <vector>

#include "sph_infill/sph_infill.h"

namespace tuft::sph {

struct RingSpecimen {
  double radius = 0, height = 0;  ///< m, > 0
};
struct BoxSpecimen {
  std::array<double, 2> size{};  ///< m, x and y, > 0
  double height = 0;             ///< m, > 0
};

/// Fewest spaces between rows across a specimen's smallest side (two rings about a cylinder's axis count
/// twice): with fewer no row is away from a wall.
inline constexpr int fewest_spaces = 4;

/// Concentric rings of 6 k particles about a middle one, in rows; the axis is x = y = 0, the foot z = 0.
/// Spacings are adjusted to whole numbers over radius and height. The volumes add up to that of the cylinder
/// to rounding. Contact radii: half the spacing of rows, for all. Throws InputError for a specimen of fewer
/// spaces than fewest_spaces.
[[nodiscard]] Lattice fill_ring(const RingSpecimen& specimen, Index material, const SphOptions& options);

/// The same of a cuboid centred on x = y = 0, by an orthogonal lattice. The number of spaces in height is
/// odd, so that no row lies on the plane of halved height.
[[nodiscard]] Lattice fill_box(const BoxSpecimen& specimen, Index material, const SphOptions& options);

/// Spacings of rows over [0, 1] wall to wall, uniform but for the first and last: volumes of `rows` rows over
/// those of a row inside, for which a uniform stress is in equilibrium (corrected gradient, rows of a lattice
/// `across` wide, m); their sum is rows - 1.
[[nodiscard]] std::vector<double> row_weights(int rows, double spacing, std::array<double, 2> across,
                                              const SphOptions& options);

}  // namespace tuft::sph

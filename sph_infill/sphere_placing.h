#pragma once
/// Spheres without overlap near the points of a lattice: where a bed that is to be pressed begins.
#include <cstdint>
#include <vector>

#include "sph_infill/sph_infill.h"

namespace tuft::sph {

struct PlacingRequest {
  std::vector<double> sphere_radius;  ///< m, of spheres among themselves
  std::vector<double> wall_radius;    ///< m, of their contact with floor and walls
  LatticeBox box;
  std::uint64_t seed = 1;
};

struct Placing {
  Vec3Array position;          ///< m
  double largest_overlap = 0;  ///< over the sum of the radii, what was left
  int sweeps = 0;
};

/// Moves the points by a seeded random offset of up to a tenth of a diameter along each axis, then pushes
/// spheres that overlap apart, both by equal parts, within floor and walls and freely upwards, until no
/// overlap is larger than 1e-4 of the sum of the radii. Without the offset a bed stands in columns: it must
/// be disordered to be compacted (docs/conditioning.md). Layers whose rows are closer than a diameter come
/// out staggered. Deterministic. Throws RunError when overlaps do not go: spheres too large for the room.
[[nodiscard]] Placing place_spheres(const Lattice& lattice, const PlacingRequest& request);

}  // namespace tuft::sph

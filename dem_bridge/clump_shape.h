#pragma once
/// What a clump of overlapping spheres is as a rigid body: mass, centre of mass and inertia of the union,
/// every point of it counted once however many spheres hold it. Worked out once a shape; a grain of diameter
/// d is the shape times d.
#include <span>
#include <string_view>
#include <vector>

#include "core/materials.h"
#include "core/vector.h"

namespace tuft::dem {

/// Integrals over a union of spheres, in powers of the unit of length that the spheres have.
struct UnionMoments {
  double volume = 0;
  Vec3 first{0, 0, 0};         ///< of x, y, z
  Mat3 second = Mat3::Zero();  ///< of their products
};

/// By slices across z: each slice is a union of discs, whose moments are integrals along the arcs of its rim
/// (Green's theorem). Heights where rims change their make-up part the integral over z; between them it is
/// analytic but for square roots at the ends, which z = mid + half sin(pi t/2) takes away, so that Gauss'
/// rule of `points` converges as for smooth functions. With the default relative errors are below 1e-12
/// (tests).
[[nodiscard]] UnionMoments union_moments(std::span<const Vec3> centre, std::span<const double> radius,
                                         int points = 32);

/// A clump in lengths of its grain's diameter, which is that of the sphere of equal volume: the volume is
/// pi/6.
struct ClumpBody {
  std::vector<Vec3> centre;    ///< in principal axes about the centre of mass
  std::vector<double> radius;  ///< of the spheres
  /// Of the mass, one a sphere, for all that asks for the mass of single spheres (sums of momentum and
  /// weight, what contact takes for its stability): above 0, they add up to 1 and have the union's centre of
  /// mass. As near to the cubes of the radii as that allows.
  std::vector<double> share;
  Vec3 inertia{0, 0, 0};  ///< principal moments over m d^2, falling
  double reach = 0;       ///< from the centre of mass to the farthest point
  /// What share times mass must be multiplied by (<= 1) to be a mass that each sphere has to itself whatever
  /// the others do: spheres of that mass at these places, with spins of their own, have at most the kinetic
  /// energy of the body in every motion of it. So a step that bears each sphere's contacts on that mass bears
  /// the body's.
  double stable_share = 1;

  [[nodiscard]] std::size_t size() const { return radius.size(); }
};

/// Throws InputError, starting with "grains of NAME", where a sphere would have to weigh nothing or less for
/// shares to have the body's centre of mass.
[[nodiscard]] ClumpBody make_clump_body(const Clump& clump, std::string_view name);

/// A sphere of a clump for a stable step: the density with which it would have the mass that the clump gives
/// it to itself (share times stable_share), and how many times that the whole clump weighs, by which its
/// contacts go. density: kg/m^3, of the solid.
struct SphereOfClump {
  double density, mass_ratio;
};
[[nodiscard]] SphereOfClump sphere_of_clump(const ClumpBody& body, std::size_t sphere, double density);

}  // namespace tuft::dem

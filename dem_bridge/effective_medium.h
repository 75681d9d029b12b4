#pragma once
/// What a random packing of spheres amounts to as an elastic solid, for estimates.
#include <cmath>
#include <numbers>

namespace tuft::dem {

/// Constrained modulus K + 4/3 G, Pa, of a random packing of equal spheres that stick where they touch, under
/// a pressure (Pa): the mean-field theory of Digby and Walton (Walton 1987, doi 10.1016/0022-5096(87)90036-6;
/// in this form Mavko, Mukerji & Dvorkin, The Rock Physics Handbook, "Hertz-Mindlin"). Loose or rounded
/// packings are softer, by up to half. `solid_fraction` in (0, 1), `coordination` the mean number of contacts
/// of a sphere.
inline double packing_constrained_modulus(double young, double poisson, double solid_fraction,
                                          double coordination, double pressure) {
  const double shear = young / (2 * (1 + poisson)), touching = coordination * solid_fraction * shear,
               wide = std::numbers::pi * (1 - poisson);
  const double bulk = std::cbrt(touching * touching * pressure / (18 * wide * wide));
  const double stiff = (5 - 4 * poisson) / (5 * (2 - poisson)) *
                       std::cbrt(3 * touching * touching * pressure / (2 * wide * wide));
  return bulk + 4.0 / 3.0 * stiff;
}

}  // namespace tuft::dem

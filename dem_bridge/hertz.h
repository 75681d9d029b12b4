#pragma once
/// Hertz-Mindlin contact between two elastic spheres, as LIGGGHTS' `gran model hertz tangential history
/// rolling_friction epsd2` has it: pure functions on numbers.
///
/// Normal force 4/3 Y* sqrt(r*) d^(3/2), tangential spring stiffness 8 G* sqrt(r* d), rolling spring
/// stiffness kt r*^2 (Ai et al. 2011, doi 10.1016/j.powtec.2010.09.030), with 1/Y* = sum (1 - nu^2)/E, 1/G* =
/// sum 2 (2 - nu)(1 + nu)/E, 1/r* = sum 1/r, d the overlap.
#include <cmath>
#include <numbers>

namespace tuft::dem {

/// Effective modulus Y*, Pa, of two materials (E in Pa).
inline double effective_young_modulus(double e1, double nu1, double e2, double nu2) {
  return 1.0 / ((1 - nu1 * nu1) / e1 + (1 - nu2 * nu2) / e2);
}

/// Effective shear modulus G*, Pa.
inline double effective_shear_modulus(double e1, double nu1, double e2, double nu2) {
  return 1.0 / (2 * (2 - nu1) * (1 + nu1) / e1 + 2 * (2 - nu2) * (1 + nu2) / e2);
}

/// Elastic energy of the normal overlap, J: integral of 4/3 Y* sqrt(r*) d^(3/2) = 8/15 Y* sqrt(r*) d^(5/2).
inline double normal_energy(double young, double radius, double overlap) {
  return 8.0 / 15.0 * young * std::sqrt(radius * overlap) * overlap * overlap;
}

/// Stiffness of the tangential spring, N/m.
inline double tangential_stiffness(double shear, double radius, double overlap) {
  return 8 * shear * std::sqrt(radius * overlap);
}

/// Share of the Rayleigh time that a step may take.
inline constexpr double stable_rayleigh_share = 0.2;

/// 20 % of the Rayleigh time of one grain, s: pi r sqrt(rho/G) / (0.1631 nu + 0.8766), G = E / (2 (1 + nu))
/// (Li et al. 2005, doi 10.1016/j.powtec.2005.02.002).
inline double stable_grain_step(double radius, double density, double young, double poisson) {
  const double shear = young / (2 * (1 + poisson));
  return stable_rayleigh_share * std::numbers::pi * radius * std::sqrt(density / shear) /
         (0.1631 * poisson + 0.8766);
}

}  // namespace tuft::dem

#pragma once
/// Contact by constant springs, as LIGGGHTS' `gran model hooke tangential history` has it: pure functions on
/// numbers.
///
/// Normal force k d, tangential spring of the same stiffness k (LIGGGHTS' ktToKnUser is off), with
///
///   k = 16/15 Y* sqrt(r*) (15 m* v^2 / (16 Y* sqrt(r*)))^(1/5)
///
/// of effective modulus Y* (dem_bridge/hertz.h), radius 1/r* = sum 1/r, mass 1/m* = sum 1/m, and the
/// characteristic velocity v. It follows from equal largest overlap of an elastic head-on collision at v:
/// Hertz's law stops at 8/15 Y* sqrt(r*) d^(5/2) = m* v^2/2, the spring at k d^2/2 = m* v^2/2.
#include <algorithm>
#include <cmath>
#include <numbers>

namespace tuft::dem {

/// N/m. young: Y*, Pa; radius: r*, m; mass: m*, kg; velocity: m/s.
inline double hooke_stiffness(double young, double radius, double mass, double velocity) {
  const double per_root = young * std::sqrt(radius);
  return 16.0 / 15.0 * per_root * std::pow(15.0 * mass * velocity * velocity / (16.0 * per_root), 0.2);
}

/// Damping ratio of a spring and dashpot that throws back the share `restitution` of the speed.
inline double hooke_damping_ratio(double restitution) {
  const double log = std::log(restitution);
  return -log / std::sqrt(log * log + std::numbers::pi * std::numbers::pi);
}

/// s, of a head-on collision: half a period of m* on the spring, longer by damping.
inline double hooke_contact_time(double stiffness, double mass, double restitution) {
  const double ratio = hooke_damping_ratio(restitution);
  return std::numbers::pi * std::sqrt(mass / stiffness / (1 - ratio * ratio));
}

/// Largest stable step, s, of a grain of `mass` (kg) among equals, central differences with dashpots that see
/// the velocity half a step before. Twelve contacts, the most that equal spheres have, with tangential
/// springs k and normal ones `normal_ratio` = q (>= 1) times as stiff: energies of both ends of a contact add
/// up to at most q k (u.n)^2 + k |u_t + r theta x n|^2 each, which for contacts all around (sum n n^T = 4)
/// gives omega^2 <= (8 q + 16) k/m of motion and 2 (2/3 12 k r^2 / (2/5 m r^2)) = 40 k/m of spin; the larger
/// counts. Dashpots go by k: the damping ratio of that mode is that of a pair (omega0^2 = 2 k/m) times the
/// largest omega of springs k, over omega and omega0. Stable: omega dt <= 2 (sqrt(1 + z^2) - z). Dashpots go
/// by mass_ratio times the mass (of a clump's spheres, which each count with the whole clump's).
inline double stable_hooke_step(double stiffness, double mass, double restitution, double normal_ratio = 1,
                                double mass_ratio = 1) {
  const double of_equal_springs = std::sqrt(40 * stiffness / mass);
  const double omega = std::sqrt(std::max(8 * normal_ratio + 16, 40.0) * stiffness / mass);
  const double z = std::sqrt(mass_ratio) * hooke_damping_ratio(restitution) *
                   (of_equal_springs / std::sqrt(2 * stiffness / mass)) * (of_equal_springs / omega);
  return 2 * (std::sqrt(1 + z * z) - z) / omega;
}

}  // namespace tuft::dem

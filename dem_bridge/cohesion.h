#pragma once
/// Cohesion of two grains, as LIGGGHTS' `cohesion sjkr` has it ("simplified Johnson-Kendall-Roberts"): a
/// force k A that pulls them together while they overlap, A the circle in which their surfaces meet, k a
/// cohesion energy density (J/m^3). Pure functions on numbers.
///
/// With S = r1 + r2, D = r1 - r2 and the distance r of centres, A = pi/4 (S^2 - r^2)(r^2 - D^2)/r^2. The
/// volume of the lens that both spheres share grows by A dr as they come closer by dr; so the force's energy
/// is -k times that volume: k is an energy per volume of overlap indeed.
#include <cmath>
#include <numbers>

namespace tuft::dem {

/// A, m^2; 0 where they do not touch.
inline double cohesion_area(double radius1, double radius2, double distance) {
  const double sum = radius1 + radius2, difference = radius1 - radius2, squared = distance * distance;
  if (distance >= sum) return 0;
  return 0.25 * std::numbers::pi * (sum - distance) * (sum + distance) * (squared - difference * difference) /
         squared;
}

/// Volume that both spheres share, m^3: pi d^2 (r^2 + 2 r S - 3 D^2) / (12 r), d = S - r.
inline double overlap_volume(double radius1, double radius2, double distance) {
  const double sum = radius1 + radius2, difference = radius1 - radius2, overlap = sum - distance;
  if (overlap <= 0) return 0;
  return std::numbers::pi * overlap * overlap *
         (distance * distance + 2 * distance * sum - 3 * difference * difference) / (12 * distance);
}

/// Overlap at which cohesion and Hertz's force balance, over r*: 9/4 (pi k/Y*)^2, for overlaps small beside
/// the grains (A = 2 pi r* d).
inline double cohesive_overlap(double cohesion, double young) {
  const double ratio = std::numbers::pi * cohesion / young;
  return 2.25 * ratio * ratio;
}

/// Largest force, N, with which cohesion holds two grains against Hertz's law: 2/3 pi^3 k^3 r*^2/Y*^2, where
/// the overlap is 4/9 of that at balance. Small overlaps, as above.
inline double pull_off_force(double cohesion, double young, double radius) {
  const double scaled = std::numbers::pi * cohesion;
  return 2.0 / 3.0 * scaled * scaled * scaled * radius * radius / (young * young);
}

}  // namespace tuft::dem

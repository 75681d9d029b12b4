#pragma once
/// Plastic contact by constant springs, as LIGGGHTS' `gran model hooke/hysteresis` has it (Walton & Braun
/// 1986, doi 10.1122/1.549893; Luding 2008, doi 10.1007/s10035-008-0099-x): pure functions on numbers.
///
/// A contact remembers its largest overlap D. With the stiffness k of first loading (dem_bridge/hooke.h), it
/// unloads and is loaded again on a stiffer line,
///
///   F = k d                       while d = D grows,
///   F = k2 (d - D) + k D          below, k2 = k + (k_max - k) D/D_max,
///   F = -kc d                     where that line would pull harder; D then shrinks so that the line meets
///   it,
///
/// so a dent of D (1 - k/k2) stays. From D_max = k_max/(k_max - k) phi 2 r* on no dent grows, and the contact
/// is elastic with k_max. A pair that has parted has forgotten all of it.
#include <algorithm>

namespace tuft::dem {

/// Ratios of one kind of contact. All are kept by coarse graining: F grows as n^2 where d and r* grow as n.
struct Hysteresis {
  double unloading_ratio = 0;  ///< > 1, k_max/k
  double plastic_depth = 0;    ///< > 0, phi: the deepest dent over 2 r*
  double adhesion_ratio = 0;   ///< >= 0, kc/k
};

/// D_max, m.
inline double largest_plastic_overlap(const Hysteresis& law, double radius) {
  return law.unloading_ratio / (law.unloading_ratio - 1) * law.plastic_depth * 2 * radius;
}

/// k2, N/m, of a contact whose largest overlap was `largest` (m).
inline double unloading_stiffness(const Hysteresis& law, double stiffness, double radius, double largest) {
  const double share = std::min(1.0, largest / largest_plastic_overlap(law, radius));
  return stiffness * (1 + (law.unloading_ratio - 1) * share);
}

/// N, without damping. overlap: d, m, > 0; largest: D, m, >= d unless it is being loaded for the first time.
inline double hysteretic_force(const Hysteresis& law, double stiffness, double radius, double overlap,
                               double largest) {
  const double dented = std::min(std::max(largest, overlap), largest_plastic_overlap(law, radius));
  const double line =
      unloading_stiffness(law, stiffness, radius, dented) * (overlap - dented) + stiffness * dented;
  return std::max(line, -law.adhesion_ratio * stiffness * overlap);
}

/// What the contact gives back, J: F^2/(2 k2), of the line that it is on. Along first loading and along the
/// limit of adhesion the rest of the work is lost.
inline double hysteretic_energy(const Hysteresis& law, double stiffness, double radius, double overlap,
                                double largest) {
  const double force = hysteretic_force(law, stiffness, radius, overlap, largest);
  return 0.5 * force * force / unloading_stiffness(law, stiffness, radius, std::max(largest, overlap));
}

}  // namespace tuft::dem

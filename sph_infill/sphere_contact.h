#pragma once
/// The force between two soft spheres: linear spring and dashpot along the line of centres, Coulomb friction
/// with a tangential spring. A pure function of one pair.
#include <algorithm>
#include <cmath>

#include "core/vector.h"

namespace tuft::sph {

/// Tangential over normal stiffness. With 2/7 a solid sphere's tangential motion, its turning included, is as
/// quick as its normal motion: (1/m + r^2/I) k_t = (7/2) k_t/m = k/m (Silbert et al. 2001).
inline constexpr double tangential_ratio = 2.0 / 7.0;

struct SphereBond {
  double stiffness = 0;  ///< N/m, k
  double dashpot = 0;    ///< N s/m, c = 2 zeta sqrt(k m), m the pair's effective mass
  double friction = 0;   ///< Coulomb's coefficient
};

/// One moment of a pair that overlaps, as the first sphere sees it.
struct SphereMotion {
  double overlap = 0;      ///< m, > 0
  Vec3 normal{0, 0, 1};    ///< unit, from the second centre to the first
  Vec3 velocity{0, 0, 0};  ///< m/s, of the first relative to the second, at the point of contact
  double step_before = 0;  ///< s, of the drift that led here
};

struct SphereForce {
  Vec3 spring{0, 0, 0};                             ///< N on the first: k overlap normal
  Vec3 other{0, 0, 0};                              ///< N on the first: dashpot and friction
  double normal_energy = 0, tangential_energy = 0;  ///< J, in the springs
};

/// F = k d n + other. Along n the dashpot can take the spring's force away, never pull. Across, T = -k_t s -
/// c_t v_t with the slip s since first touch, turned into the present tangent plane at its length and cut so
/// that |T| <= mu |F_n|; `slip` (m) is what the pair remembers. An exchange of the two spheres turns every
/// sign.
[[nodiscard]] inline SphereForce sphere_force(const SphereBond& bond, const SphereMotion& motion,
                                              Vec3& slip) {
  SphereForce result;
  const double spring_force = bond.stiffness * motion.overlap;
  const double approach = -motion.velocity.dot(motion.normal);
  const double pressed = std::max(0.0, spring_force + bond.dashpot * approach);
  result.spring = spring_force * motion.normal;
  result.other = (pressed - spring_force) * motion.normal;
  result.normal_energy = 0.5 * spring_force * motion.overlap;

  const Vec3 slip_velocity = motion.velocity + approach * motion.normal;
  const double length = slip.squaredNorm();
  Vec3 turned = slip - slip.dot(motion.normal) * motion.normal;
  if (const double in_plane = turned.squaredNorm(); in_plane > 0) turned *= std::sqrt(length / in_plane);
  turned += motion.step_before * slip_velocity;
  const double stiffness = tangential_ratio * bond.stiffness, dashpot = tangential_ratio * bond.dashpot;
  Vec3 tangential = -stiffness * turned - dashpot * slip_velocity;
  const double limit = bond.friction * pressed, size = tangential.norm();
  if (size > limit) {
    tangential *= limit / size;
    turned = -tangential / stiffness;  // what the cut leaves, or the slip would be stored and come back
  }
  slip = turned;
  result.other += tangential;
  result.tangential_energy = 0.5 * stiffness * turned.squaredNorm();
  return result;
}

}  // namespace tuft::sph

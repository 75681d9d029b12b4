#pragma once
/// The force of one contact: linear penalty, normal damping, Coulomb friction with a tangential spring. Pure
/// functions of their arguments; who touches whom is decided elsewhere.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/scene.h"
#include "core/vector.h"

namespace tuft::coupler {

/// Normal spring. Linear, or one that stiffens as the infill behind it does: the stiffness grows with the
/// force, dF/dD = k + s F, so F = k/s (exp(s D) - 1), up to the overlap `end`, beyond which it stays.
struct NormalSpring {
  double stiffness = 0;                                  ///< N/m, > 0: k, at touch
  double stiffening = 0;                                 ///< 1/m, >= 0: s
  double end = std::numeric_limits<double>::infinity();  ///< m, > 0

  [[nodiscard]] double tangent(double overlap) const {
    return stiffening > 0 ? stiffness * std::exp(stiffening * std::min(overlap, end)) : stiffness;
  }
  [[nodiscard]] double force(double overlap) const {
    if (!(stiffening > 0)) return stiffness * overlap;
    if (overlap > end) return force(end) + tangent(end) * (overlap - end);
    return stiffness / stiffening * std::expm1(stiffening * overlap);
  }
  /// J, from touch to the overlap.
  [[nodiscard]] double energy(double overlap) const {
    if (!(stiffening > 0)) return 0.5 * stiffness * overlap * overlap;
    if (overlap > end)
      return energy(end) + (force(end) + 0.5 * tangent(end) * (overlap - end)) * (overlap - end);
    return stiffness / stiffening * (std::expm1(stiffening * overlap) / stiffening - overlap);
  }
  struct State {
    double tangent, force, energy;
  };
  /// All of them at once, of one exponential.
  [[nodiscard]] State at(double overlap) const {
    if (!(stiffening > 0)) return {stiffness, stiffness * overlap, 0.5 * stiffness * overlap * overlap};
    if (overlap > end) return {tangent(end), force(overlap), energy(overlap)};
    const double rise = std::expm1(stiffening * overlap), per_stiffening = stiffness / stiffening;
    return {stiffness * (1 + rise), per_stiffening * rise, per_stiffening * (rise / stiffening - overlap)};
  }
};

/// What stays the same while two things touch.
struct ContactParameters {
  NormalSpring spring;       ///< from the materials
  double damping_ratio = 0;  ///< [0, 1), of the critical damping of the tangent stiffness and effective mass
  double tangential_ratio =
      0.5;  ///< tangential over normal stiffness (Mindlin: 2(1-nu)/(2-nu), 0.7-1; assumed lower, softer)
  FrictionLaw friction;
};

/// What a contact remembers.
struct ContactHistory {
  /// J^1/2, tangential spring: elongation times the root of its stiffness, so that half its square is the
  /// energy it holds, whatever becomes of the stiffness as the contact moves from element to element.
  Vec3 spring{0, 0, 0};
  Vec3 tangential{0, 0, 0};  ///< N, tangential force at the last step
  double dashpot = 0;   ///< N, what the overlap is pushed with beyond the spring's force at the last step
  double offset = 0;    ///< J^1/2, initial overlap not yet let go, times the root of the stiffness
  double side = 0;      ///< +1 or -1: side of a shell the particle came from; 0 while apart
  double distance = 0;  ///< m, of the centre from the shell on that side when last looked at, < 0 beyond
};

/// One moment of a contact whose potential is the spring's energy at an overlap D. `normal` is a unit vector
/// from the other body towards the particle.
struct ContactKinematics {
  double overlap = 0;  ///< m, D > 0, after the offset is taken off
  Vec3 normal{0, 0, 1};
  Vec3 velocity{0, 0, 0};     ///< m/s, particle relative to the other, at the contact point
  double effective_mass = 0;  ///< kg, 1 / (1/m1 + 1/m2), of motion along D
  double closing = 0;         ///< m/s, rate at which D grows
  double gradient = 1;        ///< |grad D|, >= 0: 1 but where facets share a contact
};

/// Energies are of this contact alone: `elastic` is a state, the others happened over the step.
struct ContactForce {
  Vec3 force{0, 0, 0};  ///< N on the particle
  double pressed = 0;   ///< N, normal part of the force over the overlap's gradient
  double elastic = 0;   ///< J, normal and tangential springs
  double damped = 0;    ///< J
  double friction = 0;  ///< J
};

/// Coefficient of restitution of a linear spring-dashpot that never pulls (Schwager & Poeschel 2007, Granular
/// Matter 9, 465): e = exp(-zeta/s (pi - atan2(2 zeta s, 1 - 2 zeta^2))), s = sqrt(1 - zeta^2); zeta in [0,
/// 1).
inline double restitution_of_damping_ratio(double zeta) {
  const double s = std::sqrt(1 - zeta * zeta);
  return std::exp(-zeta / s * (std::numbers::pi - std::atan2(2 * zeta * s, 1 - 2 * zeta * zeta)));
}

/// Its inverse by bisection. Restitution under 0.14 (more than critical damping) gives 0.999.
inline double damping_ratio_of_restitution(double restitution) {
  double low = 0, high = 0.999;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (restitution_of_damping_ratio(middle) > restitution ? low : high) = middle;
  }
  return restitution >= 1 ? 0 : 0.5 * (low + high);
}

/// Energy put into a normal spring by letting `let_go` (m) of its offset go over a step in which motion alone
/// added `moved` (m) to its overlap: under the mean of the forces before and after, as leapfrog's kicks do
/// the rest of the spring's work. (For an overlap held fast, as if nothing moved, the work of a step would be
/// off by half of stiffness x let_go x moved, and an overlap let go slowly moves nearly as far as it is let
/// go.)
inline double release_work(const NormalSpring& spring, double overlap, double let_go, double moved) {
  const double before = std::max(0.0, overlap - let_go - moved);
  return 0.5 * (spring.force(overlap) + spring.force(before)) * let_go;
}

/// mu(v) = FD + (FS - FD) exp(-DC v).
inline double friction_coefficient(const FrictionLaw& law, double speed) {
  return law.dynamic_coefficient +
         (law.static_coefficient - law.dynamic_coefficient) * std::exp(-law.decay * speed);
}

/// Along D: P = max(0, F(D) + c D'), c = 2 zeta sqrt(F'(D) m), and the particle feels -P grad D. No adhesion:
/// the dashpot can take the spring's force away but never pull. Tangential: spring and dashpot against the
/// slip since touch, cut at mu(v) N, N = P |grad D|; the spring follows the cut, so that reversal starts from
/// a loaded spring. The spring is turned into the present tangent plane.
///
/// Work is booked over the displacement that led here, v dt with the velocity half a step ago, under the mean
/// of the forces before and after it. Summed over the steps of a contact that is the work which leapfrog's
/// kicks do, sum F_k (v_k-1/2 + v_k+1/2)/2 dt, but for the turn of the contact within a step; booked with
/// this step's force alone, light nodes under strong friction would seem to lose more than they had.
inline ContactForce compute_contact_force(const ContactParameters& p, const ContactKinematics& c, double dt,
                                          ContactHistory& history) {
  ContactForce result;
  const auto [stiffness, spring_force, spring_energy] = p.spring.at(c.overlap);
  const double dashpot = 2.0 * p.damping_ratio * std::sqrt(stiffness * c.effective_mass);
  const double pressed = std::max(0.0, spring_force + dashpot * c.closing);
  const double beyond_spring = pressed - spring_force, normal_force = pressed * c.gradient;
  result.damped = 0.5 * (history.dashpot + beyond_spring) * c.closing * dt;
  history.dashpot = beyond_spring;

  const double root = std::sqrt(p.tangential_ratio * stiffness);
  const Vec3 slip_velocity = c.velocity - c.velocity.dot(c.normal) * c.normal;
  Vec3 spring = history.spring - history.spring.dot(c.normal) * c.normal;
  const double turned = spring.squaredNorm(), length = history.spring.squaredNorm();
  if (turned > 0) spring *= std::sqrt(length / turned);
  const double stored_before = 0.5 * length;

  spring += root * dt * slip_velocity;
  const double tangential_dashpot = dashpot * std::sqrt(p.tangential_ratio);
  Vec3 tangential = -root * spring - tangential_dashpot * slip_velocity;
  const double limit = friction_coefficient(p.friction, slip_velocity.norm()) * normal_force;
  const double size = tangential.norm();
  if (size > limit) {
    tangential *= limit / size;
    // The spring carries what the cut leaves; without this the slip would be stored and come back.
    spring = -tangential / root;
  }
  history.spring = spring;
  const double stored = 0.5 * spring.squaredNorm();
  result.friction = -0.5 * (history.tangential + tangential).dot(c.velocity) * dt - (stored - stored_before);
  history.tangential = tangential;
  result.elastic = spring_energy + stored;
  result.pressed = pressed;
  result.force = normal_force * c.normal + tangential;
  return result;
}

/// Energy that the tangential spring of a contact loses when the two part: it goes to friction.
inline double release_spring(ContactHistory& history) {
  const double stored = 0.5 * history.spring.squaredNorm();
  history.spring = history.tangential = Vec3(0, 0, 0);
  history.dashpot = 0;
  return stored;
}

}  // namespace tuft::coupler

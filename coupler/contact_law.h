#pragma once
/// The force of one contact: linear penalty, normal damping, Coulomb friction with a tangential spring. Pure
/// functions of their arguments; who touches whom is decided elsewhere.
#include <cmath>
#include <numbers>

#include "core/scene.h"
#include "core/vector.h"

namespace tuft::coupler {

/// What stays the same while two things touch.
struct ContactParameters {
  double stiffness = 0;      ///< N/m, > 0: normal penalty, from the materials
  double damping_ratio = 0;  ///< [0, 1), of the critical damping of stiffness and effective mass
  double tangential_ratio =
      0.5;  ///< tangential over normal stiffness (Mindlin: 2(1-nu)/(2-nu), 0.7-1; assumed lower, softer)
  FrictionLaw friction;
};

/// What a contact remembers.
struct ContactHistory {
  Vec3 spring{0, 0, 0};  ///< m, tangential spring, of the particle relative to the other
  double offset = 0;     ///< m, initial overlap not yet let go
  double side = 0;       ///< +1 or -1: side of a shell the particle came from; 0 while apart
};

/// One moment of a contact. `normal` is a unit vector from the other body towards the particle.
struct ContactKinematics {
  double overlap = 0;  ///< m, > 0, after the offset is taken off
  Vec3 normal{0, 0, 1};
  Vec3 velocity{0, 0, 0};     ///< m/s, particle relative to the other, at the contact point
  double effective_mass = 0;  ///< kg, 1 / (1/m1 + 1/m2)
};

/// Energies are of this contact alone: `elastic` is a state, the others happened over the step.
struct ContactForce {
  Vec3 force{0, 0, 0};  ///< N on the particle
  double elastic = 0;   ///< J, normal and tangential springs
  double damped = 0;    ///< J
  double friction = 0;  ///< J
};

/// Damping ratio that gives a linear spring-dashpot the coefficient of restitution e:
/// zeta = -ln e / sqrt(pi^2 + ln^2 e).
inline double damping_ratio_of_restitution(double restitution) {
  const double log_e = std::log(restitution);
  return -log_e / std::sqrt(std::numbers::pi * std::numbers::pi + log_e * log_e);
}

/// mu(v) = FD + (FS - FD) exp(-DC v).
inline double friction_coefficient(const FrictionLaw& law, double speed) {
  return law.dynamic_coefficient +
         (law.static_coefficient - law.dynamic_coefficient) * std::exp(-law.decay * speed);
}

/// Normal: N = max(0, k d + c v_in), c = 2 zeta sqrt(k m). No adhesion: the dashpot can take the spring's
/// force away but never pull. Tangential: spring and dashpot against the slip since touch, cut at mu(v) N;
/// the spring follows the cut, so that reversal starts from a loaded spring. The spring is turned into the
/// present tangent plane.
///
/// Friction work is what the mean of the tangential force before and after did, less what the spring stored:
/// with the mean, an ideal spring dissipates nothing at any step size.
inline ContactForce compute_contact_force(const ContactParameters& p, const ContactKinematics& c, double dt,
                                          ContactHistory& history) {
  ContactForce result;
  const double closing = -c.velocity.dot(c.normal);
  const double dashpot = 2.0 * p.damping_ratio * std::sqrt(p.stiffness * c.effective_mass);
  const double spring_force = p.stiffness * c.overlap;
  const double normal_force = std::max(0.0, spring_force + dashpot * closing);
  result.damped = (normal_force - spring_force) * closing * dt;

  const double tangential_stiffness = p.tangential_ratio * p.stiffness;
  const Vec3 slip_velocity = c.velocity + closing * c.normal;
  Vec3 spring = history.spring - history.spring.dot(c.normal) * c.normal;
  const double turned = spring.squaredNorm(), length = history.spring.squaredNorm();
  if (turned > 0) spring *= std::sqrt(length / turned);
  const double stored_before = 0.5 * tangential_stiffness * length;
  const Vec3 force_before = -tangential_stiffness * spring;

  spring += slip_velocity * dt;
  const double tangential_dashpot = dashpot * std::sqrt(p.tangential_ratio);
  Vec3 tangential = -tangential_stiffness * spring - tangential_dashpot * slip_velocity;
  const double limit = friction_coefficient(p.friction, slip_velocity.norm()) * normal_force;
  const double size = tangential.norm();
  if (size > limit) {
    tangential *= limit / size;
    // The spring carries what the cut leaves; without this the slip would be stored and come back.
    spring = -tangential / tangential_stiffness;
  }
  history.spring = spring;
  const double stored = 0.5 * tangential_stiffness * spring.squaredNorm();
  result.friction = -0.5 * (force_before + tangential).dot(slip_velocity) * dt - (stored - stored_before);
  result.elastic = 0.5 * p.stiffness * c.overlap * c.overlap + stored;
  result.force = normal_force * c.normal + tangential;
  return result;
}

/// Energy that the tangential spring of a contact loses when the two part: it goes to friction.
inline double release_spring(const ContactParameters& p, ContactHistory& history) {
  const double stored = 0.5 * p.tangential_ratio * p.stiffness * history.spring.squaredNorm();
  history.spring = Vec3(0, 0, 0);
  return stored;
}

}  // namespace tuft::coupler

#pragma once
/// Contact of points with a radius (infill particles, or carpet nodes with half a thickness) with rigid
/// bodies.
#include <span>
#include <vector>

#include "core/infill.h"
#include "coupler/contact_law.h"
#include "coupler/contact_pairs.h"
#include "coupler/rigid_body.h"

namespace tuft::coupler {

struct BodyContactSettings {
  std::vector<NormalSpring> spring;   ///< per point
  std::vector<double> damping_ratio;  ///< per point
  std::vector<FrictionLaw> friction;  ///< per point, against bodies that have none of their own
  /// Per point, at bodies that are upright walls; empty: `spring`.
  std::vector<NormalSpring> wall_spring{};
  /// Per point, against bodies whose surface is the carpet's; empty: `friction`.
  std::vector<FrictionLaw> carpet_friction{};
};

/// Impulses on bodies and their tally, one entry a body.
struct BodyImpulses {
  std::vector<Vec3> impulse;  ///< N s
};

class BodyContact {
 public:
  explicit BodyContact(BodyContactSettings settings);

  /// Pairs closer than touching + skin; points with skip[i] != 0 take no part (skip may be empty).
  void search(const ParticleView& points, const std::vector<RigidBody>& bodies, double skin,
              bool keep_overlap, std::span<const std::uint8_t> skip = {});

  /// One substep with points where they stand and bodies moved along their velocity by `ahead` (s). Adds
  /// `weight` times the force (N) to `linear` (weight 1: forces, weight dt: impulses), impulses about the
  /// points' centres (N m s) to `angular` when it is not null, and impulses on bodies. Between points that
  /// have kicks of their own (ParticleView::kicks) and bodies that cannot move the step is the kick's, where
  /// there is one; the others stay as they are.
  void evaluate(const ParticleView& points, const std::vector<RigidBody>& bodies, double ahead, double dt,
                double release, double release_before, double weight, Vec3Array& linear, Vec3Array* angular,
                BodyImpulses& on_bodies);

  /// Adds the forces that an evaluation over `dt` would find now, without making it (contact_forces.cpp).
  void list_forces(const ParticleView& points, const std::vector<RigidBody>& bodies, double dt,
                   double release, double release_before, ContactNetwork& network) const;

  /// Ends all contact with a body before it is taken away: normal springs count as damped, tangential ones as
  /// friction.
  void let_go(Index body, const ParticleView& points, const std::vector<RigidBody>& bodies, double release);

  /// From now on points press bodies with other springs, the same at walls. What touching springs held more
  /// than their successors do is booked as damped.
  void replace_springs(std::vector<NormalSpring> springs, const ParticleView& points,
                       const std::vector<RigidBody>& bodies, double release);

  [[nodiscard]] const ContactEnergy& energy() const { return energy_; }
  [[nodiscard]] const InitialOverlap& initial_overlap() const { return initial_overlap_; }
  [[nodiscard]] const BodyContactSettings& settings() const { return settings_; }
  [[nodiscard]] std::size_t pair_count() const { return keys_.size(); }
  /// Largest stable step of each point's contacts alone, s, over the coming `horizon` (s): 2/omega, infinite
  /// where nothing is near. Of the springs that stiffen only those near a body count, with the overlap that
  /// they will have at the end of it as they close in now; before the first search, all with the most they
  /// can stiffen. `with_dashpots`: (2/omega)(sqrt(1 + zeta^2) - zeta), for the dashpot's force is taken from
  /// the velocity half a step before; and a point between several bodies feels the tangential springs of the
  /// others beside the normal one.
  [[nodiscard]] std::vector<double> stable_steps(const ParticleView& points,
                                                 const std::vector<RigidBody>& bodies, double horizon,
                                                 bool with_dashpots) const;

  /// The least of them.
  [[nodiscard]] double least_stable_step(const ParticleView& points, const std::vector<RigidBody>& bodies,
                                         double horizon, bool with_dashpots) const;

  /// Of those steps, makes infinite what is of points far from all bodies.
  void leave_near(std::vector<double>& steps) const;

  /// Raises `rates` (1/s, one a point) to what points near a body need: the inverse of `stable_steps`,
  /// infinite beside a body that can move.
  void raise_rates(const ParticleView& points, const std::vector<RigidBody>& bodies, double horizon,
                   bool with_dashpots, std::vector<float>& rates) const;

  void save(h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  struct Result {
    ContactForce contact;
    Vec3 arm{0, 0, 0};
    double released = 0;
    double weight = 0;  ///< of the force, in impulses on points
    double dt = 0;      ///< s, of the force, in impulses on bodies
    bool touching = false;
  };
  Result evaluate_pair(std::size_t pair, const ParticleView& points, const std::vector<RigidBody>& bodies,
                       double ahead, double dt, double release, double release_before);
  /// m, of a point where it stands.
  static double overlap_of(Index point, const RigidBody& body, const ParticleView& points);
  [[nodiscard]] const NormalSpring& spring_of(Index point, const RigidBody& body) const {
    const auto i = static_cast<std::size_t>(point);
    return settings_.wall_spring.empty() || !body.is_upright_wall() ? settings_.spring[i]
                                                                    : settings_.wall_spring[i];
  }
  [[nodiscard]] const FrictionLaw& friction_of(Index point, const RigidBody& body) const {
    const auto i = static_cast<std::size_t>(point);
    if (body.friction) return *body.friction;
    return body.is_carpet && !settings_.carpet_friction.empty() ? settings_.carpet_friction[i]
                                                                : settings_.friction[i];
  }
  /// Of a point with kicks of its own and a body that cannot move.
  void evaluate_kicked_pair(std::size_t pair, const ParticleView& points,
                            const std::vector<RigidBody>& bodies, double dt, double release,
                            double release_before);
  /// Adds what a pair, just evaluated, gives.
  void sum_up(std::size_t pair, Vec3Array& linear, Vec3Array* angular, ContactEnergy& energy,
              Vec3* on_bodies) const;
  /// N/m, of a point's springs as far as they do not depend on pairs, see stable_steps.
  [[nodiscard]] double stiffness_apart(std::size_t point) const;
  /// s, of a point near so many bodies under springs of that stiffness, see stable_steps.
  [[nodiscard]] double step_under(double stiffness, std::size_t point, int near, const ParticleView& points,
                                  bool with_dashpots) const;
  /// take(its first pair, point, its stable step, whether one of its bodies can move) for all near a body, on
  /// all threads.
  template <class Take>
  void for_near_points(const ParticleView& points, const std::vector<RigidBody>& bodies, double horizon,
                       bool with_dashpots, Take&& take) const;
  /// N/m, of a pair's spring if it stiffens, at the end of `horizon` (s); 0: apart.
  [[nodiscard]] double coming_stiffness(PairKey key, const ParticleView& points,
                                        const std::vector<RigidBody>& bodies, double horizon) const;

  BodyContactSettings settings_;
  bool all_stiffen_ = false;  ///< springs
  std::vector<PairKey> keys_;
  std::vector<ContactHistory> histories_;
  std::vector<Result> results_;
  std::vector<ContactEnergy> part_energy_;  ///< scratch of `evaluate`, by part of the pairs
  std::vector<Vec3> part_on_bodies_;        ///< N s, likewise, by part and body
  ContactEnergy energy_;
  InitialOverlap initial_overlap_;
  bool searched_ = false;
};

}  // namespace tuft::coupler

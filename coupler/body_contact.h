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
  /// Of a point's radius, that edges of upright cylinders are rounded by for it (docs/theory/contact.md): 1
  /// for particles of a continuum.
  double rim_over_radius = 0;
};

/// Of one window, one entry a body.
struct BodyImpulses {
  std::vector<Vec3> impulse;  ///< N s, given
  std::vector<Vec3>
      until_now;  ///< N s, of that, before the moment of the forces: half, but at irregular kicks
  /// N s, of forces as last found, for as long as the window is: what a gauge at the body reads. The same as
  /// `impulse` where points have no kicks of their own; else a kick may give what several windows hold.
  std::vector<Vec3> measured;

  void reset(std::size_t bodies) {
    impulse.assign(bodies, Vec3::Zero());
    until_now.assign(bodies, Vec3::Zero());
    measured.assign(bodies, Vec3::Zero());
  }
};

class BodyContact {
 public:
  explicit BodyContact(BodyContactSettings settings);

  /// Pairs closer than touching + skin; points with skip[i] != 0 take no part (skip may be empty).
  void search(const ParticleView& points, const std::vector<RigidBody>& bodies, double skin,
              bool keep_overlap, std::span<const std::uint8_t> skip = {});

  /// One substep with points where they stand and bodies moved along their velocity by `ahead` (s). Adds
  /// `weight` times the force (N) to `linear` (weight 1: forces, weight dt: impulses), impulses about the
  /// points' centres (N m s) to `angular` when it is not null, and impulses on bodies. Of points that have
  /// kicks of their own (ParticleView::kicks) the step is the kick's, where there is one; the others stay as
  /// they are.
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
  /// How a pair stands and closes in; it refers to the springs of the contact that found it.
  struct Approach {
    Vec3 normal{0, 0, 1};  ///< unit, out of the body
    double overlap = 0;    ///< m, below 0: apart
    double closing = 0;    ///< m/s
    double radius = 0;     ///< m, of the point along the normal
    const NormalSpring* spring = nullptr;

    /// N/m, after `horizon` (s) at that speed; 0: apart. Springs that do not stiffen have theirs always.
    [[nodiscard]] double stiffness_after(double horizon) const;
  };
  /// Of all pairs, now; of one with a constant spring at the only body near its point, which cannot move, the
  /// spring alone.
  void look(const ParticleView& points, const std::vector<RigidBody>& bodies,
            std::vector<Approach>& approaches) const;

  /// Largest stable step of each point's contacts alone, s, over the coming `horizon` (s): 2/omega, infinite
  /// where nothing is near. approaches: of `look`, now. Of the springs that stiffen only those near a body
  /// count, with the overlap that they will have at the end of it as they close in now; before the first
  /// search, all with the most they can stiffen. `with_dashpots`: (2/omega)(sqrt(1 + zeta^2) - zeta), for the
  /// dashpot's force is taken from the velocity half a step before; and a point between several bodies feels
  /// the springs and the dashpots of all, normal and tangential, each as in the direction in which they are
  /// most together.
  [[nodiscard]] std::vector<double> stable_steps(const ParticleView& points,
                                                 std::span<const Approach> approaches, double horizon,
                                                 bool with_dashpots) const;

  /// The least of them.
  [[nodiscard]] double least_stable_step(const ParticleView& points, std::span<const Approach> approaches,
                                         double horizon, bool with_dashpots) const;

  /// Of those steps, makes infinite what is of points far from all bodies.
  void leave_near(std::vector<double>& steps) const;

  /// Raises `rates` (1/s, one a point) to what points near a body need: the inverse of `stable_steps`.
  /// Beside a body that can move also `least_beside_moving` and the inverse of steps that take a tenth, at
  /// most, of what is stable for the body's mass on all its springs, or close in by a tenth of a point's
  /// radius.
  void raise_rates(const ParticleView& points, const std::vector<RigidBody>& bodies,
                   std::span<const Approach> approaches, double horizon, bool with_dashpots,
                   double least_beside_moving, std::vector<float>& rates) const;

  void save(h5::Group& group) const;
  /// bodies: how many there are.
  void load(const h5::Group& group, std::size_t bodies);

 private:
  /// Pairs from which on other threads are called in.
  static constexpr std::size_t least_for_threads = 1024;

  struct Result {
    ContactForce contact;
    Vec3 arm{0, 0, 0};
    double released = 0;
    double weight = 0;  ///< of the force, in impulses on points
    double dt = 0;      ///< s, of the force, in impulses on bodies
    double lag = 0;     ///< s, of that, before the moment of the force
    bool touching = false;
  };
  Result evaluate_pair(std::size_t pair, const ParticleView& points, const std::vector<RigidBody>& bodies,
                       double ahead, double dt, double release, double release_before);
  /// m, of a point where it stands.
  [[nodiscard]] double overlap_of(Index point, const RigidBody& body, const ParticleView& points) const;
  /// As a point sees it, `ahead` (s) from now.
  [[nodiscard]] SurfacePoint surface_of(const RigidBody& body, const ParticleView& points, std::size_t point,
                                        double ahead = 0) const {
    return body.surface_from(points.position(point), ahead, settings_.rim_over_radius * points.radius[point]);
  }
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
  /// Of a point with kicks of its own.
  void evaluate_kicked_pair(std::size_t pair, const ParticleView& points,
                            const std::vector<RigidBody>& bodies, double dt, double release,
                            double release_before);
  struct Sums {
    ContactEnergy energy;
    BodyImpulses on_bodies;
  };
  /// Adds what a pair, evaluated for a window of dt (s), gives.
  void sum_up(std::size_t pair, double dt, Vec3Array& linear, Vec3Array* angular, Sums& sums) const;
  /// N/m, of a point's springs as far as they do not depend on pairs, see stable_steps.
  [[nodiscard]] double stiffness_apart(std::size_t point) const;
  /// s, of a point under springs of that stiffness (N/m) and dashpots: their sum over 2 zeta sqrt(m), so the
  /// root of the stiffness where there is one spring, 0 for none; see stable_steps.
  [[nodiscard]] double step_under(double stiffness, double dashpots, std::size_t point,
                                  const ParticleView& points) const;
  /// s, of a point that no pair is known of.
  [[nodiscard]] double step_apart(std::size_t point, const ParticleView& points, bool with_dashpots) const;
  /// take(its first pair, point, its stable step) for all near a body, on all threads.
  template <class Take>
  void for_near_points(const ParticleView& points, std::span<const Approach> approaches, double horizon,
                       bool with_dashpots, Take&& take) const;
  /// See raise_rates, for one body that can move.
  void raise_beside(Index number, const RigidBody& body, std::span<const Approach> approaches, double horizon,
                    double least, std::vector<float>& rates) const;

  BodyContactSettings settings_;
  bool all_stiffen_ = false;  ///< springs
  std::vector<PairKey> keys_;
  std::vector<ContactHistory> histories_;
  std::vector<Result> results_;
  std::vector<Sums> part_sums_;  ///< scratch of `evaluate`, by part of the pairs
  ContactEnergy energy_;
  InitialOverlap initial_overlap_;
  bool searched_ = false;
};

}  // namespace tuft::coupler

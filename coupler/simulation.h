#pragma once
/// The coupled step: carpet, infill and bodies over one window, contact between them, and the books that are
/// kept.
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/infill.h"
#include "core/scene.h"
#include "core/timers.h"
#include "coupler/body_contact.h"
#include "coupler/energy_ledger.h"
#include "coupler/particle_shell_contact.h"
#include "coupler/step_plan.h"
#include "fe_carpet/carpet.h"

namespace tuft::coupler {

/// Everything a simulation is made of; contact settings have one entry a particle or a node.
struct SimulationParts {
  std::unique_ptr<fe::Carpet> carpet;
  std::unique_ptr<Infill> infill;
  std::vector<RigidBody> bodies;
  ParticleShellSettings particle_shell;
  BodyContactSettings particle_body;
  BodyContactSettings node_body;
  std::vector<double> node_radius;  ///< m, half thickness at each node
  Vec3 gravity{0, 0, -9.81};        ///< m/s^2
  Numerics numerics;
  double skin = 0;                   ///< m, reach of contact candidates beyond touching
  double energy_scale = 0;           ///< J, see EnergyLedger
  bool release_overlap = true;       ///< effect overlap_release
  bool separated_at_fibres = false;  ///< effect fibre_separation
  bool nodes_touch_bodies =
      true;         ///< false: the carpet passes through bodies (a strand through a wall's slot)
  double time = 0;  ///< s at the start
};

class Simulation {
 public:
  explicit Simulation(SimulationParts parts);

  /// Advances by `interval` (s), divided into windows by the steps that are stable now.
  /// Throws RunError from any part, and on an energy error over the limit (checked at the end of the
  /// interval).
  void advance_interval(double interval);

  /// Holds the carpet where it is: grains are packed among still fibres. Off costs nothing.
  void freeze_carpet(bool frozen) { carpet_frozen_ = frozen; }
  void set_damping(double carpet, double infill);  ///< 1/s, mass-proportional
  /// Extra acceleration on the infill (m/s^2), given through the contact impulses: packing at several g.
  void set_infill_acceleration(const Vec3& acceleration) { infill_acceleration_ = acceleration; }
  /// What weighs on the infill now, m/s^2: gravity and the extra acceleration.
  [[nodiscard]] Vec3 infill_gravity() const { return parts_.gravity + infill_acceleration_; }
  /// Puts a body into the simulation at a place and speed; its energy enters the ledger as external work.
  void release_body(std::size_t body, const Vec3& position, const Vec3& velocity);

  /// Takes a body out. Springs of contact with it are let go: what they hold is booked as lost.
  void remove_body(std::size_t body);
  /// Another infill goes on with the same particles (conditioning): as many, where they are, with the same
  /// contact radii and the sums of energy so far. Contact goes on, with bodies through other springs. Throws
  /// RunError when their number differs.
  void replace_infill(std::unique_ptr<Infill> infill, std::vector<NormalSpring> body_springs);

  /// Moves a driven body at this velocity (m/s) from the next window on.
  void drive_body(std::size_t body, const Vec3& velocity);
  /// Moves nodes of the carpet that are held, at this velocity (m/s) from the next window on; see
  /// fe::Carpet::drive. Their work enters the ledger as external.
  void drive_carpet(std::span<const std::size_t> nodes, const Vec3& velocity);
  /// Loads a body of finite mass with this force (N) from the next window on.
  void load_body(std::size_t body, const Vec3& force);

  [[nodiscard]] double time() const { return time_; }
  void set_time(double time) { time_ = time; }
  [[nodiscard]] std::uint64_t windows() const { return windows_; }
  [[nodiscard]] const StepPlan& step_plan() const { return plan_; }
  /// For the coming `interval`, s.
  [[nodiscard]] StableSteps stable_steps(double interval) const;
  [[nodiscard]] const fe::Carpet& carpet() const { return *parts_.carpet; }
  [[nodiscard]] Infill& infill() { return *parts_.infill; }
  [[nodiscard]] const Infill& infill() const { return *parts_.infill; }
  [[nodiscard]] const std::vector<RigidBody>& bodies() const { return parts_.bodies; }
  /// Contact impulse each body received over the last interval, N s, as a gauge there measures it: see
  /// BodyImpulses::measured.
  [[nodiscard]] const std::vector<Vec3>& interval_impulse() const { return interval_impulse_; }
  [[nodiscard]] const EnergyLedger& ledger() const { return ledger_; }
  /// The balance by part, J: what carpet and infill gained beyond the work done on them, and what contact
  /// took from them and from the bodies beyond what it stored and dissipated. Shows whose step is too large.
  struct Residuals {
    double carpet = 0, infill = 0, contact_and_bodies = 0;
  };
  [[nodiscard]] Residuals residuals() const;
  [[nodiscard]] double momentum_error() const { return momentum_error_; }
  [[nodiscard]] const ParticleShellContact& particle_shell() const { return particle_shell_; }
  [[nodiscard]] const BodyContact& particle_body() const { return particle_body_; }
  [[nodiscard]] const BodyContact& node_body() const { return node_body_; }
  [[nodiscard]] PhaseTimers& timers() { return timers_; }
  [[nodiscard]] std::uint64_t searches() const { return searches_; }
  /// "fastest particle 12 (31.2 m/s), fastest node 40 (3.1 m/s)".
  [[nodiscard]] std::string describe_fastest() const;
  /// Contacts of infill with carpet and bodies where all stand now, with the forces that the coming window
  /// will begin with if steps stay as they are. Changes nothing.
  [[nodiscard]] ContactNetwork boundary_contacts() const;
  /// Highest z of any particle's or free node's top within `radius` of (x, y), m.
  [[nodiscard]] double highest_infill(double x, double y, double radius) const;
  [[nodiscard]] double highest_carpet(double x, double y, double radius) const;

  void save(h5::Group& group);
  void load(const h5::Group& group);

 private:
  [[nodiscard]] StepPlan next_plan(double interval);
  /// Plans the rest of an interval (s) anew if its windows have become too long; whether they have.
  bool shorten_rest(double rest);
  void advance_window(bool last);
  [[nodiscard]] bool has_carpet() const { return !parts_.carpet->mesh().quads.empty(); }
  /// Tells the infill where strands are.
  void show_sheets(double interval);
  void step_carpet();
  void advance_bodies(Vec3& taken, double& scale);
  void check_candidates();
  void search(const ParticleView& particles, const fe::NodeView& nodes);
  void search_as_before(const h5::Group& reference);
  void save_numbers(h5::Group& group) const;
  void load_numbers(const h5::Group& group);
  void save_bodies(h5::Group& group) const;
  void load_bodies(const h5::Group& group);
  void remember_reference();
  /// The infill as contact sees it, see `window_position_`.
  [[nodiscard]] ParticleView contact_view() const;
  AdvanceReport advance_infill();
  /// How particles stand to bodies, for the two below.
  void look_at_bodies();
  /// Where particles take steps of their own: what contact near them bears, in the next while.
  void tell_contact_rates(double interval);
  [[nodiscard]] StableSteps stable_steps(double interval,
                                         std::span<const BodyContact::Approach> approaches) const;
  [[nodiscard]] double moved_since_search() const;
  void check_momentum(const AdvanceReport& infill, const Vec3& carpet, const Vec3& bodies,
                      double bodies_scale);
  [[nodiscard]] double release_at(double time) const;
  [[nodiscard]] ParticleView node_points(const fe::NodeView& nodes) const;
  [[nodiscard]] EnergyTerms energy_terms() const;
  [[nodiscard]] double carpet_balance() const;
  [[nodiscard]] double infill_balance() const;

  SimulationParts parts_;
  ParticleShellContact particle_shell_;
  BodyContact particle_body_, node_body_;
  EnergyLedger ledger_;
  PhaseTimers timers_;
  StepPlan plan_;
  double interval_ = 0;         ///< s, of the history, under way
  int bears_longer_steps_ = 0;  ///< intervals in a row that would bear fewer windows, see next_plan

  Vec3Array node_force_;
  /// Where the infill takes n > 1 steps in a window W, contact sees it a little ahead, at
  /// x + (n-1)/2n W v: the middle of the kicks that the window's impulse is spread over. With the force taken
  /// at x an even impulse feeds energy in; taken there, a spring keeps its energy as under a single kick
  /// (docs/theory/contact.md). Velocities are the change of these positions over the window, so that the work
  /// booked is that of the displacement which contact saw.
  Vec3Array window_position_, window_velocity_, window_spin_;
  bool windowed_ = false;
  ContactImpulses impulses_;
  BodyImpulses body_impulses_;
  std::vector<Vec3> interval_impulse_;
  std::vector<std::array<Vec3, 4>> sheets_;  ///< strands, for an infill that they separate
  std::size_t sheets_failed_ = 0;            ///< shells that had failed then
  double sheets_hold_ = -1;  ///< m that particles and strands may move until they are shown again
  std::vector<float> contact_rates_;
  std::vector<BodyContact::Approach> approaches_;  ///< scratch, see look_at_bodies

  struct Reference {  ///< where everything stood at the last search
    Vec3Array particles, nodes, bodies;
    bool valid = false;
  } reference_;

  std::uint64_t expelled_ = 0;  ///< particles of the infill that contact knows to have left
  std::size_t eroded_ = 0;      ///< elements of the carpet that contact knows to have failed
  bool carpet_frozen_ = false;
  Vec3 infill_acceleration_{0, 0, 0};
  double time_ = 0, start_time_ = 0;
  std::uint64_t windows_ = 0, searches_ = 0;
  double carpet_reference_ = 0,
         infill_reference_ = 0;  ///< J, own energies less own work, at the first ledger entry
  bool referenced_ = false;
  double carpet_balance_ = 0, infill_balance_ = 0;  ///< J, the same at the last entry
  double body_kinetic_ = 0, body_potential_ = 0, external_work_ = 0;
  double body_damping_ = 0;                            ///< J, in guides of bodies
  double pending_external_ = 0, pending_damping_ = 0;  ///< J, parts of a kick behind the moment of its force
  double momentum_error_ = 0, largest_exchange_ = 0, largest_imbalance_ = 0;
};

}  // namespace tuft::coupler

#pragma once
/// Individual steps: particles of soft layers are kicked every 2, 4, 8 or 16 steps of the run, each time
/// by as much.
///
/// A step of the run is as long as the stiffest particle bears. Particles go by groups (neighbour_list.h);
/// a group has a period P, a power of two: it is kicked in the steps whose number P divides, with its whole
/// force (stress, viscosity, contact) for P steps. Between its kicks its velocity stands still, and
/// so nothing that depends on it has to be computed. Positions move in every step.
///
/// Stresses keep pace with the fastest neighbour: a group is strained in every step in which it or a
/// neighbour is kicked, over the time since it was last, in which none of their velocities has changed. So
/// strains are as exact as with one step for all, every force is of the stresses of its moment, and what is
/// in balance stays in balance. Momentum and energy are kept to second order in the step, no longer to
/// rounding: a pair's two forces act at different times. docs/theory/sph.md has what was measured.
///
/// A particle takes the step that the stiffest of those within its support bears, for it helps to strain all
/// of them: as nodes of a stiff element do where elements have steps of their own.
#include <cstdint>
#include <span>
#include <vector>

#include "core/hdf5_file.h"
#include "core/infill.h"
#include "core/scene.h"

namespace tuft::sph {

class NeighbourList;
struct Particles;

class IndividualSteps {
 public:
  static constexpr int most = 16;
  /// Share of the stable step beyond which a period is shortened, at once; stable steps are known to that
  /// factor. Periods are chosen, now and then, for numerics.step_safety of it.
  static constexpr double most_of_step = 0.9;

  IndividualSteps() = default;
  /// largest: longest period, a power of two up to `most`; 1: all particles take every step, at no cost.
  /// safety: share of the stable step that a period of steps may take.
  IndividualSteps(int largest, double safety, std::size_t particles);

  [[nodiscard]] bool enabled() const { return largest_ > 1; }
  [[nodiscard]] int largest() const { return largest_; }

  /// Steps that contact bears, 1/s: inverse of the longest, a value a particle; 0 where nothing is near,
  /// infinite where every step counts.
  void set_contact_rates(std::span<const float> rates);

  /// Whether periods are to be chosen anew before the coming step: now and then, where all are kicked.
  [[nodiscard]] bool to_be_chosen() const { return phase_ % cycle_ == 0 && since_chosen_ >= chosen_every; }
  /// By all in the list, which therefore has to be the same in a resumed run.
  void choose(const NeighbourList& list, const Particles& particles, double dt);
  /// Shortens periods that have become too long for dt, and what depends on them. reach: m, of all that may
  /// come within the support before the list is built anew.
  void shorten(const NeighbourList& list, const Particles& particles, double reach, double dt);
  /// All take every step, until periods are chosen.
  void take_every_step();
  /// After the list was renewed, for what has come into it: shortens periods, and finds what groups have to
  /// keep pace with.
  void look_around(const NeighbourList& list, const Particles& particles, double dt);

  /// Says what the coming step of dt does. energy_wanted: whether energies of its start are of use, see
  /// `is_in_step`. as_begun: KickLength::step_begun.
  void begin(double dt, bool energy_wanted, bool as_begun);
  /// Of the step begun.
  [[nodiscard]] bool is_strained(std::size_t group) const { return (due_[group] & strained) != 0; }
  [[nodiscard]] bool is_kicked(std::size_t group) const { return (due_[group] & kicked) != 0; }
  [[nodiscard]] double since_strain(std::size_t group) const { return since_strain_[group]; }
  /// s, from the moment that a group's velocity belongs to until now.
  [[nodiscard]] double velocity_lag(std::size_t group) const {
    return since_kick_[group] - 0.5 * planned_[group];
  }
  [[nodiscard]] double kick_length(std::size_t group) const { return kick_length_[group]; }
  [[nodiscard]] const ParticleKicks& kicks() const { return kicks_; }
  /// All particles are kicked in the step begun: energies are of one moment.
  [[nodiscard]] bool is_in_step() const { return in_step_; }
  /// Particles kicked in the step begun; among those from `first` to before `end`, where a group begins.
  [[nodiscard]] std::size_t kicked_particles() const { return kicked_particles_; }
  [[nodiscard]] std::size_t kicked_particles(std::size_t first, std::size_t end) const;
  /// Notes a group's stable step (s) as just found.
  void note(std::size_t group, double stable) { own_rate_[group] = static_cast<float>(1 / stable); }
  void end(double dt);

  [[nodiscard]] int period_of(std::size_t particle) const;
  /// Of the particles from `first` to before `end`, where a group begins.
  [[nodiscard]] int longest_period_of(std::size_t first, std::size_t end) const;

  void save(h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  static constexpr std::uint8_t strained = 1, kicked = 2;
  static constexpr double growth_noted = 1.05;  ///< of a group's rate over that of all around
  /// Steps after which they are chosen anew.
  static constexpr std::uint32_t chosen_every = 64;

  [[nodiscard]] std::size_t groups() const { return period_.size(); }
  void limit_ratios(const NeighbourList& list);
  void keep_pace(const NeighbourList& list);
  /// Whether steps of `step` seconds are at most `share` of what a group, with contact, is stable with.
  [[nodiscard]] bool bears(std::size_t group, double step, double share) const;
  [[nodiscard]] std::uint8_t longest_period(std::size_t group, double dt) const;
  /// Shortens a group's period if that is too long, and notes it in `shortened_`.
  void shorten_to(std::size_t group, int period);
  void plan_kick(std::size_t group, double dt, bool as_begun);

  int largest_ = 1;
  double safety_ = 1;
  std::size_t particles_ = 0;
  std::vector<std::uint8_t> period_, kick_period_;  ///< steps; as chosen, and at the last kick
  std::vector<std::uint8_t> steps_since_kick_;
  std::vector<std::uint8_t> pace_;  ///< steps between strains
  std::vector<std::uint8_t> due_;
  std::vector<float> own_rate_, rate_, contact_rate_;  ///< 1/s; inverse stable step of each, of all around
  std::vector<std::size_t> shortened_, stiffened_;     ///< scratch of `shorten`
  std::vector<double> since_kick_, planned_, since_strain_, kick_length_, kick_lag_;  ///< s
  std::uint32_t phase_ = 0, cycle_ = 1, since_chosen_ = chosen_every, since_wanted_ = 0;
  bool in_step_ = true;
  std::size_t kicked_particles_ = 0;
  ParticleKicks kicks_;
};

}  // namespace tuft::sph

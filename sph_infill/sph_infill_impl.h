#pragma once
/// What SphInfill holds; shared by its stepping and its checkpoints.
#include "sph_infill/individual_steps.h"
#include "sph_infill/sleep.h"
#include "sph_infill/sph_infill.h"
#include "sph_infill/sph_loops.h"

namespace tuft::sph {

struct SphInfill::Impl {
  LoopSettings settings;
  Vec3 gravity{0, 0, 0};
  Particles particles;
  NeighbourList list;
  double pitch = 0;  ///< m, of the lattice
  Sleep sleep;
  IndividualSteps steps;
  bool begun = false;      ///< the coming window is announced
  bool own_kicks = false;  ///< and has particles kicked at times of their own
  TurfBox box;
  KickLength kick_length = KickLength::mean_of_steps;

  double time = 0;         ///< s, t_k of the positions
  double step_before = 0;  ///< s, drift that led to t_k; 0 at the start of a run
  double damping = 0;      ///< 1/s
  double stable_step = 0;  ///< s, as of the last stress evaluation
  /// No particle has moved farther since the list was built, relative to the frame common to all, m.
  double displacement = 0;
  double moved_before = 0;       ///< m, of it: when the list was last renewed in part
  std::uint64_t list_steps = 0;  ///< begun with the list as it is; where nothing sleeps
  Vec3 frame{0, 0, 0};           ///< m/s, the particles' mean velocity a step ago
  std::uint64_t particle_steps = 0;
  InfillEnergy energy;          ///< as of the last force evaluation
  InfillEnergy energy_in_step;  ///< as of the last in which all were kicked, where steps are individual
  bool took_over = false;       ///< a compacted bed: reference volumes are state
  std::uint64_t loosest_started = 0;
  /// Works of the part of the last kick that lies after that moment.
  struct {
    double viscous = 0, damping = 0, contact = 0, holding = 0;
    double expelled = 0;  ///< by the drift that followed
  } pending;
  Expelled expelled;
  std::vector<Index> expelled_index;        ///< in the order in which they left
  std::vector<std::uint8_t> expelled_mask;  ///< by particle; empty: none
  std::vector<StressSums> stress_blocks;
  std::vector<KickSums> kick_blocks;
  std::vector<DriftCheck> drift_blocks;

  void set_up(const Lattice& lattice, const std::vector<Material>& materials, const SphSettings& settings);
  void take_over(const CompactedBed& bed, ConditionedState state);
  /// Lists neighbours, and evaluates what depends on the state alone, the stable step among it.
  void begin(double lattice_pitch, double sleep_tolerance);
  KickSums step(double dt, const Vec3Array* impulse, double impulse_share);
  void save_sleep(h5::Group& group) const;
  void load_sleep(const h5::Group& group);
  void save_steps(h5::Group& group) const;
  void load_steps(const h5::Group& group);
  void save_records(h5::Group& group) const;
  void load_records(const h5::Group& group);
  void load_expelled(const h5::Group& group);
  void load_separated(const h5::Group& group);
  void record_energy(const StressSums& stress, const KickSums& kicked);
  /// After the whole list was built.
  void note_neighbours();
  /// Takes out of the turf what the drift has moved out of the box. dt: of that drift.
  void expel(double dt);
  void take_out(Index particle);
  /// Before the first of the window's substeps: lists, periods, and what is due.
  void begin_steps(double dt, int substeps, bool energy_wanted);
  /// Before a step, where nothing sleeps: whether the list is to be built anew, and with which skin then.
  [[nodiscard]] bool list_has_served();
  void build_list();
  /// Where steps are individual: in part, if that does.
  void renew_list();
  /// Makes the neighbours of all that will be computed known, and chooses what that is.
  void prepare(const Vec3Array* impulse, double window);
  /// Chooses what will be computed, where steps are individual: all neighbours are known then.
  void choose_sleepers(const Vec3Array* impulse, double window);
  [[nodiscard]] std::size_t computed_particles() const;
  [[noreturn]] void report_invalid_stress() const;
  [[noreturn]] void report_invalid_motion() const;
};

}  // namespace tuft::sph

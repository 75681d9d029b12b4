#pragma once
/// Infill as a continuum: smoothed particle hydrodynamics with a soil-and-foam law.
#include <limits>
#include <memory>
#include <vector>

#include "core/infill.h"
#include "core/scene.h"
#include "sph_infill/soil_effects.h"

namespace tuft::sph {

/// Box that a lattice fills: x and y of the patch (centred on the origin), from z = floor upwards.
struct LatticeBox {
  std::array<double, 2> size{};  ///< m
  double floor = 0;              ///< m, top of the backing
};

struct Lattice {
  Vec3Array position;          ///< m
  std::vector<double> volume;  ///< m^3, reference
  std::vector<Index> layer, material;
  /// Of contact, m, sideways and upwards; empty: half the edge of a cube of the particle's volume.
  std::vector<double> radius, half_height;
  /// What part of its cell each strains itself (row_shares.h); empty: all of it.
  std::vector<double> strained_share;
  /// Outermost particles are on walls and stand for parts of a cell (specimens).
  bool stands_on_walls = false;
  double pitch = 0;  ///< m, in the plane (adjusted so that a whole number fits the patch)
};

/// Cubic lattice by layers. In the plane the pitch is adjusted to a whole number of particles; each layer
/// gets a whole number of rows, its spacing in z adjusted to its depth, so that boundaries fall between rows
/// and the mass of a layer is exactly bulk density x volume. Contact radii are half the spacings, so that a
/// bed just fills its tray, whatever its layers' rows. Throws InputError for a layer thinner than half a
/// pitch.
[[nodiscard]] Lattice make_lattice(const Turf& turf, const LatticeBox& box, double pitch);

/// Edge of a cube of the mean volume of its particles, m.
[[nodiscard]] double mean_spacing(const Turf& turf, const LatticeBox& box, double pitch);

/// The same between a floor and what presses on the surface, whose contact is half a row deep: with
/// `strained_share`. Side walls take none: the half cells along them bear the weight above with the others.
[[nodiscard]] Lattice make_bed(const Turf& turf, const LatticeBox& box, const SphOptions& options);

/// Contact radii of a lattice's particles, m; of a lattice that has none those of cubes. half_height: empty
/// where it is the radius, of rows as high as the pitch.
struct ContactRadii {
  std::vector<double> radius, half_height;
};
[[nodiscard]] ContactRadii contact_radii(const Lattice& lattice);

/// Where infill belongs to the turf. What leaves it is expelled.
struct TurfBox {
  Vec3 low = Vec3::Constant(-std::numeric_limits<double>::infinity());  ///< m
  Vec3 high = Vec3::Constant(std::numeric_limits<double>::infinity());  ///< m
};

/// How long a kick lasts where steps change (all the same where they do not; the first of a run takes half
/// its step).
enum class KickLength {
  mean_of_steps,  ///< of the step before and the step after: of second order
  /// Of the step that it begins, as the impulses of contact and the kicks of carpet and bodies in a coupled
  /// run: what is in balance stays so, what moves is off to first order, once a change.
  step_begun
};

struct SphSettings {
  SphOptions options;         ///< smoothing_length resolved (> 0)
  Vec3 gravity{0, 0, -9.81};  ///< m/s^2
  bool artificial_viscosity = true;
  bool tension_cutoff = true;
  bool zero_energy_control = false;
  double sleep_tolerance = 0;  ///< strain, see sleep.h; 0: nothing sleeps
  int individual_steps = 1;    ///< longest period, see individual_steps.h; 1: all take every step
  double step_safety = 0.8;    ///< share of the stable step that a period may take
  SoilEffects soil_effects;
  TurfBox box;
  KickLength kick_length = KickLength::mean_of_steps;
};

/// Those of the soil law among the effects of a run.
[[nodiscard]] SoilEffects soil_effects_of(const std::vector<EffectDecision>& effects);

/// Constrained modulus of the law at pressure p, Pa: K_unloading + 4/3 G there (the stiffest path), with
/// density_hardening as on first loading to p.
[[nodiscard]] double constrained_modulus(const SoilFoamMaterial& material, double pressure,
                                         const SoilEffects& effects = {});

/// Particles that something else has moved to where they are, and compacted, before the continuum takes over.
struct CompactedBed {
  Vec3Array position, velocity;       ///< m, m/s, both at `time`
  std::vector<double> density_ratio;  ///< density reached over that as placed, > 0 (compaction.h)
  InfillEnergy energy;  ///< J: sums up to now, `let_go` with what a continuum cannot hold; stored is 0
  double time = 0;      ///< s
  double damping = 0;   ///< 1/s, as set
};

class SphInfill final : public Infill {
 public:
  /// materials: Scene::materials; every material index of the lattice must have `continuum`.
  SphInfill(const Lattice& lattice, const std::vector<Material>& materials, const SphSettings& settings);
  /// Takes over a compacted bed: mass, order, layer, material and contact radius are the lattice's, volumes
  /// are mass over the density reached. Particles less dense than as placed (proud ones, at the surface) get
  /// the volume they were placed with; `loosest_started` counts them. Throws InputError for a law that
  /// compaction cannot leave at that density.
  SphInfill(const Lattice& lattice, const std::vector<Material>& materials, const SphSettings& settings,
            const CompactedBed& bed, ConditionedState state);
  ~SphInfill() override;

  [[nodiscard]] std::string_view approach() const override { return "sph"; }
  [[nodiscard]] ParticleView particles() const override;
  /// As of the last stress evaluation; how it is estimated and how near the true limit: stable_step.h. Walls
  /// are not in it: a contact spring k on a particle of mass m needs dt < 2 sqrt(m/k) of its own.
  [[nodiscard]] double stable_step() const override;
  /// For individual steps; a window that is not announced is announced by `advance`.
  void begin_window(double window, int substeps, bool energy_wanted) override;
  [[nodiscard]] bool has_individual_steps() const override;
  void set_contact_rates(std::span<const float> rates) override;
  [[nodiscard]] bool energy_is_current() const override;
  /// Period of a particle's steps, in steps of the run.
  [[nodiscard]] int period_of(std::size_t particle) const;
  /// See separated_pairs.h. The list of neighbours is built anew where that changes it.
  double set_sheets(std::span<const std::array<Vec3, 4>> sheets) override;
  /// Empty contact arrays stand for no contact.
  AdvanceReport advance(double window, int substeps, const ContactImpulses& contact) override;
  void set_damping(double rate) override;
  /// Kinetic energy is sum m v_{k-1/2} . v_{k+1/2} / 2, which the leapfrog keeps exactly against the works of
  /// its forces (sph_loops.h, KickSums). Stored is the stress work less plastic work, dissipated plastic work
  /// and viscosity.
  [[nodiscard]] InfillEnergy energy() const override;
  /// A particle is expelled by the step that takes it out of the box: its momentum and kinetic energy leave
  /// the books of the infill and enter these.
  [[nodiscard]] Expelled expelled() const override;
  [[nodiscard]] std::uint64_t particle_steps() const override;
  void save(h5::Group& group) override;
  void load(const h5::Group& group) override;
  [[nodiscard]] std::vector<Field> fields() const override;
  /// As of the last stress evaluation, at the start of the last window.
  [[nodiscard]] std::vector<std::array<double, 6>> stress_moments() const override;

  /// For tests and benchmarks: sets a particle's velocity before the first advance.
  void set_velocity(std::size_t i, const Vec3& v);
  [[nodiscard]] double mean_neighbours() const;
  /// Particles that a compacted bed had looser than as placed, and that started as placed.
  [[nodiscard]] std::size_t loosest_started() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tuft::sph

#pragma once
/// Infill as rigid spheres, one for each SPH particle: what a bed is made of while it is compacted
/// (docs/conditioning.md).
#include <memory>
#include <vector>

#include "core/infill.h"
#include "sph_infill/sph_infill.h"

namespace tuft::sph {

struct SphereSettings {
  SphOptions options;                 ///< kernel and smoothing length, which densities are measured with
  Vec3 gravity{0, 0, -9.81};          ///< m/s^2
  double diameter_ratio = 1;          ///< diameter over the edge of the particle's cube, > 0
  double modulus = 0;                 ///< Pa, > 0: pressure over overlap, see SphereLaw
  double friction = 0;                ///< of spheres on each other, >= 0
  std::vector<double> damping_ratio;  ///< [0, 1), by material, of the critical damping; a pair has the mean
  bool lost_strength = false;         ///< frames of the continuum will have this field
};

/// Half the edge of the cube of a particle's volume, times the ratio, m.
[[nodiscard]] std::vector<double> sphere_radii(const Lattice& lattice, double diameter_ratio);

/// Soft spheres: see sphere_contact.h for the force, core/infill.h for the steps. Mass, order, layer,
/// material and the radius of contact with bodies and carpet are those of the particles that take over; among
/// themselves spheres have radii of their own (diameter_ratio). They turn, and damping takes spin as it takes
/// velocity.
///
/// Energy: `stored` is in the springs; `dissipated` is the work of dashpots and friction less what tangential
/// springs hold of it; the kinetic energy is sum m v- . v+ / 2 and the same of the spins, as of SPH
/// (sph_loops.h, KickSums).
class SphereInfill final : public Infill {
 public:
  /// position: where the spheres stand (place_spheres), `lattice`: where their particles were placed, which
  /// densities are measured against. Throws InputError for settings out of range and materials without
  /// `continuum`.
  SphereInfill(const Lattice& lattice, const std::vector<Material>& materials, const Vec3Array& position,
               const SphereSettings& settings);
  ~SphereInfill() override;

  [[nodiscard]] std::string_view approach() const override { return "sph"; }
  [[nodiscard]] ParticleView particles() const override;
  /// 2/omega (sqrt(1 + zeta^2) - zeta) with omega^2 <= max_i 2 sum_c k_c/m_i over the contacts c of sphere i.
  /// With tangential_ratio every direction of a contact, turning included, is at most as stiff as its normal,
  /// k (1/m_i + 1/m_j), and the mass-scaled stiffness matrix is bounded by the sums of the norms of its
  /// blocks. At least six contacts are counted, for spheres may meet within the steps that this is asked for.
  [[nodiscard]] double stable_step() const override;
  AdvanceReport advance(double window, int substeps, const ContactImpulses& contact) override;
  void set_damping(double rate) override;
  [[nodiscard]] InfillEnergy energy() const override;
  [[nodiscard]] std::uint64_t particle_steps() const override;
  void save(h5::Group& group) override;
  void load(const h5::Group& group) override;
  /// The fields of SphInfill: pressure and stresses from the pair forces in a sphere's share of space,
  /// density by CompactionMeasure; plastic compression and lost strength are 0.
  [[nodiscard]] std::vector<Field> fields() const override;
  [[nodiscard]] std::vector<std::array<double, 6>> stress_moments() const override;

  void set_velocity(std::size_t i, const Vec3& v);  ///< for tests, before the first advance
  void set_spin(std::size_t i, const Vec3& w);      ///< rad/s, the same
  [[nodiscard]] double largest_overlap() const;  ///< over the sum of the radii, the largest of the run so far
  [[nodiscard]] double mean_contacts() const;    ///< of a sphere, at the last force evaluation

  /// What a continuum takes over: velocities brought from half a step before to the positions' own moment
  /// under the spheres' forces, gravity and damping (contact gives its impulses whole, whenever its window
  /// begins). Energy that the continuum cannot hold, springs and spin, is let go: InfillEnergy::let_go. Ends
  /// this infill.
  [[nodiscard]] CompactedBed hand_over();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tuft::sph

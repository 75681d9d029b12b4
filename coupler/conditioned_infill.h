#pragma once
/// What conditioning is made of (docs/conditioning.md): the plate, spheres in place of SPH particles, and the
/// continuum that takes over from them.
#include <memory>
#include <vector>

#include "core/scene.h"
#include "coupler/rigid_body.h"
#include "sph_infill/sphere_infill.h"

namespace tuft::coupler {

/// The lattice that a scene's SPH infill starts from. Throws InputError.
[[nodiscard]] sph::Lattice scene_lattice(const Scene& scene);
/// The tray and some room above it, for all kinds of infill: 20 mm beyond the walls and under the floor, and
/// the larger of twice the tray's depth and four times the infill's above it. What leaves it has left the
/// turf.
[[nodiscard]] sph::TurfBox turf_box(const Scene& scene);
[[nodiscard]] sph::SphSettings sph_settings(const Scene& scene, const std::vector<EffectDecision>& effects);

inline constexpr const char* plate_name = "plate";
/// A driven plate over the whole patch, facing down, its face at this height (m).
[[nodiscard]] RigidBody conditioning_plate(double height);

/// Rigid spheres near the lattice, without overlap. They are as stiff as it takes for
/// numerics.contact_pressure to overlap them by a hundredth of their diameter. Throws InputError for a
/// material that conditioning.state does not suit.
[[nodiscard]] std::unique_ptr<sph::SphereInfill> build_spheres(const Scene& scene,
                                                               const std::vector<EffectDecision>& effects,
                                                               const sph::Lattice& lattice);

/// What the switch did.
struct SwitchReport {
  double kinetic = 0;          ///< J, kept
  double let_go = 0;           ///< J, of springs and spin
  double fastest = 0;          ///< m/s, of particles as they were handed over
  double largest_overlap = 0;  ///< of spheres, over their diameter, the largest while conditioning
  std::vector<double> density_mean,
      density_deviation;         ///< by layer, of the density reached over that as placed
  double volume = 0;             ///< m^3, of all particles at the density reached
  double started_as_placed = 0;  ///< share of particles, see SphInfill::loosest_started
};

/// The continuum in place of the spheres, which end with it. Throws InputError for materials that the state
/// asked for does not suit.
[[nodiscard]] std::unique_ptr<Infill> take_over(const Scene& scene,
                                                const std::vector<EffectDecision>& effects,
                                                sph::SphereInfill& spheres, SwitchReport& report);

}  // namespace tuft::coupler

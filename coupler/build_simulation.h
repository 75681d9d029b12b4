#pragma once
/// From a checked scene to a simulation: carpet, infill of the approach asked for, tray, contact.
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene.h"
#include "coupler/coming_to_rest.h"
#include "coupler/simulation.h"
#include "dem_bridge/dem_infill.h"
#include "sph_infill/soil_effects.h"
#include "sph_infill/sph_infill.h"
#include "sph_infill/sphere_infill.h"

namespace tuft::coupler {

inline const Vec3 gravity(0, 0, -9.81);  ///< m/s^2

struct BuildRequest {
  const Scene* scene = nullptr;
  std::vector<EffectDecision> effects;
  std::vector<RigidBody> rig_bodies;  ///< appended to the tray's
  double energy_scale = 0;            ///< J
  double start_time = 0;              ///< s, of the simulation: negative, for the rig is released at 0
  /// SPH with conditioning: spheres in place of the continuum, which takes over from them later.
  bool before_conditioning = false;
  /// Grains at rest, for DEM; empty: they are packed and settled (or taken from the cache).
  const dem::Grains* grains = nullptr;
  const fe::CarpetShape* carpet = nullptr;  ///< how the carpet stands among those grains; empty: as made
  std::function<void(const std::string& stage, double done)> on_progress;  ///< while packing; done in [0, 1]
};

struct BuiltSimulation {
  std::unique_ptr<Simulation> simulation;
  dem::DemInfill* dem = nullptr;         ///< the simulation's infill when it is DEM
  sph::SphereInfill* spheres = nullptr;  ///< the simulation's infill while SPH is conditioned
  std::size_t first_rig_body = 0;
  std::size_t plate = 0;  ///< first body of conditioning, behind the rig's; 0: the scene has none
  double packing_seconds = 0;
  bool packing_from_cache = false;
  std::optional<PackingReport> packing;  ///< of grains that were packed or taken from the cache
};

/// Throws InputError for a scene that cannot be built, RunError when the host fails.
[[nodiscard]] BuiltSimulation build_simulation(const BuildRequest& request);

/// The carpet's mesh for a scene, generated or from the mesh file it names; fibres by the effect. Throws
/// InputError.
[[nodiscard]] fe::ShellMesh build_carpet_mesh(const Scene& scene, bool with_fibres);

/// What of it the effects ask for: with neither fibres nor backing a mesh of nothing.
[[nodiscard]] fe::ShellMesh build_carpet_mesh(const Scene& scene, const std::vector<EffectDecision>& effects);

/// The carpet on such a mesh, of the scene's materials; shells fail by the effect.
[[nodiscard]] std::unique_ptr<fe::Carpet> build_carpet(const Scene& scene,
                                                       const std::vector<EffectDecision>& effects,
                                                       fe::ShellMesh mesh);

/// How a scene's carpet is stepped: sections, damping, gravity, mass scaling, subcycling.
[[nodiscard]] fe::CarpetOptions carpet_options(const Scene& scene);

/// What the user should know of the mesh file that the carpet comes from; empty for a generated carpet.
[[nodiscard]] std::vector<std::string> carpet_mesh_notes(const Scene& scene);

/// The springs with which particles press bodies. rigid: of spheres in place of the continuum.
[[nodiscard]] std::vector<NormalSpring> body_springs(const Scene& scene,
                                                     const std::vector<EffectDecision>& effects,
                                                     const ParticleView& particles, bool rigid);

/// The same at upright walls, where half rows are as thick as particles are wide; empty where they are the
/// same.
[[nodiscard]] std::vector<NormalSpring> wall_springs(const Scene& scene,
                                                     const std::vector<EffectDecision>& effects,
                                                     const ParticleView& particles);

/// What an SPH particle presses bodies with where numerics.body_contact is half_row: the infill between its
/// centre and its face, half a row of thickness h (m) and area A (m^2), compressed elastically under the
/// contact's stress, dF/dD = M(F/A) A/h. M, the constrained modulus, is taken as straight from no pressure to
/// numerics.contact_pressure, and constant beyond. A material's contact_modulus stands for M where given.
[[nodiscard]] NormalSpring half_row_spring(const Material& material, const Numerics& numerics, double area,
                                           double thickness, const sph::SoilEffects& effects = {});

/// Contact penalty of a particle, N/m, from its material (docs/theory/contact.md):
/// SPH: factor x constrained modulus at numerics.contact_pressure x particle diameter;
/// DEM: E/(1 - nu^2) x radius, the secant of a Hertz contact pressed in by about half a radius.
[[nodiscard]] double sph_contact_stiffness(const Material& material, const Numerics& numerics, double radius,
                                           const sph::SoilEffects& effects = {});
[[nodiscard]] double dem_contact_stiffness(const Material& material, double radius);

/// How particles meet shells and bodies, a value a particle.
/// Of each material's contacts, [0, 1): of its restitution, 0 where `contact_damping` is off.
[[nodiscard]] std::vector<double> damping_ratios(const Scene& scene,
                                                 const std::vector<EffectDecision>& effects);

struct PointContact {
  std::vector<double> stiffness;      ///< N/m, penalty
  std::vector<double> damping_ratio;  ///< of the critical
  std::vector<FrictionLaw> fibre_friction, body_friction;
};
[[nodiscard]] PointContact particle_contact(const Scene& scene, const std::vector<EffectDecision>& effects,
                                            const ParticleView& particles);

/// SPH particles in `box`, outside of which they count as expelled.
[[nodiscard]] std::unique_ptr<sph::SphInfill> build_sph(const Scene& scene,
                                                        const std::vector<EffectDecision>& effects,
                                                        const sph::Lattice& lattice, const sph::TurfBox& box);
/// Grains in LIGGGHTS' box.
[[nodiscard]] std::unique_ptr<dem::DemInfill> build_dem(const Scene& scene,
                                                        const std::vector<EffectDecision>& effects,
                                                        const dem::Grains& grains,
                                                        const std::array<Vec3, 2>& box);

/// How far particles may move before contact looks for its candidates again, m: half of the smallest radius,
/// of grains half of the mean one (the smallest of a wide mixture would make the list short-lived).
[[nodiscard]] double search_skin(Approach approach, std::span<const double> radius);

/// m: 0, or the height of the backing's upper face where there is no backing: then infill stands on the
/// floor, which has the friction that the backing would have.
[[nodiscard]] double floor_height(const Scene& scene, const std::vector<EffectDecision>& effects);

/// Five fixed half-spaces: floor at z = `floor` (m) and four walls around a patch centred on the origin.
[[nodiscard]] std::vector<RigidBody> tray(std::array<double, 2> size, double floor = 0);

}  // namespace tuft::coupler

#pragma once
/// Infill that fills a rig's room, of either approach: rigs ask for a room and get what stands in it.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/scene.h"
#include "coupler/coming_to_rest.h"
#include "coupler/simulation.h"
#include "dem_bridge/dem_infill.h"
#include "fe_carpet/carpet.h"
#include "sph_infill/sph_infill.h"

namespace tuft::coupler {

/// A cylinder about the z axis, or a cuboid centred on it, from z = 0 upwards.
struct SpecimenRoom {
  Index material = 0;            ///< index into Scene::materials
  double height = 0;             ///< m, as placed: room and bulk density give the mass
  std::array<double, 2> size{};  ///< m, x and y; of a cylinder its diameter, twice
  bool round = false;
};

/// A strand of the carpet that a specimen is placed around; it touches infill, and passes through what holds
/// it.
struct SpecimenStrand {
  fe::ShellMesh mesh;
  ShellMaterial material;
  ShellSection section;
  std::vector<std::size_t> driven;  ///< nodes in the grip, held in all directions

  /// Names its shape in the cache of packings.
  [[nodiscard]] std::string description() const;
};

/// A lattice of the continuum, or grains at rest.
struct Specimen {
  SpecimenRoom room;
  sph::Lattice lattice;                  ///< SPH
  dem::Grains grains;                    ///< DEM
  std::optional<PackingReport> packing;  ///< of the grains
  /// m, from the room to the faces of what holds it. Particles of a continuum stand on the room's surface, a
  /// contact radius away from what they touch; grains are inside it with all of theirs.
  double reach = 0;
  double top = 0;  ///< m, height of a face that lies on the specimen
};

/// Fills a room for scene.infill.approach. Grains are packed, let come to rest under their weight between
/// smooth walls on a rough floor, and kept in the cache of packings: how high they stand is what they make of
/// it. Of `strand`, where given, only grains take notice: they come to rest around it, and it is held still.
/// Throws InputError for a room that cannot be filled, RunError when the host fails.
[[nodiscard]] Specimen fill_room(const Scene& scene, const std::vector<EffectDecision>& effects,
                                 const SpecimenRoom& room, const SpecimenStrand* strand = nullptr);

/// kg/m^3, of infill as placed: of the continuum's law, or the bulk density of grains.
[[nodiscard]] double placed_density(const Scene& scene, Index material);

/// Constrained modulus, Pa, at a pressure (Pa): the continuum's law, or an estimate for grains, those of a
/// mixture in series (dem_bridge/effective_medium.h, six contacts a grain).
[[nodiscard]] double placed_modulus(const Scene& scene, Index material, double pressure);

/// A specimen between bodies, and a strand in it or none: no tray.
struct SpecimenRequest {
  const Scene* scene = nullptr;
  std::vector<EffectDecision> effects;
  const Specimen* specimen = nullptr;
  std::vector<RigidBody> bodies;
  const SpecimenStrand* strand = nullptr;
  double energy_scale = 0;  ///< J, see EnergyLedger
};

/// The contact penalty of each particle of a continuum against bodies is that of the area of wall it stands
/// for: sph_contact_stiffness of a whole particle, less where two walls or three share it; that of a grain is
/// its own. Particles of a continuum reach a strand from as far as the rows beside it stand when nothing is
/// pressed. Throws InputError.
[[nodiscard]] std::unique_ptr<Simulation> build_specimen(const SpecimenRequest& request);

}  // namespace tuft::coupler

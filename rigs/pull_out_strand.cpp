#include "rigs/pull_out_strand.h"

#include <algorithm>
#include <cmath>

#include "coupler/contact_law.h"

namespace tuft::rigs {
namespace {

constexpr std::uint8_t all_held = 63;  // ShellMesh::constraints
constexpr std::uint8_t out_of_plane =
    2 | 8 | 32;  // across, roll about its length, yaw: a strand that is drawn straight

}  // namespace

double embedded_length(const SpecimenRig& rig) {
  return rig.embedded_length > 0 ? rig.embedded_length : rig.size[0];
}

double embedded_length(const SpecimenRig& rig, double displacement) {
  return rig.embedded_length > 0 ? rig.embedded_length - displacement : rig.size[0];
}

coupler::SpecimenStrand make_pull_out_strand(const Scene& scene) {
  const SpecimenRig& rig = scene.rig.specimen;
  const CarpetDesign& carpet = scene.turf.carpet;
  coupler::SpecimenStrand strand;
  strand.material = carpet.fibre;
  strand.material.failure_strain = 0;
  strand.material.along = {1, 0, 0};
  strand.section = carpet.fibre_section;
  const double wall = 0.5 * rig.size[0],
               tail = rig.embedded_length > 0 ? 0 : rig.travel + carpet.element_length;
  const double from = wall - embedded_length(rig) - tail, to = wall + carpet.element_length;
  const auto elements = [&](double length, long fewest) {
    return static_cast<Index>(std::max(fewest, std::lround(length / carpet.element_length)));
  };
  const Index along = elements(to - from, 2), across = elements(carpet.strand_width, 1);
  fe::ShellMesh& mesh = strand.mesh;
  mesh.surface_count = 2;  // the backing's number is not used
  const auto node = [across](Index i, Index j) { return i * (across + 1) + j; };
  for (Index i = 0; i <= along; ++i)
    for (Index j = 0; j <= across; ++j) {
      mesh.nodes.push_back({from + (to - from) * i / along,
                            carpet.strand_width * (2 * j - across) / (2 * across), 0.5 * rig.height});
      mesh.clamped.push_back(0);
      mesh.constraints.push_back(i == along ? all_held : out_of_plane);
      if (i == along) strand.driven.push_back(mesh.constraints.size() - 1);
    }
  for (Index i = 0; i < along; ++i)
    for (Index j = 0; j < across; ++j) {
      mesh.quads.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
      mesh.thickness.push_back(carpet.strand_thickness);
      mesh.material.push_back(0);
      mesh.surface.push_back(1);
    }
  return strand;
}

double strand_friction(const Scene& scene, double speed, bool with_rate) {
  const Material& material = scene.materials.at(static_cast<std::size_t>(scene.rig.specimen.material));
  const auto of = [&](const Material& m) {
    return with_rate ? coupler::friction_coefficient(m.fibre_friction, speed)
                     : m.fibre_friction.dynamic_coefficient;
  };
  if (scene.infill.approach == Approach::sph) return of(material);
  double sum = 0;
  for (const GrainShare& share : material.grain_shares)
    sum += share.mass_fraction * of(scene.materials.at(static_cast<std::size_t>(share.material)));
  return sum;
}

void run_friction_of(Scene& scene, double speed, double run_speed) {
  for (Material& material : scene.materials) {
    material.fibre_friction.decay *= speed / run_speed;
    material.body_friction.decay *= speed / run_speed;
  }
}

}  // namespace tuft::rigs

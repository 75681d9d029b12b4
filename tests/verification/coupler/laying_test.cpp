// What grains have between them while they are laid among strands.
#include "coupler/laying.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coarse_scene.h"
#include "core/geometry.h"
#include "coupler/build_simulation.h"
#include "coupler/settled_packing.h"

namespace tuft::coupler {
namespace {

constexpr const char* small_turf = "[\"40 mm\", \"40 mm\"]";

/// Sand and rubber, whose friction of every kind is `scale` times the usual.
Scene scene_of(double scale, const char* packing_friction) {
  Scene scene = rigs::coarse_scene({{"infill.approach", "dem"},
                                    {"infill.dem.host", TUFT_TEST_HOST},
                                    {"infill.dem.packing_friction", packing_friction},
                                    {"infill.dem.settle_time_limit", "4 ms"},
                                    {"infill.dem.material_coarse_graining", "{ sbr = 4.0, sand = 5.0 }"},
                                    {"turf.size", small_turf},
                                    {"rig.diameter", "20 mm"}});
  scene.numerics.energy_error_limit = std::numeric_limits<double>::infinity();  // as packings are made
  const auto grow = [scale](FrictionLaw& law) {
    law.static_coefficient *= scale;
    law.dynamic_coefficient *= scale;
  };
  for (Material& material : scene.materials) {
    grow(material.fibre_friction);
    grow(material.body_friction);
    if (!material.grain) continue;
    material.grain->friction *= scale;
    material.grain->rolling_friction *= scale;
  }
  for (GrainPair& pair : scene.infill.dem.pairs) {
    if (pair.friction) *pair.friction *= scale;
    pair.rolling_friction = 0.1 * scale;
  }
  return scene;
}

LaidBed laid(const Scene& scene) {
  const std::vector<EffectDecision> effects = decide_effects(scene);
  const std::vector<dem::ThinQuad> quads = thin_quads(build_carpet_mesh(scene, effects));
  dem::PackingRequest packing;
  packing.size = scene.turf.size;
  packing.floor = scene.turf.carpet.backing_thickness;
  packing.turf = &scene.turf;
  packing.materials = &scene.materials;
  packing.options = &scene.infill.dem;
  packing.seed = scene.numerics.seed;
  packing.obstacles = quads;
  return lay(scene, effects, dem::pack_grains(packing), [](double) {});
}

void expect_same(const LaidBed& a, const LaidBed& b) {
  EXPECT_EQ(a.position.x, b.position.x);
  EXPECT_EQ(a.position.z, b.position.z);
  EXPECT_EQ(a.carpet.position.x, b.carpet.position.x);
  EXPECT_EQ(a.carpet.element_state, b.carpet.element_state);
}

TEST(Laying, WithoutFrictionKnowsNoneOfAnyKind) {
  expect_same(laid(scene_of(1, "0")), laid(scene_of(0.3, "0")));
}

TEST(Laying, AShareOfFrictionIsThatShareOfEveryKind) {
  const LaidBed half = laid(scene_of(1, "0.5"));
  expect_same(half, laid(scene_of(0.5, "1")));
  EXPECT_NE(half.position.z, laid(scene_of(1, "1")).position.z) << "nothing is tested";
}

TEST(Laying, PushesStrandsAside) {
  const Scene scene = scene_of(1, "1");
  const LaidBed bed = laid(scene);
  const fe::ShellMesh mesh = build_carpet_mesh(scene, decide_effects(scene));
  ASSERT_EQ(bed.carpet.position.size(), mesh.nodes.size());
  double farthest = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    farthest = std::max(farthest, (bed.carpet.position[n] - mesh.nodes[n]).norm());
  EXPECT_GT(farthest, 5e-4);
  EXPECT_LT(farthest, scene.turf.carpet.pile_length);
  EXPECT_GT(bed.carpet.strain, 0);
}

/// How deep spheres are in shells, over their radius: the largest.
double deepest_in_strands(const SettledGrains& bed, const fe::ShellMesh& mesh) {
  double deepest = 0;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    std::array<Vec3, 4> corner;
    for (std::size_t c = 0; c < 4; ++c)
      corner[c] = bed.carpet.position[static_cast<std::size_t>(mesh.quads[e][c])];
    for (std::size_t i = 0; i < bed.grains.size(); ++i) {
      const Vec3 centre = bed.grains.position[i];
      const double radius = bed.grains.radius[i];
      if ((centre - corner[0]).norm() > radius + 0.02) continue;
      const double reach = radius + 0.5 * mesh.thickness[e];
      const FacetPoint at = closest_point_on_facet(centre, corner);
      deepest = std::max(deepest, (reach - std::sqrt(at.distance_squared)) / radius);
    }
  }
  return deepest;
}

SettledGrains settled(const Scene& scene) {
  const std::vector<EffectDecision> effects = decide_effects(scene);
  return settle_grains(scene, effects, build_carpet_mesh(scene, effects), {});
}

Scene at_rest(const char* packing_friction) {
  Scene scene = scene_of(1, packing_friction);
  scene.infill.dem.use_cache = false;
  scene.infill.dem.settle_time_limit = 0.1;
  return scene;
}

/// A strand that had cut through a grain would be as deep in it as its radius on the way.
TEST(Laying, TearsNoStrandThroughAGrain) {
  for (const char* friction : {"1", "0"}) {
    const Scene scene = at_rest(friction);
    const SettledGrains bed = settled(scene);
    EXPECT_TRUE(bed.report.laid);
    EXPECT_TRUE(bed.report.at_rest);
    const double deepest = deepest_in_strands(bed, build_carpet_mesh(scene, decide_effects(scene)));
    EXPECT_GT(deepest, 0) << "nothing touches";
    EXPECT_LT(deepest, 0.15) << "of the radius";
  }
}

/// Clumps part as bodies when they have become stiff, not before.
TEST(Laying, OfClumpsComesToRestToo) {
  Scene scene = at_rest("1");
  const auto sbr = std::ranges::find(scene.materials, std::string("sbr"), &Material::name);
  ASSERT_NE(sbr, scene.materials.end());
  sbr->grain->clump = Clump{ClumpShape::tetrahedron, 0.4};
  const SettledGrains bed = settled(scene);
  EXPECT_TRUE(bed.report.laid);
  EXPECT_TRUE(bed.report.at_rest);
  ASSERT_FALSE(bed.grains.body.empty());
  EXPECT_LT(deepest_in_strands(bed, build_carpet_mesh(scene, decide_effects(scene))), 0.15);
}

}  // namespace
}  // namespace tuft::coupler

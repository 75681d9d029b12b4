// What a scene becomes when it is read; what mistakes get is in scene_mistakes_test.cpp.
#include "core/scene_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "good_scene.h"

namespace tuft {
namespace {

using test::good;
using test::ScratchFolder;
using test::with;
using testing::EndsWith;

TEST(SceneReader, ValuesArriveInSi) {
  const Scene scene = read_scene_text(good, "folder/a.toml");
  EXPECT_EQ(scene.info.name, "a");
  EXPECT_EQ(scene.info.duration, 0.025);
  EXPECT_EQ(scene.turf.size, (std::array<double, 2>{0.08, 0.09}));
  EXPECT_EQ(scene.turf.layers.size(), 2u);
  EXPECT_EQ(scene.turf.layers[1].depth, 0.045);
  EXPECT_EQ(scene.materials[static_cast<std::size_t>(scene.turf.layers[1].material)].name, "sbr");
  EXPECT_EQ(scene.infill.approach, Approach::sph);
  EXPECT_EQ(scene.infill.sph.pitch, 0.004);
  EXPECT_EQ(scene.numerics.step_safety, 0.5);
  EXPECT_EQ(scene.effects.choice.at("fibres"), Switch::on);
  EXPECT_EQ(scene.effects.choice.at("friction_rate"), Switch::automatic);
  EXPECT_GT(scene.turf.carpet.gauge, 0.0);
  EXPECT_EQ(scene.rig.clegg.mass, CleggRig{}.mass) << "a key left out keeps its default";
}

TEST(SceneReader, MixtureBringsItsGrains) {
  const Scene scene = read_scene_text(with("\"sand\"", "\"mixture\""), "a.toml");
  const Material& mixture = scene.materials[static_cast<std::size_t>(scene.turf.layers[0].material)];
  ASSERT_EQ(mixture.grain_shares.size(), 2u);
  double sum = 0;
  for (const GrainShare& share : mixture.grain_shares) {
    sum += share.mass_fraction;
    EXPECT_TRUE(scene.materials[static_cast<std::size_t>(share.material)].grain.has_value());
  }
  EXPECT_DOUBLE_EQ(sum, 1.0);
}

TEST(SceneReader, TrayIsTwoCentimetresDeeperThanTheInfillByDefault) {
  EXPECT_DOUBLE_EQ(read_scene_text(with("tray_depth = \"70 mm\"\n", ""), "a.toml").turf.tray_depth, 0.070);
}

TEST(SceneReader, SceneKeysOverrideDesignAndMaterialFiles) {
  const Scene plain = read_scene_text(good, "a.toml");
  const Scene scene = read_scene_text(
      good + "[turf.carpet]\ngauge = \"9 mm\"\n[materials.sbr.continuum]\ntension_cutoff = \"7 kPa\"\n",
      "a.toml");
  EXPECT_EQ(scene.turf.carpet.gauge, 0.009);
  EXPECT_EQ(scene.turf.carpet.stitch_spacing, plain.turf.carpet.stitch_spacing);
  EXPECT_EQ(scene.materials[1].continuum->tension_cutoff, 7000);
  EXPECT_EQ(scene.materials[1].continuum->yield_a0, plain.materials[1].continuum->yield_a0);
}

TEST(SceneReader, FilesBesideTheSceneComeFirst) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "materials");
  std::filesystem::copy_file("inputs/materials/sand.toml", folder / "materials/sand.toml");
  std::ofstream(folder / "a.toml") << good;
  const Scene scene = read_scene(folder / "a.toml");
  EXPECT_EQ(scene.materials[0].file, (folder / "materials/sand.toml").string());
  EXPECT_THAT(scene.materials[1].file, EndsWith("inputs/materials/sbr.toml"));
}

TEST(SceneReader, OverridesTakeTomlOrPlainText) {
  const Scene scene = read_scene_text(good, "a.toml",
                                      {{"infill.approach", "dem"},
                                       {"infill.sph.pitch", "3 mm"},
                                       {"turf.layers.0.depth", "6 mm"},
                                       {"effects.fibres", "false"},
                                       {"numerics.threads", "2"},
                                       {"turf.size", "[\"85 mm\", \"95 mm\"]"},
                                       {"materials.sbr.continuum.yield_a2", "0.2"},
                                       {"turf.carpet.gauge", "9.5 mm"}});
  EXPECT_EQ(scene.infill.approach, Approach::dem);
  EXPECT_EQ(scene.infill.sph.pitch, 0.003);
  EXPECT_EQ(scene.turf.layers[0].depth, 0.006);
  EXPECT_EQ(scene.effects.choice.at("fibres"), Switch::off);
  EXPECT_EQ(scene.numerics.threads, 2);
  EXPECT_EQ(scene.turf.size[1], 0.095);
  EXPECT_EQ(scene.materials[1].continuum->yield_a2, 0.2);
  EXPECT_EQ(scene.turf.carpet.gauge, 0.0095);
}

}  // namespace
}  // namespace tuft

// A scene's shells of fibres and of backing, from their keys to the carpet's options.
#include <gtest/gtest.h>

#include "core/scene_reader.h"
#include "coupler/build_simulation.h"

namespace tuft::coupler {
namespace {

struct Read {
  ShellSection fibre, backing;
  std::vector<ShellSection> of_materials;
};

Read read(const Overrides& overrides) {
  const Scene scene = read_scene("inputs/clegg_small.toml", overrides);
  return {scene.turf.carpet.fibre_section, scene.turf.carpet.backing_section, carpet_options(scene).sections};
}

TEST(ShellsOfAScene, AreReadApartForFibresAndBackingAndReachTheirOwnMaterial) {
  for (const auto& [fibre, backing] :
       {std::pair{"one_point", "fully_integrated"}, {"fully_integrated", "one_point"}}) {
    const Read of = read({{"turf.carpet.fibre.element", fibre},
                          {"turf.carpet.fibre.thickness_points", "2"},
                          {"turf.carpet.backing.element", backing},
                          {"turf.carpet.backing.thickness_points", "4"}});
    const auto kind = [](std::string_view name) {
      return name == "one_point" ? ElementKind::one_point : ElementKind::fully_integrated;
    };
    EXPECT_EQ(of.fibre.element, kind(fibre));
    EXPECT_EQ(of.backing.element, kind(backing));
    EXPECT_EQ(of.fibre.thickness_points, 2);
    EXPECT_EQ(of.backing.thickness_points, 4);
    // Material 0 of a carpet's mesh is the backing, 1 the fibre.
    ASSERT_EQ(of.of_materials.size(), 2U);
    EXPECT_EQ(of.of_materials[0].element, of.backing.element);
    EXPECT_EQ(of.of_materials[0].thickness_points, 4);
    EXPECT_EQ(of.of_materials[1].element, of.fibre.element);
    EXPECT_EQ(of.of_materials[1].thickness_points, 2);
  }
}

TEST(ShellsOfAScene, KeepTheDesignsWhereOnlyTheOtherIsGiven) {
  const Read design = read({}), fibres_given = read({{"turf.carpet.fibre.hourglass_coefficient", "0.25"}}),
             backing_given = read({{"turf.carpet.backing.hourglass_coefficient", "0.25"}});
  EXPECT_EQ(fibres_given.fibre.hourglass_coefficient, 0.25);
  EXPECT_EQ(fibres_given.backing.hourglass_coefficient, design.backing.hourglass_coefficient);
  EXPECT_EQ(backing_given.backing.hourglass_coefficient, 0.25);
  EXPECT_EQ(backing_given.fibre.hourglass_coefficient, design.fibre.hourglass_coefficient);
  EXPECT_NE(design.fibre.hourglass_coefficient, 0.25);
}

}  // namespace
}  // namespace tuft::coupler

/// Keys of a carpet's mesh file: found like the other files of a scene, pinned to what it holds.
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/scene_files.h"
#include "core/scene_reader.h"
#include "tests/unit/core/scratch_folder.h"

namespace tuft {
namespace {

using test::message_of;
using test::ScratchFolder;

/// A scene beside its mesh in a folder of its own.
class SceneMesh : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_ / "scene.toml") << read_text_file("inputs/clegg_small.toml");
    std::ofstream(folder_ / "own.msh") << "a mesh";
    std::filesystem::create_directories(folder_ / "meshes");
    std::ofstream(folder_ / "meshes/other.k") << "another mesh";
  }
  [[nodiscard]] CarpetMeshFile mesh_of(const Overrides& overrides) const {
    return read_scene(folder_ / "scene.toml", overrides).turf.carpet.mesh;
  }
  void expect_refused(const Overrides& overrides, std::initializer_list<const char*> words) const {
    const std::string message = message_of<InputError>([&] { (void)mesh_of(overrides); });
    for (const char* word : words)
      EXPECT_NE(message.find(word), std::string::npos) << word << " in: " << message;
  }
  ScratchFolder folder_;
};

TEST_F(SceneMesh, IsFoundBesideTheSceneAndInItsFolderMeshes) {
  EXPECT_EQ(mesh_of({{"turf.carpet.mesh", "own.msh"}}).file, (folder_ / "own.msh").string());
  EXPECT_EQ(mesh_of({{"turf.carpet.mesh", "other.k"}}).file, (folder_ / "meshes/other.k").string());
  const std::string absolute = (folder_ / "own.msh").string();
  EXPECT_EQ(mesh_of({{"turf.carpet.mesh", absolute}}).file, absolute);
}

TEST_F(SceneMesh, ThatIsNotThereIsNamed) {
  expect_refused({{"turf.carpet.mesh", "no.msh"}}, {"turf.carpet.mesh", "no.msh", "no such file", "meshes/"});
}

TEST_F(SceneMesh, IsReadInMillimetresUnlessAnotherUnitIsGiven) {
  EXPECT_EQ(mesh_of({{"turf.carpet.mesh", "own.msh"}}).unit, "mm");
  EXPECT_EQ(mesh_of({{"turf.carpet.mesh", "own.msh"}, {"turf.carpet.mesh_unit", "inch"}}).unit, "inch");
  expect_refused({{"turf.carpet.mesh", "own.msh"}, {"turf.carpet.mesh_unit", "kg"}},
                 {"turf.carpet.mesh_unit", "kg"});
  expect_refused({{"turf.carpet.mesh", "own.msh"}, {"turf.carpet.mesh_unit", "furlnog"}},
                 {"turf.carpet.mesh_unit", "furlnog"});
  expect_refused({{"turf.carpet.mesh", "own.msh"}, {"turf.carpet.mesh_unit", "-1 mm"}},
                 {"mesh_unit", "positive"});
}

TEST_F(SceneMesh, TheKeysThatSayHowToReadOneNeedOne) {
  expect_refused({{"turf.carpet.mesh_unit", "cm"}}, {"turf.carpet.mesh_unit", "names none", "leave it out"});
  expect_refused({{"turf.carpet.mesh_shift_z", "1 mm"}}, {"turf.carpet.mesh_shift_z", "names none"});
}

TEST_F(SceneMesh, RefusesAChoiceForUndecidedPartsThatIsNone) {
  expect_refused({{"turf.carpet.mesh", "own.msh"}, {"turf.carpet.mesh_undecided_parts", "guess"}},
                 {"mesh_undecided_parts", "guess", "leave_out"});
}

TEST_F(SceneMesh, ComesBackFromTheResolvedSceneWithWhatItHeld) {
  const Scene scene = read_scene(folder_ / "scene.toml", {{"turf.carpet.mesh", "own.msh"}});
  EXPECT_EQ(scene.turf.carpet.mesh.content, content_hash("a mesh"));
  const std::string resolved = write_scene(scene);
  EXPECT_EQ(write_scene(read_scene_text(resolved, "/nowhere/scene.toml")), resolved);
  // A report needs the resolved scene only, so it stays readable when the mesh is gone or has changed.
  std::ofstream(folder_ / "own.msh") << "changed";
  EXPECT_EQ(write_scene(read_scene_text(resolved, "/nowhere/scene.toml")), resolved);
  std::filesystem::remove(folder_ / "own.msh");
  EXPECT_EQ(write_scene(read_scene_text(resolved, "/nowhere/scene.toml")), resolved);
}

}  // namespace
}  // namespace tuft

/// A simulation on an exported and imported carpet is the one on the generated carpet.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/scene_reader.h"
#include "coupler/build_simulation.h"
#include "fe_carpet/mesh_export.h"

namespace tuft::coupler {
namespace {

constexpr const char* scene_file = "inputs/clegg_small.toml";

/// The scene's carpet as a file, removed at the end.
class ExportedCarpet {
 public:
  explicit ExportedCarpet(const std::string& ending)
      : path_(std::filesystem::temp_directory_path() / fmt::format("tuft-carpet-{}{}", ::getpid(), ending)) {
    const Scene scene = read_scene(scene_file);
    std::ofstream(path_) << fe::export_mesh_text(
        build_carpet_mesh(scene, true), {{scene.turf.carpet.backing, scene.turf.carpet.fibre}}, ending, {});
  }
  ~ExportedCarpet() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ExportedCarpet(const ExportedCarpet&) = delete;
  ExportedCarpet& operator=(const ExportedCarpet&) = delete;
  [[nodiscard]] Scene scene() const { return read_scene(scene_file, {{"turf.carpet.mesh", path_.string()}}); }

 private:
  std::filesystem::path path_;
};

BuiltSimulation built(const Scene& scene) {
  BuildRequest request;
  request.scene = &scene;
  request.effects = decide_effects(scene);
  return build_simulation(request);
}

TEST(ImportedCarpet, GivesTheSimulationOfTheGeneratedOne) {
  const Scene generated = read_scene(scene_file);
  const BuiltSimulation reference = built(generated);
  const fe::Carpet& expected = reference.simulation->carpet();
  for (const char* ending : {".msh", ".k"}) {
    SCOPED_TRACE(ending);
    const ExportedCarpet exported(ending);
    const BuiltSimulation other = built(exported.scene());
    const fe::Carpet& carpet = other.simulation->carpet();
    EXPECT_EQ(carpet.mesh().quads, expected.mesh().quads);
    EXPECT_EQ(carpet.mesh().surface, expected.mesh().surface);
    EXPECT_EQ(carpet.mesh().clamped, expected.mesh().clamped);
    EXPECT_NEAR(carpet.stable_step() / expected.stable_step(), 1, 1e-9);
    const auto mass = carpet.nodes().mass, expected_mass = expected.nodes().mass;
    ASSERT_EQ(mass.size(), expected_mass.size());
    for (std::size_t n = 0; n < mass.size(); ++n) EXPECT_NEAR(mass[n] / expected_mass[n], 1, 1e-9);
    EXPECT_EQ(other.simulation->infill().particles().size(),
              reference.simulation->infill().particles().size());
  }
}

TEST(ImportedCarpet, IsNotNeededForTheNotesOfAGeneratedOne) {
  EXPECT_TRUE(carpet_mesh_notes(read_scene(scene_file)).empty());
  const ExportedCarpet exported(".k");
  EXPECT_FALSE(carpet_mesh_notes(exported.scene()).empty());
}

}  // namespace
}  // namespace tuft::coupler

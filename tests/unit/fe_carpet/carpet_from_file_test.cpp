/// A scene's carpet from a mesh file: the same as the generated one, or one clear error.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"
#include "core/scene_reader.h"
#include "fe_carpet/mesh_export.h"
#include "tests/unit/core/scratch_folder.h"
#include "tests/unit/fe_carpet/expect_error.h"
#include "tests/unit/fe_carpet/mesh_samples.h"

namespace tuft::fe::test {
namespace {

using tuft::test::ScratchFolder;

constexpr std::array<double, 2> patch{0.020, 0.020};  // of the samples

CarpetDesign design_with(const std::string& file) {
  CarpetDesign d;
  d.backing_thickness = 0.002;
  d.strand_thickness = 0.0001;
  d.mesh.file = file;
  return d;
}

void expect_refused(const CarpetDesign& design, std::array<double, 2> size,
                    std::initializer_list<const char*> words) {
  expect_error<InputError>([&] { (void)import_carpet(design, size, true); }, words);
}

TEST(CarpetFromFile, FillsThePatchAndSaysTheUnitItTook) {
  const ImportedMesh imported = import_carpet(design_with(sample_path("tuft.k")), patch, true);
  EXPECT_EQ(imported.mesh.quads.size(), 8U);
  EXPECT_NE(imported.notes.front().find("tuft.k, lengths taken as mm"), std::string::npos);
}

TEST(CarpetFromFile, WithoutFibresIsTheBackingAlone) {
  const ShellMesh mesh = import_carpet(design_with(sample_path("tuft.k")), patch, false).mesh;
  EXPECT_NO_THROW(check_mesh(mesh));
  EXPECT_EQ(mesh.quads.size(), 4U);
  EXPECT_EQ(mesh.nodes.size(), 9U);
  EXPECT_EQ(mesh.surface_count, 1);
  EXPECT_EQ(mesh.clamped, (std::vector<std::uint8_t>{1, 1, 1, 1, 0, 1, 1, 1, 1}));
}

TEST(CarpetFromFile, SmallerOrLargerThanThePatchOrBesideItIsRefused) {
  expect_refused(
      design_with(sample_path("tuft.k")), {0.030, 0.020},
      {"tuft.k", "from (-10, -10) to (10, 10) mm", "(-15, -10) to (15, 10) mm", "turf.size", "mesh_unit"});
  expect_refused(design_with(sample_path("tuft.k")), {0.010, 0.020}, {"turf.size"});
  CarpetDesign other_unit = design_with(sample_path("tuft.k"));
  other_unit.mesh.unit = "cm";
  expect_refused(other_unit, patch, {"(-100, -100)", "\"cm\""});
}

TEST(CarpetFromFile, WhoseBackingDoesNotLieOnTheFloorIsRefused) {
  CarpetDesign raised = design_with(sample_path("tuft.k"));
  raised.mesh.shift_z = 0.001;
  expect_refused(raised, patch, {"from z = 1 to 3 mm", "z = 0", "mesh_shift_z"});
  CarpetDesign thicker = design_with(sample_path("tuft.k"));
  thicker.backing_thickness = 0.004;
  expect_refused(thicker, patch, {"from z = 0 to 2 mm", "turf.carpet.backing_thickness, 4 mm"});
}

TEST(CarpetFromFile, WhoseStrandLeavesTheTrayIsRefused) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.k") << with(sample("tuft_free.k"), "24, 10, 2, 9", "24, 12, 2, 9");
  expect_refused(design_with((folder / "a.k").string()), patch,
                 {"node 24 at (12, 2, 9) mm", "outside the tray"});
}

TEST(CarpetFromFile, ThatChangedSinceTheSceneWasResolvedIsRefused) {
  CarpetDesign design = design_with(sample_path("tuft.k"));
  design.mesh.content = content_hash(sample("tuft.k"));
  EXPECT_NO_THROW((void)import_carpet(design, patch, true));
  design.mesh.content = "0123456789abcdef";
  expect_refused(design, patch, {"0123456789abcdef", "start a new run"});
}

TEST(CarpetFromFile, ThatIsGoneIsNamed) {
  expect_refused(design_with("no/such.msh"), patch, {"no/such.msh"});
}

}  // namespace
}  // namespace tuft::fe::test

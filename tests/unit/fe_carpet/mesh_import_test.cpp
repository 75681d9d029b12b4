/// What becomes of the sample files: the same carpet from every format.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "tests/unit/fe_carpet/expect_error.h"
#include "tests/unit/fe_carpet/mesh_samples.h"

namespace tuft::fe::test {
namespace {

constexpr const char* samples[] = {"tuft.msh", "tuft_22.msh", "tuft.k", "tuft_free.k"};

ImportedMesh imported(const std::string& name, const MeshImportOptions& options = sample_options()) {
  return import_mesh(sample_path(name), options);
}

bool mentions(const std::vector<std::string>& notes, const std::string& words) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST(MeshImport, GivesTheSameCarpetFromEveryFormat) {
  for (const char* name : samples) {
    SCOPED_TRACE(name);
    const ShellMesh mesh = imported(name).mesh;
    ASSERT_EQ(mesh.nodes.size(), 17U);
    EXPECT_NEAR((mesh.nodes[4] - Vec3(0, 0, 0.001)).norm(), 0, 1e-15);
    EXPECT_NEAR((mesh.nodes[16] - Vec3(0.010, 0.002, 0.009)).norm(), 0, 1e-15);
    const std::vector<std::array<Index, 4>> quads{{0, 1, 4, 3},   {1, 2, 5, 4},    {3, 4, 7, 6},
                                                  {4, 5, 8, 7},   {4, 5, 10, 9},   {9, 10, 12, 11},
                                                  {4, 5, 14, 13}, {13, 14, 16, 15}};
    EXPECT_EQ(mesh.quads, quads);
    EXPECT_EQ(mesh.material, (std::vector<Index>{0, 0, 0, 0, 1, 1, 1, 1}));
  }
}

TEST(MeshImport, TellsStrandsThatShareOnlyBackingNodesApart) {
  for (const char* name : samples) {
    const ShellMesh mesh = imported(name).mesh;
    EXPECT_EQ(mesh.surface, (std::vector<Index>{0, 0, 0, 0, 1, 1, 2, 2})) << name;
    EXPECT_EQ(mesh.surface_count, 3) << name;
  }
}

TEST(MeshImport, ClampsTheEdgeOfTheBackingOnly) {
  for (const char* name : samples) {
    const ShellMesh mesh = imported(name).mesh;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
      EXPECT_EQ(mesh.clamped[n] != 0, n < 9 && n != 4) << name;
  }
}

TEST(MeshImport, TakesThicknessFromElementThenSectionThenDesign) {
  // The view of tuft_22.msh gives elements 1 and 201 their own; the rest is the design's.
  EXPECT_EQ(imported("tuft_22.msh").mesh.thickness,
            (std::vector<double>{0.0025, 0.002, 0.002, 0.002, 0.0001, 0.0001, 0.0002, 0.0001}));
  // In tuft.k element 201 has a card of its own and element 202 a card of zeros; sections give the rest.
  MeshImportOptions other = sample_options();
  other.backing_thickness = other.strand_thickness = 0;
  EXPECT_EQ(imported("tuft.k", other).mesh.thickness,
            (std::vector<double>{0.002, 0.002, 0.002, 0.002, 0.0001, 0.0001, 0.0002, 0.0001}));
}

TEST(MeshImport, CountsTheUnitThatWasStatedAndShiftsOnlyWhenAsked) {
  MeshImportOptions options = sample_options();
  EXPECT_DOUBLE_EQ(imported("tuft.k", options).mesh.nodes.z[0], 0.001);
  options.unit = 0.0254;
  EXPECT_DOUBLE_EQ(imported("tuft.k", options).mesh.nodes.z[0], 0.0254);
  EXPECT_DOUBLE_EQ(imported("tuft.k", options).mesh.thickness[0], 2 * 0.0254);
  options = sample_options();
  options.shift_z = -0.0005;
  EXPECT_DOUBLE_EQ(imported("tuft.k", options).mesh.nodes.z[0], 0.0005);
}

TEST(MeshImport, ListsTheKeywordsItLeavesOut) {
  const ImportedMesh mesh = imported("tuft.k");
  EXPECT_TRUE(mentions(mesh.notes, "*CONTROL_TERMINATION, *MAT_ELASTIC"));
  EXPECT_FALSE(mentions(mesh.notes, "*NODE"));
}

TEST(MeshImport, LeavesNodesOutThatNoShellHas) {
  const std::string text = with(sample("tuft_free.k"), "24, 10,", "99, 0, 0, 0\n24, 10,");
  const ImportedMesh mesh = import_mesh_text(text, "a.k", sample_options());
  EXPECT_EQ(mesh.mesh.nodes.size(), 17U);
  EXPECT_EQ(mesh.node_ids.back(), 24);
  EXPECT_TRUE(mentions(mesh.notes, "1 nodes that no shell has"));
}

TEST(MeshImport, DoesWithUndecidedPartsWhatTheOptionSays) {
  const std::string text = with(sample("tuft_free.k"), "strand surface", "something else");
  MeshImportOptions options = sample_options();
  expect_error<InputError>([&] { (void)import_mesh_text(text, "a.k", options); },
                           {"a.k:", "element 101 is of part 2", "something else", "mesh_undecided_parts"});
  options.undecided_parts = UndecidedParts::fibre;
  EXPECT_EQ(import_mesh_text(text, "a.k", options).mesh.surface_count, 3);
  options.undecided_parts = UndecidedParts::backing;
  EXPECT_EQ(import_mesh_text(text, "a.k", options).mesh.surface_count, 1);
  options.undecided_parts = UndecidedParts::leave_out;
  const ImportedMesh bare = import_mesh_text(text, "a.k", options);
  EXPECT_EQ(bare.mesh.quads.size(), 4U);
  EXPECT_EQ(bare.mesh.nodes.size(), 9U);
  EXPECT_TRUE(mentions(bare.notes, "4 shells"));
}

TEST(MeshImport, TakesSurfacesWithoutPhysicalGroupAsUndecided) {
  const std::string text = with(sample("tuft.msh"), "9 1 2 0\n$EndEntities", "9 0 0\n$EndEntities");
  MeshImportOptions options = sample_options();
  expect_error<InputError>([&] { (void)import_mesh_text(text, "a.msh", options); },
                           {"element 101", "surface 6", "no physical group"});
  options.undecided_parts = UndecidedParts::fibre;
  EXPECT_EQ(import_mesh_text(text, "a.msh", options).mesh.surface_count, 3);
}

TEST(MeshImport, ReadsCardsWhoseFieldsTouch) {
  const std::string wide = with(sample("tuft.k"), "       1 -1.00000000E+01", "       1-1.000000000E+01");
  EXPECT_EQ(import_mesh_text(wide, "a.k", sample_options()).mesh.nodes.x[0], -0.010);
}

TEST(MeshImport, ReadsLinesThatEndAsOnWindows) {
  for (const char* name : samples) {
    std::string text;
    for (const char letter : sample(name))
      text += letter == '\n' ? std::string("\r\n") : std::string(1, letter);
    EXPECT_EQ(import_mesh_text(text, name, sample_options()).mesh.quads, imported(name).mesh.quads) << name;
  }
}

TEST(MeshImport, ClampsTheRimOfAHoleToo) {
  // Ring of eight quads around the middle of a 4 x 4 grid.
  std::string text = "*KEYWORD\n*NODE\n";
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) text += fmt::format("{},{},{},0\n", 1 + 4 * j + i, i, j);
  text += "*ELEMENT_SHELL\n";
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      if (i != 1 || j != 1) {
        const int n = 1 + 4 * j + i;
        text += fmt::format("{},1,{},{},{},{}\n", 1 + 3 * j + i, n, n + 1, n + 5, n + 4);
      }
  text += "*PART\nbacking\n1,1,1\n*END\n";
  const ShellMesh mesh = import_mesh_text(text, "ring.k", sample_options()).mesh;
  EXPECT_EQ(std::count(mesh.clamped.begin(), mesh.clamped.end(), 1), 16);
}

}  // namespace
}  // namespace tuft::fe::test

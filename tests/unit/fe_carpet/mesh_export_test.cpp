/// A mesh that goes out comes back the same.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "fe_carpet/mesh_export.h"
#include "fe_carpet/mesh_topology.h"
#include "tests/unit/fe_carpet/expect_error.h"
#include "tests/unit/fe_carpet/mesh_samples.h"

namespace tuft::fe::test {
namespace {

constexpr std::array<double, 2> patch{0.05, 0.04};

CarpetDesign small_design() {
  CarpetDesign d;
  d.gauge = 0.0095;
  d.stitch_spacing = 0.010;
  d.strands_per_tuft = 3;
  d.pile_length = 0.03;
  d.strand_width = 0.0013;
  d.strand_thickness = 0.0001;
  d.lean = 0.15;
  d.fan_out = 0.15;
  d.element_length = 0.003;
  d.backing_thickness = 0.0012;
  d.backing_element = 0.005;
  return d;
}

const std::vector<ShellMaterial> materials{{0.2e9, 0.3, 950}, {0.36e9, 0.42, 920}};

/// A keyword file in metres has 12 decimals of a negative coordinate; the other formats have all digits.
void expect_same(const ShellMesh& a, const ShellMesh& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t n = 0; n < a.nodes.size(); ++n) EXPECT_LE((a.nodes[n] - b.nodes[n]).norm(), 1e-12) << n;
  EXPECT_EQ(a.quads, b.quads);
  EXPECT_EQ(a.material, b.material);
  EXPECT_EQ(a.surface, b.surface);
  EXPECT_EQ(a.surface_count, b.surface_count);
  EXPECT_EQ(a.clamped, b.clamped);
  ASSERT_EQ(a.thickness.size(), b.thickness.size());
  for (std::size_t e = 0; e < a.thickness.size(); ++e) EXPECT_NEAR(a.thickness[e] / b.thickness[e], 1, 1e-13);
}

/// Out and in again; nothing is left to the options.
ShellMesh there_and_back(const ShellMesh& mesh, const std::string& ending, double unit,
                         const std::string& name) {
  MeshImportOptions options;
  options.unit = unit;
  return import_mesh_text(export_mesh_text(mesh, materials, ending, {unit, name}), "carpet" + ending, options)
      .mesh;
}

TEST(MeshExport, ComesBackTheSameFromEveryFormatThatIsRead) {
  const ShellMesh mesh = generate_carpet(small_design(), patch, 3, true);
  for (const char* ending : {".msh", ".k", ".key", ".dyn"}) {
    SCOPED_TRACE(ending);
    expect_same(mesh, there_and_back(mesh, ending, 1e-3, "mm"));
    expect_same(mesh, there_and_back(mesh, ending, 1, "m"));
  }
}

TEST(MeshExport, KeepsThicknessesThatDifferFromElementToElement) {
  ShellMesh mesh = generate_carpet(small_design(), patch, 3, true);
  for (std::size_t e = 0; e < mesh.thickness.size(); ++e)
    mesh.thickness[e] *= 1 + 0.01 * static_cast<double>(e % 7);
  for (const char* ending : {".msh", ".k"}) expect_same(mesh, there_and_back(mesh, ending, 1e-3, "mm"));
}

TEST(MeshExport, OfABareBackingComesBackToo) {
  const ShellMesh mesh = generate_carpet(small_design(), patch, 3, false);
  for (const char* ending : {".msh", ".k"}) expect_same(mesh, there_and_back(mesh, ending, 1e-3, "mm"));
}

TEST(MeshExport, GivesLsDynaMaterialsInKilogramsMillisecondsAndTheFilesLength) {
  const std::string text =
      keyword_text(generate_carpet(small_design(), patch, 3, true), materials, {1e-3, "mm"});
  // 200 MPa are 0.2 kg/(mm ms^2), 950 kg/m^3 are 9.5e-7 kg/mm^3.
  EXPECT_NE(text.find("         1   9.5e-07       0.2       0.3\n"), std::string::npos);
  EXPECT_NE(text.find("         2   9.2e-07      0.36      0.42\n"), std::string::npos);
}

std::size_t count_lines(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from) + from.size(), end = text.find(to, begin);
  return static_cast<std::size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(begin),
                                             text.begin() + static_cast<std::ptrdiff_t>(end), '\n')) -
         1;
}

TEST(MeshExport, OfVtkHasOneLineForEachNodeCellAndValue) {
  const ShellMesh mesh = import_mesh(sample_path("tuft.msh"), sample_options()).mesh;
  const std::string text = vtk_text(mesh, {1e-3, "mm"});
  EXPECT_EQ(text.rfind("# vtk DataFile Version 3.0\n", 0), 0U);
  EXPECT_EQ(count_lines(text, "POINTS 17 double", "CELLS"), 17U);
  EXPECT_EQ(count_lines(text, "CELLS 8 40", "CELL_TYPES"), 8U);
  EXPECT_EQ(count_lines(text, "CELL_TYPES 8", "CELL_DATA"), 8U);
  for (const char* name : {"surface int", "material int", "thickness double"})
    EXPECT_NE(text.find(std::string("SCALARS ") + name), std::string::npos);
  EXPECT_NE(text.find("\n4 4 5 10 9\n"), std::string::npos);
  EXPECT_NE(text.find("\n-10 -10 1\n"), std::string::npos);
}

TEST(MeshExport, OfVtuNamesItsArraysAndCloses) {
  const ShellMesh mesh = import_mesh(sample_path("tuft.msh"), sample_options()).mesh;
  const std::string text = vtu_text(mesh, {1e-3, "mm"});
  EXPECT_NE(text.find("<Piece NumberOfPoints=\"17\" NumberOfCells=\"8\">"), std::string::npos);
  for (const char* name : {"connectivity", "offsets", "types", "surface", "material", "thickness", "clamped"})
    EXPECT_NE(text.find(fmt::format("Name=\"{}\"", name)), std::string::npos) << name;
  EXPECT_NE(text.find("lengths in mm"), std::string::npos);
  EXPECT_TRUE(text.ends_with("</VTKFile>\n"));
}

TEST(MeshExport, RefusesAnEndingItDoesNotKnow) {
  const ShellMesh mesh = import_mesh(sample_path("tuft.msh"), sample_options()).mesh;
  expect_error<InputError>([&] { (void)export_mesh_text(mesh, materials, ".stl", {}); }, {"'.stl'", ".vtu"});
}

TEST(MeshSummary, CountsTuftsStrandsAndMass) {
  const CarpetDesign d = small_design();
  const ShellMesh mesh = generate_carpet(d, patch, 3, true);
  const MeshSummary sum = summarise(mesh, materials);
  EXPECT_EQ(sum.strands, static_cast<std::size_t>(mesh.surface_count) - 1);
  EXPECT_EQ(sum.strands, 3 * sum.tufts);
  EXPECT_EQ(sum.backing_elements + sum.fibre_elements, mesh.quads.size());
  EXPECT_NEAR(sum.backing_mass, 950 * patch[0] * patch[1] * d.backing_thickness, 1e-12);
  const Carpet carpet(mesh, materials, {});
  double mass = 0;
  for (const double m : carpet.nodes().mass) mass += m;
  EXPECT_NEAR((sum.backing_mass + sum.fibre_mass) / mass, 1, 1e-9);
}

}  // namespace
}  // namespace tuft::fe::test

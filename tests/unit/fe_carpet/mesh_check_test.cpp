#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "fe_carpet/carpet.h"
#include "tests/unit/fe_carpet/expect_error.h"

namespace tuft::fe::test {
namespace {

/// Two unit squares side by side: nodes 0 1 2 below, 3 4 5 above.
ShellMesh two_squares() {
  ShellMesh mesh;
  for (const double y : {0.0, 1.0})
    for (const double x : {0.0, 1.0, 2.0}) mesh.nodes.push_back({x, y, 0});
  mesh.quads = {{0, 1, 4, 3}, {1, 2, 5, 4}};
  mesh.thickness = {0.1, 0.1};
  mesh.material = {0, 0};
  mesh.surface = {0, 0};
  mesh.clamped.assign(6, 0);
  mesh.surface_count = 1;
  return mesh;
}

void expect_rejected(const ShellMesh& mesh, std::initializer_list<const char*> words) {
  expect_error<InputError>([&] { check_mesh(mesh); }, words);
}

TEST(MeshCheck, AcceptsASoundMesh) {
  EXPECT_NO_THROW(check_mesh(two_squares()));
}

TEST(MeshCheck, RejectsAnEmptyMesh) {
  expect_rejected({}, {"no elements"});
}

TEST(MeshCheck, NamesTheElementWithANodeOutOfRange) {
  ShellMesh mesh = two_squares();
  mesh.quads[1][2] = 6;
  expect_rejected(mesh, {"element 1", "node 6", "0 to 5"});
  mesh.quads[1][2] = -1;
  expect_rejected(mesh, {"element 1", "node -1"});
}

TEST(MeshCheck, NamesTheElementWithARepeatedNode) {
  ShellMesh mesh = two_squares();
  mesh.quads[1][2] = 2;
  expect_rejected(mesh, {"element 1", "node 2 twice"});
}

TEST(MeshCheck, NamesTheElementWithCoincidentNodes) {
  ShellMesh mesh = two_squares();
  mesh.nodes.set(5, mesh.nodes[2]);
  expect_rejected(mesh, {"element 1", "nodes 2 and 5 coincide"});
}

TEST(MeshCheck, NamesTheElementThatIsConcaveOrFolded) {
  ShellMesh mesh = two_squares();
  mesh.nodes.set(5, Vec3(1.2, 0.2, 0));
  expect_rejected(mesh, {"element 1", "concave"});
  mesh = two_squares();
  std::swap(mesh.quads[0][1], mesh.quads[0][2]);  // an hourglass
  expect_rejected(mesh, {"element 0", "folded"});
}

TEST(MeshCheck, NamesTheElementWithAnUnusableThickness) {
  for (const double thickness : {0.0, -1.0, std::nan("")}) {
    ShellMesh mesh = two_squares();
    mesh.thickness[1] = thickness;
    expect_rejected(mesh, {"element 1", "thickness"});
  }
}

TEST(MeshCheck, NamesTheElementWithANodeThatIsNowhere) {
  ShellMesh mesh = two_squares();
  mesh.nodes.z[2] = std::nan("");
  expect_rejected(mesh, {"node 2", "element 1", "nan"});
}

TEST(MeshCheck, NamesTheElementWithAnUnknownSurfaceOrMaterial) {
  ShellMesh mesh = two_squares();
  mesh.surface[0] = 1;
  expect_rejected(mesh, {"element 0", "surface 1"});
  mesh = two_squares();
  mesh.material[1] = -1;
  expect_rejected(mesh, {"element 1", "material -1"});
}

TEST(MeshCheck, NamesANodeThatBelongsToNoElement) {
  ShellMesh mesh = two_squares();
  mesh.nodes.push_back({5, 5, 5});
  mesh.clamped.push_back(0);
  expect_rejected(mesh, {"node 6", "no element"});
}

TEST(MeshCheck, RejectsArraysThatDoNotFitTogether) {
  ShellMesh mesh = two_squares();
  mesh.thickness.pop_back();
  expect_rejected(mesh, {"2 elements", "1 thicknesses"});
  mesh = two_squares();
  mesh.clamped.pop_back();
  expect_rejected(mesh, {"5 clamp marks"});
}

}  // namespace
}  // namespace tuft::fe::test

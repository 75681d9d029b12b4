#include <gtest/gtest.h>

#include <cmath>

#include "fe_carpet/element_arrays.h"

namespace tuft::fe {
namespace {

/// One needle of 1:200, as thin as strands get: a batch with one element and padding, which copies its shape.
ShellMesh needle() {
  ShellMesh mesh;
  mesh.surface_count = 1;
  constexpr double width = 1.5e-5;
  for (const Vec3& node :
       {Vec3(0, 0, 0), Vec3(200 * width, 0, 0), Vec3(200 * width, width, 0), Vec3(0, width, 0)})
    mesh.nodes.push_back(node);
  mesh.quads = {{0, 1, 2, 3}};
  mesh.thickness = {1e-5};
  mesh.material = {0};
  mesh.surface = {0};
  mesh.clamped.assign(4, 0);
  return mesh;
}

TEST(Padding, HasNoFrequencyWhateverShapeItCopies) {
  const ShellMesh mesh = needle();
  for (const HourglassControl control : {HourglassControl::stiffness, HourglassControl::viscous}) {
    CarpetOptions options;
    options.section.hourglass = control;
    options.section.hourglass_coefficient = 0.1;
    const ElementArrays elements = make_element_arrays(mesh, {{0.5e9, 0.4, 920}}, options);
    const Pack bound = batch_frequency_squared(elements, mesh.nodes, 0);
    EXPECT_GT(bound[0], 0);
    EXPECT_TRUE(std::isfinite(bound[0]));
    for (std::size_t lane = 1; lane < lanes; ++lane) EXPECT_EQ(bound[lane], 0) << "lane " << lane;
  }
}

}  // namespace
}  // namespace tuft::fe

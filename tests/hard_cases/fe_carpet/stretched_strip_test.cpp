/// A strip under large static tension swings with small amplitude: no element may feed on the tension.
#include <gtest/gtest.h>

#include <cmath>

#include "core/parallel.h"
#include "fe_carpet/carpet.h"

namespace tuft::fe {
namespace {

constexpr double length = 0.04, width = 0.0013;
constexpr Index along = 13;

/// One element wide, in the x-y plane; its ends hold everything but the width.
ShellMesh gripped_strip() {
  ShellMesh mesh;
  mesh.surface_count = 1;
  for (Index i = 0; i <= along; ++i)
    for (int j = 0; j < 2; ++j) {
      mesh.nodes.push_back({length * i / along, width * (j - 0.5), 0});
      mesh.clamped.push_back(0);
      mesh.constraints.push_back(i == 0 || i == along ? 0b111101 : 0);
    }
  for (Index i = 0; i < along; ++i) {
    mesh.quads.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    mesh.thickness.push_back(1e-4);
    mesh.material.push_back(0);
    mesh.surface.push_back(0);
  }
  return mesh;
}

struct StretchedCase {
  const char* name;
  ElementKind element;
  int points;
  bool relaxing;
};

class StretchedStrip : public testing::TestWithParam<StretchedCase> {};

TEST_P(StretchedStrip, SwingsWithoutGrowing) {
  const auto& of = GetParam();
  ShellMaterial material{0.93e9, 0.42, 920};
  if (of.relaxing) material.relaxation = {{0.0663e9, 10}, {0.2e9, 1000}};
  CarpetOptions options;
  options.gravity = Vec3(0, 0, 0);
  options.section.element = of.element;
  options.section.thickness_points = of.points;
  set_threads(1);
  const ShellMesh mesh = gripped_strip();
  Carpet carpet(mesh, {material}, options);
  const std::size_t nodes = mesh.nodes.size();
  Vec3Array load;
  load.assign(nodes, 0.0);

  // Pulled by 22 % with the velocity field of a uniform stretch, then held.
  constexpr double rate = 50, stretch = 1.22;
  for (std::size_t n = 0; n < nodes; ++n) {
    const Vec3 x = mesh.nodes[n];
    const bool held = mesh.constraints[n] != 0;
    carpet.set_velocity(n, Vec3(held ? 0 : rate * x.x(), -0.4 * rate * x.y(), 0), Vec3(0, 0, 0));
  }
  for (std::size_t n = nodes - 2; n < nodes; ++n) carpet.drive(n, Vec3(rate * length, 0, 0));
  const double pulling_step = 0.3 * carpet.stable_step();
  for (double time = 0; 1 + rate * time < stretch; time += pulling_step) carpet.step(pulling_step, load);
  for (int i = 0; i < 5; ++i) {
    carpet.stop();
    for (std::size_t n = nodes - 2; n < nodes; ++n) carpet.drive(n, Vec3(0, 0, 0));
    for (int s = 0; s < 2000; ++s) carpet.step(pulling_step, load);
  }
  carpet.stop();

  for (std::size_t n = 2; n < nodes - 2; ++n) {
    const auto wave = [n](double k) { return std::sin(k * static_cast<double>(n) + k); };
    carpet.set_velocity(n, 1e-4 * Vec3(wave(1.1), wave(2.3), wave(3.7)),
                        1e-2 * Vec3(wave(0.7), wave(1.9), wave(2.9)));
  }
  const double dt = 0.95 * carpet.stable_step();
  double at_first = 0, largest = 0;
  for (int s = 0; s < 30000; ++s) {
    carpet.step(dt, load);
    (s < 100 ? at_first : largest) = std::max(s < 100 ? at_first : largest, carpet.kinetic_energy());
  }
  EXPECT_LT(largest, 2 * at_first);
}

INSTANTIATE_TEST_SUITE_P(
    , StretchedStrip,
    testing::Values(StretchedCase{"OnePoint", ElementKind::one_point, 1, false},
                    StretchedCase{"Full", ElementKind::fully_integrated, 1, false},
                    StretchedCase{"FullThreeLayers", ElementKind::fully_integrated, 3, false},
                    StretchedCase{"FullThreeLayersRelaxing", ElementKind::fully_integrated, 3, true}),
    [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace tuft::fe

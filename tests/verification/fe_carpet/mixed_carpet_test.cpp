/// Fibres and backing of different element kinds in one carpet, which share their root nodes.
#include <gtest/gtest.h>

#include "core/parallel.h"
#include "tests/verification/fe_carpet/shaken.h"

namespace tuft::fe::test {
namespace {

struct Kinds {
  ShellSection backing, fibres;
};

/// Fibres and backing of the published section beside the cheap one, both ways round.
constexpr ShellSection cheap{ElementKind::one_point, 1}, published{ElementKind::fully_integrated, 3};

class MixedCarpet : public testing::TestWithParam<Kinds> {
 protected:
  void SetUp() override { set_threads(1); }
  void TearDown() override { set_threads(all_threads_); }

  static CarpetOptions options() {
    CarpetOptions o = no_gravity();
    o.sections = {GetParam().backing, GetParam().fibres};
    return o;
  }

 private:
  int all_threads_ = omp_get_max_threads();
};

TEST_P(MixedCarpet, StruckKeepsItsEnergyAndHourglassesLittle) {
  expect_struck_turf_keeps_its_energy(options());
}

TEST_P(MixedCarpet, FreeKeepsItsMomentumToRounding) {
  ShellMesh mesh = small_turf(0.04);
  std::fill(mesh.clamped.begin(), mesh.clamped.end(), 0);
  Carpet carpet(mesh, turf_materials(), options());
  shake(carpet);
  const Vec3 before = momentum(carpet);
  const double scale = momentum_scale(carpet), dt = 0.8 * carpet.stable_step();
  const Vec3Array load = no_load(mesh.nodes.size());
  for (int i = 0; i < 2000; ++i) carpet.step(dt, load);
  EXPECT_LT((momentum(carpet) - before).norm(), 1e-11 * scale);
}

TEST_P(MixedCarpet, MovesBitForBitTheSameOnOneAndTwoThreads) {
  const ShellMesh mesh = small_turf(0.04);
  ASSERT_GT(mesh.quads.size(), 1000U) << "too small for threads to be used";
  Carpet one(mesh, turf_materials(), options()), two(mesh, turf_materials(), options());
  shake(one);
  shake(two);
  run_turf(one, 0, 100);
  set_threads(2);
  run_turf(two, 0, 100);
  expect_same_state(one, two);
}

/// Two strips side by side, the second of material 1.
ShellMesh two_strips() {
  const Strip strip = make_strip({0.03, 0.004, 0.0002, 12, 3}, true);
  ShellMesh mesh = strip.mesh;
  const auto nodes = static_cast<Index>(strip.node_count());
  for (std::size_t n = 0; n < strip.node_count(); ++n) {
    mesh.nodes.push_back(strip.mesh.nodes[n] + Vec3(0, 0.01, 0));
    mesh.clamped.push_back(strip.mesh.clamped[n]);
  }
  for (std::size_t e = 0; e < strip.mesh.quads.size(); ++e) {
    std::array<Index, 4> quad = strip.mesh.quads[e];
    for (Index& node : quad) node += nodes;
    mesh.quads.push_back(quad);
    mesh.thickness.push_back(strip.mesh.thickness[e]);
    mesh.material.push_back(1);
    mesh.surface.push_back(0);
  }
  return mesh;
}

TEST_P(MixedCarpet, MovesEachOfTwoPartsThatDoNotTouchBitForBitAsACarpetOfItsKindAloneWould) {
  const ShellMesh mesh = two_strips();
  const std::vector<ShellMaterial> materials{polyethylene(), polyethylene()};
  CarpetOptions of_backing = no_gravity(), of_fibres = no_gravity();
  of_backing.section = GetParam().backing;
  of_fibres.section = GetParam().fibres;
  Carpet mixed(mesh, materials, options()), backing(mesh, materials, of_backing),
      fibres(mesh, materials, of_fibres);
  const double dt = 0.5 * std::min(backing.stable_step(), fibres.stable_step());
  const Vec3Array load = no_load(mesh.nodes.size());
  for (Carpet* carpet : {&mixed, &backing, &fibres}) {
    shake(*carpet);
    for (int i = 0; i < 1000; ++i) carpet->step(dt, load);
  }
  double differs = 0;
  const std::size_t half = mesh.nodes.size() / 2;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const auto at = static_cast<Index>(n);
    const Carpet &like = n < half ? backing : fibres, &unlike = n < half ? fibres : backing;
    EXPECT_EQ(position(mixed, at), position(like, at)) << n;
    differs = std::max(differs, (position(mixed, at) - position(unlike, at)).norm());
  }
  EXPECT_GT(differs, 1e-9) << "the kinds do not differ, and nothing is tested";
}

INSTANTIATE_TEST_SUITE_P(Of, MixedCarpet, testing::Values(Kinds{cheap, published}, Kinds{published, cheap}),
                         [](const auto& parameter) {
                           return parameter.param.fibres.element == ElementKind::one_point
                                      ? "one_point_fibres_on_full_backing"
                                      : "full_fibres_on_one_point_backing";
                         });

}  // namespace
}  // namespace tuft::fe::test

/// Momentum, drilling, and bits: what the loops must keep whatever the mesh does.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <filesystem>

#include "core/hdf5_file.h"
#include "core/parallel.h"
#include "tests/verification/fe_carpet/shaken.h"

namespace tuft::fe::test {
namespace {

/// On one thread unless a test says otherwise, so that tests take the same time on a busy machine.
class Turf : public testing::Test {
 protected:
  void SetUp() override { set_threads(1); }
  void TearDown() override { set_threads(all_threads_); }

 private:
  int all_threads_ = omp_get_max_threads();
};

TEST(FreeStrip, KeepsItsMomentumToRounding) {
  const Strip strip = make_strip({0.03, 0.004, 0.0002, 12, 3}, false);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  shake(carpet);
  const Vec3 before = momentum(carpet);
  const double scale = momentum_scale(carpet), dt = 0.8 * carpet.stable_step();
  const Vec3Array load = no_load(strip.node_count());
  for (int i = 0; i < 20000; ++i) carpet.step(dt, load);
  EXPECT_LT((momentum(carpet) - before).norm(), 1e-11 * scale);
}

TEST(FreeStrip, GainsExactlyTheImpulseItReceives) {
  const Strip strip = make_strip({0.03, 0.004, 0.0002, 12, 3}, false);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  Vec3Array load = no_load(strip.node_count());
  load.set(5, {1e-4, -2e-4, 3e-4});
  load.set(17, {0, 5e-4, 0});
  const double dt = 0.8 * carpet.stable_step();
  for (int i = 0; i < 1000; ++i) carpet.step(dt, load);
  const Vec3 given = 1000 * dt * Vec3(1e-4, 3e-4, 3e-4);
  EXPECT_LT((carpet.impulse_received() - given).norm(), 1e-12 * given.norm());
  EXPECT_LT((momentum(carpet) - given).norm(), 1e-10 * given.norm());
  EXPECT_EQ(carpet.impulse_to_clamps().norm(), 0);
}

TEST(ClampedStrip, ReportsLoadsOnClampsApartAndStaysPut) {
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  Vec3Array load = no_load(strip.node_count());
  load.set(0, {1, 2, 3});
  for (int i = 0; i < 100; ++i) carpet.step(1e-6, load);
  EXPECT_LT((carpet.impulse_to_clamps() - 1e-4 * Vec3(1, 2, 3)).norm(), 1e-15);
  EXPECT_EQ(carpet.impulse_received().norm(), 0);
  EXPECT_EQ(position(carpet, 0), Vec3(0, 0, 0));
  EXPECT_EQ(carpet.energy().external_work, 0);
}

TEST(Grips, LiftAHangingStripByTheWorkOfItsWholeWeight) {
  Strip strip = make_strip({0.03, 0.004, 0.0002, 6, 2}, false);
  strip.mesh.constraints.assign(strip.node_count(), 0);
  std::vector<std::size_t> grip;
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    if (strip.mesh.nodes.x[n] == 0) {
      strip.mesh.constraints[n] = 0x3f;
      grip.push_back(n);
    }
  CarpetOptions options;
  options.gravity = Vec3(9.81, 0, 0);  // along the strip
  Carpet carpet(strip.mesh, {polyethylene()}, options);
  const Vec3 up(-0.05, 0, 0);
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    if (strip.mesh.constraints[n] == 0) carpet.set_velocity(n, up, Vec3(0, 0, 0));
  for (const std::size_t n : grip) carpet.drive(n, up);
  const Vec3Array load = no_load(strip.node_count());
  const double dt = 0.8 * carpet.stable_step();
  carpet.step(dt, load);
  const double start = carpet.energy().balance(), weight_before = carpet.energy().gravity_potential;
  double time = dt, largest = 0;
  for (int i = 0; i < 5000; ++i, time += dt) {
    carpet.step(dt, load);
    largest = std::max(largest, std::abs(carpet.energy().balance() - start));
  }
  const double lifted = carpet.energy().gravity_potential - weight_before;
  ASSERT_NEAR(lifted / (9.81 * 0.05 * (time - dt) * 920 * 0.03 * 0.004 * 0.0002), 1, 0.01);
  EXPECT_LT(largest, 1e-4 * lifted);
  EXPECT_NEAR(carpet.energy().external_work / lifted, 1, 0.02);
}

TEST(DrillingRotation, OfAFlatStripKeepsItsEnergyAndMovesTheStripByItsAngularMomentumOnly) {
  const Strip strip = make_strip({0.03, 0.004, 0.0002, 12, 3}, false);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    carpet.set_velocity(n, Vec3(0, 0, 0), Vec3(0, 0, 10 * std::sin(3.1 * static_cast<double>(n))));
  const Vec3Array load = no_load(strip.node_count());
  const double start = total(carpet.energy()), dt = 0.5 * carpet.stable_step();
  double largest_error = 0;
  for (int i = 0; i < 5000; ++i) {
    carpet.step(dt, load);
    largest_error = std::max(largest_error, std::abs(total(carpet.energy()) / start - 1));
  }
  EXPECT_LT(largest_error, 1e-3);
  EXPECT_GT(carpet.energy().kinetic, 0.1 * start);
  // A penalty of a hundredth of the shear modulus: the membrane takes part, the plane stays one.
  for (std::size_t n = 0; n < strip.node_count(); ++n) {
    EXPECT_LT((position(carpet, static_cast<Index>(n)) - strip.mesh.nodes[n]).norm(), 1e-5);
    EXPECT_LT(std::abs(position(carpet, static_cast<Index>(n)).z()), 1e-15);
  }
}

TEST_F(Turf, StruckKeepsItsEnergyAndHourglassesLittle) {
  expect_struck_turf_keeps_its_energy(no_gravity());
}

CarpetOptions damped() {
  CarpetOptions options;
  options.damping = 50;
  return options;
}

enum class Law { elastic, viscoelastic, orthotropic };

std::vector<ShellMaterial> materials_of(Law law) {
  std::vector<ShellMaterial> materials = turf_materials();
  if (law == Law::viscoelastic)
    for (ShellMaterial& m : materials) {
      const double shear = m.young_modulus / (2 * (1 + m.poisson_ratio));
      m.relaxation = {{0.2 * shear, 10}, {0.5 * shear, 1000}};
    }
  if (law == Law::orthotropic) {
    materials[0].across_young_modulus = 0.05e9;
    materials[0].shear_modulus = 0.01e9;
    materials[0].along = {0.8, 0.6, 0};
  }
  return materials;
}

/// Element, hourglass control, points through the thickness, law.
class TurfOfEveryKind
    : public Turf,
      public testing::WithParamInterface<std::tuple<ElementKind, HourglassControl, int, Law>> {
 protected:
  static CarpetOptions options() {
    CarpetOptions o = damped();
    o.section.element = std::get<0>(GetParam());
    o.section.hourglass = std::get<1>(GetParam());
    o.section.hourglass_coefficient = o.section.hourglass == HourglassControl::viscous ? 0.1 : 1;
    o.section.thickness_points = std::get<2>(GetParam());
    return o;
  }
  static std::vector<ShellMaterial> materials() { return materials_of(std::get<3>(GetParam())); }
};

INSTANTIATE_TEST_SUITE_P(
    OnePoint, TurfOfEveryKind,
    testing::Combine(testing::Values(ElementKind::one_point),
                     testing::Values(HourglassControl::stiffness, HourglassControl::viscous),
                     testing::Values(1, 3),
                     testing::Values(Law::elastic, Law::viscoelastic, Law::orthotropic)));
INSTANTIATE_TEST_SUITE_P(FullyIntegrated, TurfOfEveryKind,
                         testing::Combine(testing::Values(ElementKind::fully_integrated),
                                          testing::Values(HourglassControl::stiffness), testing::Values(1, 3),
                                          testing::Values(Law::elastic, Law::viscoelastic,
                                                          Law::orthotropic)));

TEST_P(TurfOfEveryKind, MovesBitForBitTheSameOnOneAndTwoThreads) {
  const ShellMesh mesh = small_turf(0.04);
  ASSERT_GT(mesh.quads.size(), 1000U) << "too small for threads to be used";
  Carpet one(mesh, materials(), options()), two(mesh, materials(), options());
  shake(one);
  shake(two);
  set_threads(1);
  run_turf(one, 0, 100);
  set_threads(2);
  run_turf(two, 0, 100);
  expect_same_state(one, two);
}

TEST_P(TurfOfEveryKind, GoesOnBitForBitFromACheckpoint) {
  const ShellMesh mesh = small_turf(0.04);
  // With a stop right before, which leaves a mark, and without.
  for (const bool stopped : {false, true}) {
    Carpet whole(mesh, materials(), options()), first_half(mesh, materials(), options());
    shake(whole);
    shake(first_half);
    run_turf(whole, 0, 50);
    run_turf(first_half, 0, 50);
    if (stopped) {
      whole.stop();
      first_half.stop();
    }
    run_turf(whole, 50, 100);
    const std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) /
        fmt::format("tuft_fe_carpet_checkpoint_{}_{}_{}_{}.h5", static_cast<int>(std::get<0>(GetParam())),
                    static_cast<int>(std::get<1>(GetParam())), std::get<2>(GetParam()),
                    static_cast<int>(std::get<3>(GetParam())));
    {
      h5::File file = h5::File::create_atomically(path);
      h5::Group group = file.root().create_group("carpet");
      first_half.save(group);
      file.commit();
    }
    Carpet second_half(mesh, materials(), options());
    second_half.load(h5::File::open(path).root().open_group("carpet"));
    run_turf(second_half, 50, 100);
    expect_same_state(whole, second_half);
    std::filesystem::remove(path);
  }
}

}  // namespace
}  // namespace tuft::fe::test

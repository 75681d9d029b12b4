// Oedometer and direct shear with grains in place of the continuum.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/scene_reader.h"
#include "dem_bridge/hertz.h"
#include "rigs/direct_shear.h"
#include "rigs/oedometer.h"
#include "verification/rigs/resumed_run.h"
#include "verification/rigs/specimen_support.h"

namespace tuft::rigs {
namespace {

constexpr int beads = 6;

/// Rubber beads of 4 mm, one upon the other in a ring as wide as they are.
Scene column_of_beads() {
  Scene scene = read_scene("inputs/oedometer_sbr.toml", {{"infill.approach", "dem"},
                                                         {"infill.dem.use_cache", "false"},
                                                         {"rig.diameter", "4 mm"},
                                                         {"rig.height", "24 mm"},
                                                         {"rig.preloads", "[\"1 N\"]"},
                                                         {"rig.cycles", "1"},
                                                         {"rig.seating_force", "0.02 N"},
                                                         {"rig.speed_factor", "20.0"},
                                                         {"rig.sample_travel", "5 um"},
                                                         {"rig.wall_friction", "0.0"}});
  Material& rubber = scene.materials.at(static_cast<std::size_t>(scene.rig.specimen.material));
  rubber.grain->diameter_min = rubber.grain->diameter_max = 4e-3;
  scene.infill.dem.material_coarse_graining.clear();
  rubber.bulk_density = rubber.grain->density * 2 / 3;  // spheres in the cylinder around them
  return scene;
}

/// m, of Hertz contacts between the beads and the penalty of the plates under a force, N.
double compression_of_column(const Material& rubber, double force) {
  const GrainMaterial& grain = *rubber.grain;
  const double e = grain.young_modulus, nu = grain.poisson_ratio, radius = 0.5 * grain.diameter_min;
  const double between = 4.0 / 3 * dem::effective_young_modulus(e, nu, e, nu) * std::sqrt(0.5 * radius),
               plate = e / (1 - nu * nu) * radius;
  return (beads - 1) * std::pow(force / between, 2.0 / 3) + 2 * force / plate;
}

TEST(OedometerOfGrains, CompressesAColumnOfBeadsAsHertzHasIt) {
  const Scene scene = column_of_beads();
  const Material& rubber = scene.materials.at(static_cast<std::size_t>(scene.rig.specimen.material));
  Oedometer rig(scene);
  EXPECT_LT(test::run_test(scene, rig, 0), 1e-3);
  double seated = 0, most = 0, worst = 0;
  for (const OedometerRow& row : rig.rows(0)) {
    if (row.travel == 0) seated = row.force;
    if (!(seated > 0) || row.direction < 0) continue;
    const double expected = compression_of_column(rubber, row.force) - compression_of_column(rubber, seated);
    worst = std::max(worst, std::abs(row.compression - expected));
    most = std::max(most, row.compression);
  }
  EXPECT_NEAR(seated, 0.02, 0.005);
  EXPECT_GT(most, 1e-3);
  EXPECT_LT(worst, 0.01 * most);
}

/// Soft, coarse rubber, so that steps are long and grains few.
Scene ring_of_rubber(const Overrides& more = {}) {
  Overrides overrides{{"infill.approach", "dem"},
                      {"infill.dem.use_cache", "false"},
                      {"infill.dem.material_coarse_graining.sbr", "2.0"},
                      {"rig.diameter", "20 mm"},
                      {"rig.height", "12 mm"},
                      {"rig.preloads", "[\"60 N\"]"},
                      {"rig.cycles", "2"},
                      {"rig.speed_factor", "200.0"},
                      {"rig.sample_travel", "20 um"},
                      {"rig.wall_friction", "0.0"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return read_scene("inputs/oedometer_sbr.toml", overrides);
}

TEST(OedometerOfGrains, BearsBelowWhatItIsGivenAboveAndGrowsStiffer) {
  const Scene scene = ring_of_rubber();
  Oedometer rig(scene);
  EXPECT_LT(test::run_test(scene, rig, 0), 1e-3);
  double inertia = 0;
  for (const OedometerRow& row : rig.rows(0)) inertia = std::max(inertia, std::abs(row.inertia_force));
  EXPECT_LT(inertia, 0.05 * 60);
  const std::span<const OedometerRow> rows = rig.rows(0);
  const double area = std::numbers::pi / 4 * 0.02 * 0.02, peak = 60 / area;
  const auto soft = loading_secant(rows, 0.05 * peak, 0.3 * peak),
             stiff = loading_secant(rows, 0.6 * peak, 0.9 * peak);
  ASSERT_TRUE(soft && stiff);
  EXPECT_GT(*stiff, 1.3 * *soft);
  std::map<std::string, Quantity> results, notes;
  rig.add_results(results, notes);
  // Between the loosest packing of rough spheres (0.55), less what walls five grains apart cost, and the
  // densest.
  const double solid = notes.at("preload_60_seated_density").value / 1150;
  EXPECT_GT(solid, 0.45);
  EXPECT_LT(solid, 0.66);
  // Friction and rearrangement take work in each cycle, more of it in the first.
  const double first = results.at("preload_60_cycle_1_loss").value,
               second = results.at("preload_60_cycle_2_loss").value;
  EXPECT_GT(second, 0.02);
  EXPECT_GT(first, second);
  EXPECT_GT(results.at("preload_60_cycle_1_residual_strain").value, 0);
}

TEST(OedometerOfGrains, GoesOnFromItsCheckpointToTheSameBits) {
  // Stopped before the plate touches the grains, while loading and while unloading.
  const Scene scene =
      ring_of_rubber({{"rig.preloads", "[\"12 N\"]"}, {"rig.cycles", "1"}, {"rig.checkpoint_rows", "20"}});
  EXPECT_GE(test::expect_resumed_bits(scene, 1, "force"), 3);
}

/// Shear strength (Pa, mean over shear strains of 5 to 15 %: of few grains one reading scatters by a third)
/// of coarse rubber with so much friction at a normal stress. Both halves of the box must bear the same.
double strength_in_box(double friction, const char* normal_stress) {
  Scene scene = read_scene("inputs/direct_shear_sbr.toml",
                           {{"infill.approach", "dem"},
                            {"infill.dem.use_cache", "false"},
                            {"infill.dem.material_coarse_graining.sbr", "2.0"},
                            {"effects.rolling_resistance", "false"},
                            {"rig.size", "[\"32 mm\", \"32 mm\"]"},
                            {"rig.height", "18 mm"},
                            {"rig.normal_stresses", fmt::format("[\"{}\"]", normal_stress)},
                            {"rig.yield_strain", "0.15"},
                            {"rig.load_time", "10 ms"},
                            {"rig.speed_factor", "1000.0"},
                            {"rig.sample_travel", "20 um"}});
  scene.materials.at(static_cast<std::size_t>(scene.rig.specimen.material)).grain->friction = friction;
  DirectShear rig(scene);
  EXPECT_LT(test::run_test(scene, rig, 0), 2e-3);
  double sum = 0, difference = 0;
  int count = 0;
  for (const ShearRow& row : rig.rows(0)) {
    if (row.shear_strain < 0.05) continue;
    sum += row.shear_stress;
    difference += row.force_upper - row.force_lower;
    ++count;
  }
  EXPECT_LT(std::abs(difference), 0.02 * 0.032 * 0.032 * sum);
  return sum / count;
}

TEST(DirectShearOfGrains, StrengthGrowsInProportionToTheLoadAndWithTheFrictionOfTheGrains) {
  const double rough = strength_in_box(0.5, "25 kPa"), under_more = strength_in_box(0.5, "50 kPa"),
               smooth = strength_in_box(0.0, "25 kPa");
  std::printf("%.1f, %.1f, %.1f kPa\n", rough / 1e3, under_more / 1e3, smooth / 1e3);
  // No cohesion.
  EXPECT_NEAR(under_more / rough, 2, 0.3);
  EXPECT_LT(smooth, 0.75 * rough);
  // Random packings of spheres with this friction have 20 to 30 degrees.
  EXPECT_GT(rough, 25e3 * std::tan(15 * std::numbers::pi / 180));
  EXPECT_LT(rough, 25e3 * std::tan(35 * std::numbers::pi / 180));
}

}  // namespace
}  // namespace tuft::rigs

// The direct shear box against the law's yield in pure shear.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/scene_reader.h"
#include "rigs/direct_shear.h"
#include "verification/rigs/resumed_run.h"
#include "verification/rigs/specimen_support.h"

namespace tuft::rigs {
namespace {

/// A small box of the mixture with a cohesion of 20 kPa, sheared by a tenth of its height.
Scene small_box(const Overrides& more = {}) {
  Overrides overrides{{"rig.material", "mixture"},    {"rig.size", "[\"30 mm\", \"18 mm\"]"},
                      {"rig.height", "15 mm"},        {"rig.normal_stresses", "[\"100 kPa\", \"200 kPa\"]"},
                      {"rig.strain_basis", "height"}, {"rig.yield_strain", "0.1"},
                      {"rig.speed_factor", "1000.0"}, {"rig.load_time", "8 ms"},
                      {"infill.sph.pitch", "3 mm"},   {"materials.mixture.continuum.yield_a0", "400 kPa^2"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return read_scene("inputs/direct_shear_mixture.toml", overrides);
}

/// Shear stress of steady simple shear: the strain rate has a shear component alone, and so has the deviator;
/// then J2 = tau^2 and p is the normal stress. The box measures alpha = tan(phi) in pure shear.
double pure_shear_yield(const SoilFoamMaterial& law, double normal) {
  return std::sqrt(law.yield_a0 + law.yield_a1 * normal + law.yield_a2 * normal * normal);
}

TEST(DirectShear, YieldsWhereTheLawDoesInPureShearAndTheHalvesBearTheSame) {
  const Scene scene = small_box();
  DirectShear rig(scene);
  for (std::size_t test = 0; test < rig.tests(); ++test)
    EXPECT_LT(test::run_test(scene, rig, test), 1e-3) << "energy";
  std::map<std::string, Quantity> results, notes;
  rig.add_results(results, notes);
  const SoilFoamMaterial& law =
      *scene.materials.at(static_cast<std::size_t>(scene.rig.specimen.material)).continuum;
  // Of the plane what still faces the other half: 1.5 mm of 30 mm are gone.
  const double left = 1 - (0.1 - yield_window / 2) * 15.0 / 30;
  double before = 0;
  for (const double normal : scene.rig.specimen.normal_stresses) {
    const std::string prefix = fmt::format("normal_{:g}_kpa_", 1e-3 * normal);
    const double yield = results.at(prefix + "yield_stress_on_remaining_area").value;
    EXPECT_NEAR(yield / pure_shear_yield(law, normal / left), 1, 0.09) << normal;
    EXPECT_GT(yield, 1.5 * before);
    before = yield;
    EXPECT_NEAR(results.at(prefix + "stress_on_plane").value / normal, 1, 0.03)
        << "nothing hangs in smooth walls";
    EXPECT_LT(notes.at(prefix + "inertia_share").value, 0.03) << "upper and lower half";
    EXPECT_LT(notes.at(prefix + "load_error").value, 0.04);
  }
  EXPECT_EQ(results.at("friction_angle").unit, "deg");
}

TEST(DirectShear, ResumedEndsInTheSameBits) {
  const Scene scene = small_box({{"rig.size", "[\"12 mm\", \"12 mm\"]"},
                                 {"rig.height", "10 mm"},
                                 {"infill.sph.pitch", "2.4 mm"},
                                 {"rig.yield_strain", "0.03"},
                                 {"rig.load_time", "1 ms"},
                                 {"rig.checkpoint_rows", "13"}});
  // While the load rises, while it shears, in the second test.
  EXPECT_GE(test::expect_resumed_bits(scene, 1, "shear_stress"), 4);
}

}  // namespace
}  // namespace tuft::rigs

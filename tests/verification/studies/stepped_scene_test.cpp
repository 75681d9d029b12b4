// Scenes that are stepped side by side start from the same state.
#include "studies/stepped_scene.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "verification/coupler/coarse_scene.h"

namespace tuft::studies {
namespace {

Scene grains_among_fibres(const char* rolling_resistance) {
  return rigs::coarse_scene({{"infill.approach", "dem"},
                             {"infill.dem.host", TUFT_TEST_HOST},
                             {"infill.dem.use_cache", "false"},
                             {"infill.dem.settle_time_limit", "6 ms"},
                             {"infill.dem.material_coarse_graining", "{ sbr = 4.0, sand = 5.0 }"},
                             {"effects.rolling_resistance", rolling_resistance},
                             {"turf.size", "[\"40 mm\", \"40 mm\"]"},
                             {"rig.diameter", "20 mm"}});
}

std::vector<double> all(std::span<const double> values) {
  return {values.begin(), values.end()};
}

/// Laying bends strands: with grains from there and strands as made, each would start within the other.
TEST(SteppedScene, AVariantStartsWithGrainsAndStrandsOfTheFirst) {
  const Scene scene = grains_among_fibres("true"), variant = grains_among_fibres("false");
  const auto first = step_scene(scene, nullptr, {});
  const std::optional<coupler::Packing> bed = bed_of(*first, scene);
  ASSERT_TRUE(bed.has_value());
  const auto second = step_scene(variant, &*bed, {});
  const fe::NodeView a = first->simulation().carpet().nodes(), b = second->simulation().carpet().nodes();
  EXPECT_EQ(all(a.x), all(b.x));
  EXPECT_EQ(all(a.z), all(b.z));
  EXPECT_EQ(all(first->simulation().infill().particles().z),
            all(second->simulation().infill().particles().z));

  coupler::Packing grains_alone = *bed;
  grains_alone.carpet = {};
  const auto straight = step_scene(variant, &grains_alone, {});
  const std::vector<double> made = all(straight->simulation().carpet().nodes().x);
  double bent = 0;
  for (std::size_t n = 0; n < made.size(); ++n) bent = std::max(bent, std::abs(made[n] - a.x[n]));
  EXPECT_GT(bent, 5e-4) << "nothing is tested";
}

}  // namespace
}  // namespace tuft::studies

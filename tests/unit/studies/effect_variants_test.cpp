#include "studies/effect_variants.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene_reader.h"

namespace tuft::studies {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

EffectVariant variant(const Scene& scene, const std::string& effect) {
  for (EffectVariant& v : effect_variants(scene))
    if (v.effect == effect) return v;
  ADD_FAILURE() << effect << " is not listed";
  return {};
}

TEST(EffectVariants, AreOneForEachEffectThatIsListed) {
  const Scene scene = read_scene("inputs/clegg_small.toml");
  const auto decisions = decide_effects(scene);
  const auto variants = effect_variants(scene);
  ASSERT_EQ(variants.size(), decisions.size());
  for (std::size_t i = 0; i < variants.size(); ++i) {
    EXPECT_EQ(variants[i].effect, decisions[i].name);
    EXPECT_EQ(variants[i].on, decisions[i].on);
    EXPECT_EQ(variants[i].scene.has_value(), variants[i].why_not.empty()) << variants[i].effect;
    if (!variants[i].scene) continue;
    EXPECT_NE(effect_on(decide_effects(*variants[i].scene), variants[i].effect), variants[i].on);
  }
}

TEST(EffectVariants, SayWhatSwitchesAlong) {
  const Scene scene = read_scene("inputs/clegg_small_conditioned.toml");
  EXPECT_THAT(variant(scene, "fibres").along, ElementsAre("backing"));
  EXPECT_THAT(variant(scene, "density_hardening").along, ElementsAre("shear_energy"));
  EXPECT_THAT(variant(scene, "tension_cutoff").along, IsEmpty());
}

TEST(EffectVariants, SwitchOnWhatTheMaterialsBear) {
  const Scene scene =
      read_scene("inputs/clegg_small_conditioned.toml", {{"effects.density_hardening", "false"}});
  const EffectVariant with = variant(scene, "density_hardening");
  ASSERT_TRUE(with.scene) << with.why_not;
  EXPECT_TRUE(effect_on(decide_effects(*with.scene), "density_hardening"));
}

TEST(EffectVariants, SayWhatIsMissing) {
  const Scene scene = read_scene("inputs/clegg_small.toml");
  EXPECT_THAT(variant(scene, "strength_rate").why_not, HasSubstr("continuum.strength_rate"));
  EXPECT_THAT(variant(scene, "rolling_resistance").why_not, HasSubstr("only for dem infill"));
  EXPECT_THAT(variant(scene, "backing").why_not, HasSubstr("effects.fibres stands on it"));
}

TEST(EffectVariants, LetGoOfChoicesThatNoLongerStand) {
  const Scene scene = read_scene("inputs/clegg_small.toml", {{"effects.fibre_separation", "true"}});
  const EffectVariant without = variant(scene, "fibres");
  ASSERT_TRUE(without.scene) << without.why_not;
  EXPECT_THAT(without.along, ElementsAre("backing", "fibre_separation"));
}

TEST(EffectVariants, OfGrainsAreThoseOfGrains) {
  const Scene scene = read_scene("inputs/clegg_small.toml", {{"infill.approach", "dem"}});
  EXPECT_TRUE(variant(scene, "rolling_resistance").scene);
  EXPECT_THAT(variant(scene, "tension_cutoff").why_not, HasSubstr("only for sph infill"));
}

}  // namespace
}  // namespace tuft::studies

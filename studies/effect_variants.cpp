#include "studies/effect_variants.h"

#include "core/effect_obstacle.h"
#include "core/error.h"
#include "core/scene_reader.h"

namespace tuft::studies {
namespace {

/// Choices that have nothing left to act on, or stand on what is now off, follow the scene again. Returns why
/// it cannot be had, or nothing.
std::string settle_choices(Scene& scene, const std::string& effect) {
  while (const std::optional<EffectDecision> idle = idle_effect(scene)) {
    Switch& choice = scene.effects.choice[idle->name];
    if (idle->name == effect) return idle->why;
    if (choice == Switch::automatic) return fmt::format("{}: {}", idle->name, idle->why);
    choice = Switch::automatic;
  }
  return {};
}

/// Reads a scene back from its text, as a resumed run does: with every check of a user's own.
Scene checked(const Scene& scene) {
  return read_scene_text(write_scene(scene), scene.file, {});
}

EffectVariant variant_of(const Scene& scene, const std::vector<EffectDecision>& now,
                         const EffectDecision& decision) {
  EffectVariant variant{decision.name, decision.on, {}, {}, {}};
  if (!decision.on) variant.why_not = effect_obstacle(scene, decision.name);
  if (!variant.why_not.empty()) return variant;
  Scene other = scene;
  other.effects.choice[decision.name] = decision.on ? Switch::off : Switch::on;
  variant.why_not = settle_choices(other, decision.name);
  if (!variant.why_not.empty()) return variant;
  const std::vector<EffectDecision> then = decide_effects(other);
  for (const EffectDecision& effect : now)
    if (effect.name != decision.name && effect_on(then, effect.name) != effect.on)
      variant.along.push_back(effect.name);
  try {
    variant.scene = checked(other);
  } catch (const InputError& error) {
    variant.why_not = error.what();
  }
  return variant;
}

}  // namespace

std::vector<EffectVariant> effect_variants(const Scene& scene) {
  const std::vector<EffectDecision> now = decide_effects(scene);
  std::vector<EffectVariant> variants;
  for (const EffectDecision& decision : now) variants.push_back(variant_of(scene, now, decision));
  return variants;
}

}  // namespace tuft::studies

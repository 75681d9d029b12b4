#pragma once
/// A scene with one effect the other way, for every effect that it lists.
#include <optional>
#include <string>
#include <vector>

#include "core/scene.h"

namespace tuft::studies {

struct EffectVariant {
  std::string effect;
  bool on = false;  ///< in the scene as it is
  /// The scene with the effect off where it is on, and the reverse; empty: it cannot be switched.
  std::optional<Scene> scene;
  std::string why_not;             ///< why it cannot, in words; empty where it can
  std::vector<std::string> along;  ///< effects that are switched with it, for they stand on it
};

/// In the order of core/effect_names.h. Choices of other effects stay as the scene has them, but where they
/// cannot: those become "auto" again.
[[nodiscard]] std::vector<EffectVariant> effect_variants(const Scene& scene);

}  // namespace tuft::studies

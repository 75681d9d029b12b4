#pragma once
/// The effects that a scene can switch, in the order in which they are listed.
#include <array>
#include <string_view>

namespace tuft {

struct EffectName {
  std::string_view name, meaning;
};

inline constexpr std::array<EffectName, 20> named_effects{{
    {"fibres", "strands of the carpet"},
    {"backing", "the sheet that strands stand in; off: a rigid floor at its height"},
    {"friction_rate", "friction that changes with sliding speed"},
    {"artificial_viscosity", "artificial viscosity (sph)"},
    {"zero_energy_control", "no motion that velocity gradients do not see (sph)"},
    {"fibre_separation", "infill on both sides of a strand that does not act through it (sph)"},
    {"tension_cutoff", "infill that cannot bear tension (sph)"},
    {"rolling_resistance", "resistance of grains to rolling (dem)"},
    {"grain_cohesion", "grains that hold to each other (dem)"},
    {"clumps", "grains made of several spheres each (dem)"},
    {"overlap_release", "initial overlap let go gradually"},
    {"contact_damping", "energy lost in contacts"},
    {"erosion", "shells that are strained too far fail"},
    {"density_hardening", "infill that compaction makes stiffer and stronger (sph)"},
    {"strength_softening", "strength that the infill loses by shearing (sph)"},
    {"strength_recovery", "lost strength that comes back with time or compression (sph)"},
    {"strength_rate", "strength that grows with the rate of shear (sph)"},
    {"inertial_friction", "friction that grows with the inertial number of a flow (sph)"},
    {"dilation", "shear that loosens compacted infill (sph)"},
    {"shear_energy", "elastic shear that keeps its energy when the shear modulus changes (sph)"},
}};

inline constexpr std::array<std::string_view, named_effects.size()> effect_names = [] {
  std::array<std::string_view, named_effects.size()> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = named_effects[i].name;
  return names;
}();

constexpr std::string_view effect_meaning(std::string_view name) {
  for (const EffectName& effect : named_effects)
    if (effect.name == name) return effect.meaning;
  return {};
}

}  // namespace tuft

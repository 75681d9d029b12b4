#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "core/effect_names.h"
#include "core/effect_obstacle.h"
#include "core/scene.h"

namespace tuft {
namespace {

/// What "auto" comes to, and why, in words a user reads in `explain` and summary.json.
struct Need {
  bool on;
  std::string why;
};

struct EffectRule {
  std::string_view name;
  std::optional<Approach> only;  ///< the one approach that has this effect
  Need (*needed)(const Scene&);
  /// What a scene must have for the effect to be switched on by hand, where that is less than `needed`.
  Need (*usable)(const Scene&) = nullptr;
  std::string_view borne{};  ///< effect of a filled turf that cannot be on without this one
};

/// The infill materials that can touch something: a layer's own in SPH, its grains' in DEM.
std::vector<const Material*> touching_materials(const Scene& scene) {
  std::vector<const Material*> found;
  for (const Layer& layer : scene.turf.layers) {
    const Material& material = scene.materials[static_cast<std::size_t>(layer.material)];
    if (scene.infill.approach == Approach::sph || material.grain_shares.empty()) found.push_back(&material);
    if (scene.infill.approach == Approach::sph) continue;
    for (const GrainShare& share : material.grain_shares)
      found.push_back(&scene.materials[static_cast<std::size_t>(share.material)]);
  }
  return found;
}

/// Name of the first material for which `test` holds, or empty.
std::string first_with(const Scene& scene, const std::function<bool(const Material&)>& test) {
  const auto materials = touching_materials(scene);
  const auto found =
      std::find_if(materials.begin(), materials.end(), [&](const Material* m) { return test(*m); });
  return found == materials.end() ? "" : (*found)->name;
}

bool depends_on_speed(const FrictionLaw& law) {
  return law.decay > 0 && law.dynamic_coefficient != law.static_coefficient;
}

bool is_switched_off(const Scene& scene, const std::string& effect) {
  const auto chosen = scene.effects.choice.find(effect);
  return chosen != scene.effects.choice.end() && chosen->second == Switch::off;
}

Need need_fibres(const Scene& scene) {
  if (scene.rig.is_specimen()) return {false, "a specimen of infill has no carpet"};
  return {true, "the turf has a carpet: its strands confine the infill and carry part of the load"};
}

/// A sheet that lies on the tray's floor and is clamped at its edges bears nothing that the floor does not.
Need need_backing(const Scene& scene) {
  if (scene.rig.is_specimen()) return {false, "a specimen of infill has no carpet"};
  if (is_switched_off(scene, "fibres"))
    return {false,
            "without strands it only lies on the tray: the infill stands on a rigid floor at its height"};
  return {true, "the strands stand in it"};
}

Need usable_backing(const Scene& scene) {
  if (scene.rig.is_specimen()) return need_backing(scene);
  return {true, ""};
}

Need need_friction_rate(const Scene& scene) {
  const std::string name = first_with(scene, [](const Material& m) {
    return depends_on_speed(m.fibre_friction) || depends_on_speed(m.body_friction);
  });
  if (name.empty() && !scene.rig.is_specimen() && depends_on_speed(scene.turf.carpet.body_friction))
    return {true, "friction of the carpet on bodies changes with sliding speed"};
  if (name.empty()) return {false, "no material's friction changes with sliding speed"};
  return {true, "friction of " + name + " changes with sliding speed (static and dynamic differ, decay > 0)"};
}

Need need_artificial_viscosity(const Scene& scene) {
  if (scene.infill.sph.viscosity_linear == 0 && scene.infill.sph.viscosity_quadratic == 0)
    return {false, "infill.sph.viscosity_linear and viscosity_quadratic are both 0"};
  return {true, "SPH needs it to keep particles in order and to spread shocks over a few of them"};
}

Need need_zero_energy_control(const Scene& scene) {
  if (scene.infill.sph.zero_energy_viscosity == 0) return {false, "infill.sph.zero_energy_viscosity is 0"};
  return {true, "SPH needs it against motion of neighbours that no velocity gradient sees"};
}

Need need_fibre_separation(const Scene& scene) {
  if (scene.rig.type == "pull_out") return {true, "what presses on the strand is what the rig measures"};
  return {false, "a choice: strands are about as wide as particles are apart, and most pairs see past them"};
}

Need usable_fibre_separation(const Scene& scene) {
  if (scene.rig.is_specimen() && scene.rig.type != "pull_out")
    return {false, "a specimen of infill has no strands"};
  if (is_switched_off(scene, "fibres")) return {false, "effects.fibres is off"};
  return {true, ""};
}

Need need_tension_cutoff(const Scene&) {
  return {true, "loose infill bears no more tension than its material's tension_cutoff"};
}

/// "sand", or "sand on sbr": the first grains of the layers of which a property is above 0, of a material or
/// as given for a pair; empty: none.
std::string first_grains_with(const Scene& scene, double GrainMaterial::*own,
                              std::optional<double> GrainPair::*of_pair) {
  const std::string name =
      first_with(scene, [own](const Material& m) { return m.grain && *m.grain.*own > 0; });
  if (!name.empty()) return name;
  const auto touching = touching_materials(scene);
  for (const GrainPair& pair : scene.infill.dem.pairs) {
    const Material* const a = &scene.materials[static_cast<std::size_t>(pair.materials[0])];
    const Material* const b = &scene.materials[static_cast<std::size_t>(pair.materials[1])];
    if ((pair.*of_pair).value_or(0) > 0 && std::ranges::count(touching, a) > 0 &&
        std::ranges::count(touching, b) > 0)
      return a->name + " on " + b->name;
  }
  return {};
}

Need need_rolling_resistance(const Scene& scene) {
  const std::string name =
      first_grains_with(scene, &GrainMaterial::rolling_friction, &GrainPair::rolling_friction);
  if (name.empty()) return {false, "no grain material has rolling_friction above 0"};
  return {true, "grains of " + name + " resist rolling (angular grains drawn as spheres)"};
}

Need need_grain_cohesion(const Scene& scene) {
  const std::string name =
      first_grains_with(scene, &GrainMaterial::cohesion_energy_density, &GrainPair::cohesion_energy_density);
  if (name.empty()) return {false, "no grain material or pair has a cohesion_energy_density above 0"};
  return {true, "grains of " + name + " hold to each other (cohesion_energy_density above 0)"};
}

Need need_clumps(const Scene& scene) {
  const std::string name = first_with(scene, [](const Material& m) { return m.grain && m.grain->clump; });
  if (name.empty()) return {false, "no grain material has a clump"};
  return {true, "grains of " + name + " are clumps of spheres (grain.clump)"};
}

Need need_overlap_release(const Scene& scene) {
  if (scene.rig.is_specimen()) return {false, "a specimen is placed without overlap"};
  if (scene.numerics.contact_release_time == 0) return {false, "numerics.contact_release_time is 0"};
  return {true, "infill placed among fibres overlaps them at the start; the overlap is let go gradually"};
}

Need need_contact_damping(const Scene& scene) {
  const std::string name = first_with(scene, [](const Material& m) { return m.contact_restitution < 1; });
  if (name.empty() && !scene.rig.is_specimen() && scene.turf.carpet.contact_restitution < 1)
    return {true, "contacts of the carpet with bodies lose energy (contact_restitution below 1)"};
  if (name.empty()) return {false, "every material has contact_restitution 1"};
  return {true, "contacts of " + name + " lose energy (contact_restitution below 1)"};
}

bool has_no_shells(const Scene& scene) {
  const auto backing = scene.effects.choice.find("backing");
  const bool asked_for = backing != scene.effects.choice.end() && backing->second == Switch::on;
  return is_switched_off(scene, "fibres") && !asked_for;
}

Need need_erosion(const Scene& scene) {
  if (scene.rig.is_specimen()) return {false, "a specimen of infill has no shells"};
  const CarpetDesign& carpet = scene.turf.carpet;
  if (!scene.rig.is_component() && has_no_shells(scene))
    return {false, "neither strands nor backing are there to fail"};
  const bool strand = scene.rig.type != "backing_tension", backing = scene.rig.type != "strand_tension";
  if (strand && carpet.fibre.can_fail()) return {true, "turf.carpet.fibre has a failure_strain"};
  if (backing && carpet.backing.can_fail()) return {true, "turf.carpet.backing has a failure_strain"};
  return {false, "no shell material has a failure_strain"};
}

/// Name of the first layer's material whose continuum passes a test, or empty.
std::string first_continuum(const Scene& scene, const std::function<bool(const SoilFoamMaterial&)>& test) {
  return first_with(scene, [&](const Material& m) { return m.continuum && test(*m.continuum); });
}

bool hardens(const SoilFoamMaterial& m) {
  return m.density_hardening &&
         (m.density_hardening->modulus_exponent > 0 || m.density_hardening->cohesion_exponent > 0 ||
          m.density_hardening->friction_exponent > 0);
}

Need need_density_hardening(const Scene& scene) {
  const std::string name = first_continuum(scene, hardens);
  if (name.empty()) return {false, "no material has a continuum.density_hardening with an exponent above 0"};
  return {true, "compaction makes " + name + " stiffer and stronger (density_hardening)"};
}

Need need_strength_softening(const Scene& scene) {
  const std::string name = first_continuum(scene, [](const SoilFoamMaterial& m) {
    return m.strength_softening &&
           (m.strength_softening->residual_cohesion < 1 || m.strength_softening->residual_friction < 1);
  });
  if (name.empty()) return {false, "no material has a continuum.strength_softening with a residual below 1"};
  return {true, "shearing takes strength from " + name + " (strength_softening)"};
}

Need need_strength_recovery(const Scene& scene) {
  if (is_switched_off(scene, "strength_softening") || !need_strength_softening(scene).on)
    return {false, "no strength is lost that could come back (strength_softening)"};
  const std::string name = first_continuum(scene, [](const SoilFoamMaterial& m) {
    return m.strength_recovery && (m.strength_recovery->time > 0 || m.strength_recovery->compression > 0);
  });
  if (name.empty())
    return {false, "no material has a continuum.strength_recovery with a time or compression above 0"};
  return {true, "lost strength of " + name + " comes back (strength_recovery)"};
}

Need need_strength_rate(const Scene& scene) {
  const std::string name = first_continuum(
      scene, [](const SoilFoamMaterial& m) { return m.strength_rate && m.strength_rate->coefficient > 0; });
  if (name.empty()) return {false, "no material has a continuum.strength_rate"};
  return {true, "strength of " + name + " grows with the rate of shear (strength_rate)"};
}

Need need_inertial_friction(const Scene& scene) {
  const std::string name = first_continuum(scene, [](const SoilFoamMaterial& m) {
    return m.inertial_friction && m.inertial_friction->increase > 0;
  });
  if (name.empty()) return {false, "no material has a continuum.inertial_friction"};
  return {true, "friction of " + name + " grows with the inertial number (inertial_friction)"};
}

Need need_dilation(const Scene& scene) {
  const std::string name =
      first_continuum(scene, [](const SoilFoamMaterial& m) { return m.dilation_angle > 0; });
  if (name.empty()) return {false, "no material has a continuum.dilation_angle above 0"};
  return {true, "shearing loosens " + name + " where it is compacted (dilation_angle)"};
}

bool modulus_follows_pressure(const SoilFoamMaterial& m) {
  if (m.unloading_ratio > 0) return m.pressure_exponential || m.pressure.x.size() > 2;
  return m.unloading.x.size() > 1;
}

Need need_shear_energy(const Scene& scene) {
  if (!is_switched_off(scene, "density_hardening") && need_density_hardening(scene).on)
    return {true, "density_hardening changes the shear modulus: no cycle may gain energy from that"};
  return {false, "a choice: the deviator is kept when pressure changes the shear modulus, as in rate form"};
}

Need usable_shear_energy(const Scene& scene) {
  if (first_continuum(scene, modulus_follows_pressure).empty() && !need_shear_energy(scene).on)
    return {false, "no material's shear modulus changes"};
  return {true, ""};
}

constexpr std::array<EffectRule, effect_names.size()> rules{{
    {"fibres", std::nullopt, need_fibres},
    {"backing", std::nullopt, need_backing, usable_backing, "fibres"},
    {"friction_rate", std::nullopt, need_friction_rate},
    {"artificial_viscosity", Approach::sph, need_artificial_viscosity},
    {"zero_energy_control", Approach::sph, need_zero_energy_control},
    {"fibre_separation", Approach::sph, need_fibre_separation, usable_fibre_separation},
    {"tension_cutoff", Approach::sph, need_tension_cutoff},
    {"rolling_resistance", Approach::dem, need_rolling_resistance},
    {"grain_cohesion", Approach::dem, need_grain_cohesion},
    {"clumps", Approach::dem, need_clumps},
    {"overlap_release", std::nullopt, need_overlap_release},
    {"contact_damping", std::nullopt, need_contact_damping},
    {"erosion", std::nullopt, need_erosion},
    {"density_hardening", Approach::sph, need_density_hardening},
    {"strength_softening", Approach::sph, need_strength_softening},
    {"strength_recovery", Approach::sph, need_strength_recovery},
    {"strength_rate", Approach::sph, need_strength_rate},
    {"inertial_friction", Approach::sph, need_inertial_friction},
    {"dilation", Approach::sph, need_dilation},
    {"shear_energy", Approach::sph, need_shear_energy, usable_shear_energy},
}};

static_assert([] {
  for (std::size_t i = 0; i < rules.size(); ++i)
    if (rules[i].name != effect_names[i]) return false;
  return true;
}());

bool is_of_other_approach(const EffectRule& rule, const Scene& scene) {
  return rule.only && *rule.only != scene.infill.approach;
}

Switch choice_of(const EffectRule& rule, const Scene& scene) {
  const auto chosen = scene.effects.choice.find(std::string(rule.name));
  return chosen == scene.effects.choice.end() ? Switch::automatic : chosen->second;
}

/// Whether a rule's effect has something to act on when it is switched on by hand.
Need able(const EffectRule& rule, const Scene& scene) {
  return (rule.usable != nullptr ? rule.usable : rule.needed)(scene);
}

EffectDecision decide(const EffectRule& rule, const Scene& scene) {
  const std::string name(rule.name);
  if (is_of_other_approach(rule, scene))
    return {name, false, *rule.only == Approach::sph ? "only for sph infill" : "only for dem infill"};
  const Switch choice = choice_of(rule, scene);
  if (choice == Switch::on) return {name, true, "switched on in the scene"};
  if (choice == Switch::off) return {name, false, "switched off in the scene"};
  const Need need = rule.needed(scene);
  return {name, need.on, need.why};
}

}  // namespace

std::vector<EffectDecision> decide_effects(const Scene& scene) {
  std::vector<EffectDecision> decisions;
  // A strip of the carpet's material can fail; infill alone lacks what takes a carpet; all are effects of a
  // filled turf.
  const auto can_act = [&](std::string_view name) {
    if (scene.rig.is_component()) return name == "erosion";
    if (name == "fibre_separation" && scene.rig.is_specimen()) return scene.rig.type == "pull_out";
    return !scene.rig.is_specimen() ||
           (name != "erosion" && name != "fibres" && name != "backing" && name != "overlap_release");
  };
  for (const EffectRule& rule : rules)
    if (can_act(rule.name)) decisions.push_back(decide(rule, scene));
  return decisions;
}

std::optional<EffectDecision> idle_effect(const Scene& scene) {
  for (const EffectRule& rule : rules) {
    if (choice_of(rule, scene) != Switch::on || is_of_other_approach(rule, scene)) continue;
    if (const Need need = able(rule, scene); !need.on)
      return EffectDecision{
          std::string(rule.name), false,
          "switched on, but has nothing to act on: " + need.why + "; change that, or leave this \"auto\""};
  }
  if (scene.rig.is_specimen() || scene.rig.is_component()) return std::nullopt;
  for (const EffectRule& rule : rules)
    if (!rule.borne.empty() && choice_of(rule, scene) == Switch::off &&
        !is_switched_off(scene, std::string(rule.borne)))
      return EffectDecision{
          std::string(rule.name), true,
          fmt::format("switched off, but effects.{} stands on it; switch that off too, or leave this "
                      "\"auto\"",
                      rule.borne)};
  return std::nullopt;
}

std::string effect_obstacle(const Scene& scene, std::string_view effect) {
  const auto rule =
      std::find_if(rules.begin(), rules.end(), [&](const EffectRule& r) { return r.name == effect; });
  if (rule == rules.end()) throw std::logic_error(fmt::format("no effect is named {}", effect));
  if (is_of_other_approach(*rule, scene)) return decide(*rule, scene).why;
  const Need need = able(*rule, scene);
  return need.on ? std::string() : need.why;
}

bool effect_on(const std::vector<EffectDecision>& decisions, std::string_view name) {
  return std::any_of(decisions.begin(), decisions.end(),
                     [name](const EffectDecision& decision) { return decision.name == name && decision.on; });
}

}  // namespace tuft

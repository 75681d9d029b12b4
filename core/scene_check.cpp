#include "core/scene_check.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/grain_check.h"

namespace tuft {
namespace {

constexpr double tray_above_infill = 0.020;   // m, default freeboard
constexpr double margin_over_missile = 0.10;  // of its diameter, on each side of the patch
constexpr double share_tolerance = 1e-6;
constexpr double wendland_over_pitch = 1.3;  // about 75 neighbours (PHYSICS section 2)
constexpr double backing_strip_along = 0.016, backing_strip_across = 0.021;  // m, Bustamante et al. 2024
constexpr double fast_over_pitch = 1.0;  // about 30 neighbours (docs/theory/sph.md, Presets)
constexpr double specimen_over_pitch =
    0.9;  // rows on the walls stay in order to 30 % strain (docs/rigs/oedometer.md)
constexpr double published_over_pitch = 0.71;  // 1.42 mm at a pitch of 2 mm (Bustamante et al. 2024)

void check_virgin_curve(const Curve& curve, const std::string& path, const Places& places) {
  if (curve.x.size() < 2) places.fail(path, "needs at least two points");
  if (curve.x.front() != 0 || curve.y.front() != 0)
    places.fail(path, "must begin at strain 0 and pressure 0");
  for (std::size_t i = 1; i < curve.y.size(); ++i) {
    if (!(curve.y[i] > curve.y[i - 1]))
      places.fail(fmt::format("{}.values", path),
                  fmt::format("pressure must rise: value {} is not above the one before", i));
  }
}

/// Each part of the law by exactly one of its forms, and parameters that agree with each other.
void check_continuum(const SoilFoamMaterial& m, const std::string& path, const Places& places) {
  if (!m.pressure.x.empty() && m.pressure_exponential)
    places.fail(path + ".pressure_exponential", "first loading is given twice; leave out this or pressure");
  if (m.pressure.x.empty() && !m.pressure_exponential)
    places.fail(path + ".pressure",
                "missing; give first loading as pressure = { unit, strain, values } or as "
                "pressure_exponential = { modulus, growth }");
  if (!m.pressure.x.empty()) check_virgin_curve(m.pressure, path + ".pressure", places);
  if (!m.unloading.x.empty() && m.unloading_ratio > 0)
    places.fail(path + ".unloading_ratio", "unloading is given twice; leave out this or unloading");
  if (m.unloading.x.empty() && m.unloading_ratio == 0)
    places.fail(path + ".unloading",
                "missing; give unloading = { unit, pressure, modulus }, or unloading_ratio");
  if (m.unloading_ratio > 0 && m.unloading_ratio < 1)
    places.fail(path + ".unloading_ratio",
                "must be at least 1: unloading softer than loading would return more than was put in");
  if (m.mohr_coulomb && (m.yield_a0 > 0 || m.yield_a1 > 0 || m.yield_a2 > 0))
    places.fail(path + ".mohr_coulomb",
                "strength is given twice; leave out this or yield_a0, yield_a1 and yield_a2 (0 where a file "
                "gives them)");
}

void check_shares(const Material& material, const std::string& path, const Places& places) {
  double sum = 0;
  for (std::size_t i = 0; i < material.grain_shares.size(); ++i) {
    sum += material.grain_shares[i].mass_fraction;
    for (std::size_t j = 0; j < i; ++j)
      if (material.grain_shares[i].material == material.grain_shares[j].material)
        places.fail(fmt::format("{}.grain_shares.{}.material", path, i),
                    "named twice in this material; give one share");
  }
  if (!material.grain_shares.empty() && std::abs(sum - 1) > share_tolerance)
    places.fail(fmt::format("{}.grain_shares", path),
                fmt::format("mass fractions add up to {:g}; make it 1", sum));
}

/// What one key of a shell's material says of another; ranges of single keys are the schema's.
void check_shell_material(const ShellMaterial& m, const std::string& path, const Places& places) {
  double relaxing = 0;
  for (const PronyTerm& term : m.relaxation) relaxing += term.modulus;
  const double shear = m.young_modulus / (2 * (1 + m.poisson_ratio));
  if (relaxing > shear * (1 + 1e-9))
    places.fail(
        path + ".relaxation",
        fmt::format("its moduli add up to {:g} Pa, more than the instantaneous shear modulus of {:g} Pa; "
                    "raise young_modulus or lower them",
                    relaxing, shear));
  if (!m.orthotropic()) {
    if (m.shear_modulus > 0)
      places.fail(path + ".shear_modulus", "is for an orthotropic material; give across_young_modulus too");
    return;
  }
  if (!(m.shear_modulus > 0))
    places.fail(path + ".across_young_modulus", "makes the material orthotropic; give shear_modulus too");
  if (!m.relaxation.empty())
    places.fail(path + ".across_young_modulus",
                "orthotropic and relaxing at once is not there; leave one out");
  const double mean = m.poisson_ratio * std::sqrt(m.across_young_modulus / m.young_modulus);
  if (!(mean < 0.5))
    places.fail(
        path + ".poisson_ratio",
        fmt::format("the mean of both ratios, nu sqrt(across / along), is {:g}; it must be under 0.5", mean));
}

struct PresetValues {
  Kernel kernel;
  double over_pitch;  ///< smoothing length / pitch
  bool zero_energy_control = true;
};

std::optional<PresetValues> preset_values(const std::string& preset) {
  if (preset == "accurate") return PresetValues{Kernel::wendland_c2, wendland_over_pitch};
  if (preset == "fast") return PresetValues{Kernel::cubic_spline, fast_over_pitch};
  if (preset == "paper") return PresetValues{Kernel::cubic_spline, published_over_pitch, false};
  if (preset == "specimen") return PresetValues{Kernel::cubic_spline, specimen_over_pitch};
  return std::nullopt;
}

/// A preset decides the smoothing length, and the kernel unless the scene chooses one. A length of the user's
/// own needs preset "custom", lest a later change of the pitch leave one behind that the preset's name
/// belies.
void complete_sph(SphOptions& sph, const Places& places, bool of_specimen) {
  const bool preset_given = places.has("infill.sph.preset");
  if (!preset_given && of_specimen) sph.preset = "specimen";
  const bool own_length = places.has("infill.sph.smoothing_length") && sph.smoothing_length > 0;
  if (!preset_given && own_length) sph.preset = "custom";
  const auto values = preset_values(sph.preset);
  if (!values) {
    if (!own_length)
      places.fail("infill.sph.smoothing_length",
                  "missing; preset \"custom\" needs it, for example \"2.6 mm\"");
    return;
  }
  const double length = values->over_pitch * sph.pitch;
  if (own_length && std::abs(sph.smoothing_length - length) > 1e-9 * length)
    places.fail(
        "infill.sph.smoothing_length",
        fmt::format("preset \"{}\" makes it {} at this pitch; leave it out, or set preset = \"custom\"",
                    sph.preset, in_mm(length)));
  if (!own_length) sph.smoothing_length = length;
  if (!places.has("infill.sph.kernel")) sph.kernel = values->kernel;
  if (!values->zero_energy_control && !places.has("infill.sph.zero_energy_viscosity"))
    sph.zero_energy_viscosity = 0;
}

/// The material that `path` names must be usable with the approach that was chosen.
void check_infill_material(const Scene& scene, Index index, const std::string& path, const Places& places) {
  const Material& material = scene.materials.at(static_cast<std::size_t>(index));
  if (scene.infill.approach == Approach::sph) {
    if (!material.continuum)
      places.fail(path, fmt::format("has no [continuum] in {}, which approach \"sph\" needs", material.file));
    return;
  }
  if (material.grain_shares.empty())
    places.fail(path,
                fmt::format("has neither [grain] nor [[grain_shares]] in {}, which approach \"dem\" needs",
                            material.file));
  for (const GrainShare& share : material.grain_shares) {
    const Material& grain = scene.materials[static_cast<std::size_t>(share.material)];
    if (!grain.grain)
      places.fail(path, fmt::format("is made of \"{}\", which has no [grain] in {}", grain.name, grain.file));
  }
}

void check_layers(const Scene& scene, const Places& places) {
  for (std::size_t i = 0; i < scene.turf.layers.size(); ++i)
    check_infill_material(scene, scene.turf.layers[i].material, fmt::format("turf.layers.{}.material", i),
                          places);
}

void check_tray(Scene& scene, const Places& places) {
  const double depth = scene.infill_depth();
  if (scene.turf.tray_depth == 0) scene.turf.tray_depth = depth + tray_above_infill;
  // Depths are sums of decimal fractions: equal means equal to rounding.
  if (depth > scene.turf.tray_depth * (1 + 1e-12))
    places.fail("turf.tray_depth",
                fmt::format("layers are {} deep, deeper than the tray; make it deeper or the layers thinner",
                            in_mm(depth)));
}

void check_missile(const Scene& scene, const Places& places) {
  const CleggRig& clegg = scene.rig.clegg;
  for (std::size_t k = 0; k < 2; ++k) {
    const double reach = std::abs(clegg.position[k]) + (0.5 + margin_over_missile) * clegg.diameter;
    if (2 * reach <= scene.turf.size[k] * (1 + 1e-12)) continue;
    places.fail(fmt::format("turf.size.{}", k),
                fmt::format("the patch is smaller than the missile ({} wide, {} off the middle) and {} on "
                            "each side; at least "
                            "{} is needed",
                            in_mm(clegg.diameter), in_mm(std::abs(clegg.position[k])),
                            in_mm(margin_over_missile * clegg.diameter), in_mm(2 * reach)));
  }
}

void complete_tension(Scene& scene, const Places& places) {
  TensionRig& rig = scene.rig.tension;
  if (rig.gauge_lengths.size() != 1 && rig.gauge_lengths.size() != rig.rates.size())
    places.fail("rig.gauge_lengths", fmt::format("{} lengths for {} rates; give one for all, or one for each",
                                                 rig.gauge_lengths.size(), rig.rates.size()));
  for (std::size_t i = 0; i < rig.rates.size(); ++i)
    if (std::count(rig.rates.begin(), rig.rates.end(), rig.rates[i]) > 1)
      places.fail(fmt::format("rig.rates.{}", i), "given twice; leave one out");
  const CarpetDesign& carpet = scene.turf.carpet;
  if (!carpet.mesh.file.empty())
    places.fail("turf.carpet.mesh",
                "is not for a tension rig, whose strip has a mesh of its own; leave it out");
  const bool strand = scene.rig.type == "strand_tension";
  if (rig.width == 0)
    rig.width = strand                                   ? carpet.strand_width
                : rig.direction == StripDirection::along ? backing_strip_along
                                                         : backing_strip_across;
  scene.info.duration = 0;
  for (const double rate : rig.rates) scene.info.duration += rig.strain_limit / rate;
}

/// What the published tests have (Bustamante et al. 2024; ASTM D2435 and D3080).
struct SpecimenDefaults {
  double height, speed, sample_travel;
};
constexpr SpecimenDefaults published_ring{0.0127, 1e-3, 2e-6}, published_box{0.0195, 1e-4, 10e-6};
/// Assumed: height and rows of a pull-out, whose speeds are a list.
constexpr SpecimenDefaults assumed_pull_out{0.02, 0, 20e-6};

void check_pull_out(const SpecimenRig& rig, const CarpetDesign& carpet, const Places& places) {
  for (std::size_t i = 0; i < rig.speeds.size(); ++i)
    if (std::count(rig.speeds.begin(), rig.speeds.end(), rig.speeds[i]) > 1)
      places.fail(fmt::format("rig.speeds.{}", i), "given twice; leave one out");
  if (rig.embedded_length > rig.size[0])
    places.fail("rig.embedded_length",
                fmt::format("is more than the box is long ({}); make it shorter, or 0 for a "
                            "strand that passes through the whole box",
                            in_mm(rig.size[0])));
  if (rig.embedded_length > 0 && !(rig.travel < rig.embedded_length))
    places.fail("rig.travel", fmt::format("draws the strand out: only {} of it are embedded; make it less",
                                          in_mm(rig.embedded_length)));
  if (carpet.strand_width > rig.size[1])
    places.fail("rig.size.1", fmt::format("the box is narrower than the strand ({}); make it wider",
                                          in_mm(carpet.strand_width)));
  constexpr double fewest_rows = 20;  // in which the platens gather speed, and slow down before the stress
  for (const double speed : rig.speeds) {
    const double row = rig.sample_travel / (rig.run_speed > 0 ? rig.run_speed : speed);
    if (rig.load_time < fewest_rows * row)
      places.fail(
          "rig.load_time",
          fmt::format("is less than {:g} rows of {:.3g} ms (rig.sample_travel at {:g} mm/s), in which "
                      "the platens would press past rig.normal_stress; give at least {:.3g} ms",
                      fewest_rows, 1e3 * row, 1e3 * rig.sample_travel / row, 1e3 * fewest_rows * row));
  }
  if (rig.sample_travel > 0.02 * rig.travel)
    places.fail(
        "rig.sample_travel",
        fmt::format("is more than a fiftieth of rig.travel ({}); make it smaller", in_mm(rig.travel)));
}

void complete_specimen(Scene& scene, const Places& places) {
  SpecimenRig& rig = scene.rig.specimen;
  const bool ring = scene.rig.type == "oedometer", pull = scene.rig.has_strand();
  const SpecimenDefaults& defaults = ring ? published_ring : pull ? assumed_pull_out : published_box;
  if (rig.height == 0) rig.height = defaults.height;
  if (rig.speed == 0) rig.speed = defaults.speed;
  if (rig.sample_travel == 0) rig.sample_travel = defaults.sample_travel;
  check_infill_material(scene, rig.material, "rig.material", places);
  // Effects ask the layers what touches.
  scene.turf.layers = {{rig.material, rig.height}};
  // The room that coarse-grained fields span.
  scene.turf.size = ring ? std::array{rig.diameter, rig.diameter} : rig.size;
  if (pull) {
    // A continuum on both faces of a light strand: at 0.8 of the stable step contact fed energy in, 28 % of
    // what was at stake; at 0.4 the error was 5e-5.
    constexpr double safe_for_strand = 0.4;
    if (scene.infill.approach == Approach::sph && !places.has("numerics.step_safety"))
      scene.numerics.step_safety = safe_for_strand;
    return check_pull_out(rig, scene.turf.carpet, places);
  }
  const std::vector<double>& loads = ring ? rig.preloads : rig.normal_stresses;
  const char* name = ring ? "preloads" : "normal_stresses";
  for (std::size_t i = 0; i < loads.size(); ++i) {
    if (std::count(loads.begin(), loads.end(), loads[i]) > 1)
      places.fail(fmt::format("rig.{}.{}", name, i), "given twice; leave one out");
    if (ring && !(rig.seating_force < 0.5 * loads[i]))
      places.fail(fmt::format("rig.preloads.{}", i),
                  fmt::format("must be more than twice rig.seating_force ({:g} N)", rig.seating_force));
  }
  if (rig.sample_travel > 0.01 * rig.height)
    places.fail(
        "rig.sample_travel",
        fmt::format("is more than a hundredth of the height ({}); make it smaller", in_mm(rig.height)));
}

/// An effect that is asked for must have something to act on, and what it stands on.
void check_effects(const Scene& scene, const Places& places) {
  if (const auto idle = idle_effect(scene)) places.fail("effects." + idle->name, idle->why);
}

/// What sleeps is not computed, so nothing of it may change with time alone.
void check_sleep(const Scene& scene, const Places& places) {
  if (scene.numerics.sleep_tolerance == 0 || scene.infill.approach != Approach::sph) return;
  if (!effect_on(decide_effects(scene), "strength_recovery")) return;
  for (const Layer& layer : scene.turf.layers) {
    const Material& material = scene.materials[static_cast<std::size_t>(layer.material)];
    const auto& recovery = material.continuum->strength_recovery;
    if (recovery && recovery->time > 0)
      places.fail("numerics.sleep_tolerance",
                  fmt::format("{} regains strength with time, at rest too (strength_recovery.time), and what "
                              "sleeps is not computed; set this to 0, or effects.strength_recovery = false",
                              material.name));
  }
}

void check_individual_steps(const Scene& scene, const Places& places) {
  const int steps = scene.numerics.individual_steps;
  if ((steps & (steps - 1)) != 0) places.fail("numerics.individual_steps", "give 1, 2, 4, 8 or 16");
}

}  // namespace

std::string in_mm(double metres) {
  return fmt::format("{:g} mm", std::round(metres * 1e6) / 1e3);
}

void complete_material(Material& material, Index self, const std::string& path, const Places& places) {
  if (material.continuum) {
    if (material.continuum->density == 0) material.continuum->density = material.bulk_density;
    check_continuum(*material.continuum, path + ".continuum", places);
  }
  if (material.grain) {
    complete_grain(*material.grain, path + ".grain", places);
    if (material.grain_shares.empty()) material.grain_shares = {{self, 1.0}};
  }
  check_shares(material, path, places);
}

void complete_scene(Scene& scene, const Places& places) {
  if (scene.rig.is_specimen()) {
    if (scene.rig.has_strand()) check_shell_material(scene.turf.carpet.fibre, "turf.carpet.fibre", places);
    complete_sph(scene.infill.sph, places, true);
    complete_specimen(scene, places);
    // A scene's rig.material may be another than its author's, whose grains then matter to grains alone.
    if (scene.infill.approach == Approach::dem) complete_dem(scene, places);
    check_effects(scene, places);
    return;
  }
  check_shell_material(scene.turf.carpet.fibre, "turf.carpet.fibre", places);
  check_shell_material(scene.turf.carpet.backing, "turf.carpet.backing", places);
  if (scene.rig.is_component()) return complete_tension(scene, places);
  complete_sph(scene.infill.sph, places, false);
  complete_dem(scene, places);
  check_layers(scene, places);
  check_tray(scene, places);
  check_conditioning(scene, places);
  check_missile(scene, places);
  check_effects(scene, places);
  check_sleep(scene, places);
  check_individual_steps(scene, places);
}

}  // namespace tuft

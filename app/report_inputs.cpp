/// Effects, settings and materials: what a reader needs to judge or repeat the run.
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "app/html.h"
#include "app/number_format.h"
#include "app/report_sections.h"
#include "dem_bridge/dem_infill.h"
#include "sph_infill/soil_law.h"

namespace tuft::app {
namespace {

/// Of each grain material in the layers, by its own factor or that of all.
std::string describe_coarse_graining(const Scene& scene) {
  std::set<std::string> factors;
  for (const Layer& layer : scene.turf.layers)
    for (const GrainShare& share :
         scene.materials.at(static_cast<std::size_t>(layer.material)).grain_shares) {
      const std::string& name = scene.materials.at(static_cast<std::size_t>(share.material)).name;
      factors.insert(fmt::format("{} {}", escape_html(name),
                                 format_input(dem::coarse_graining_of(scene.infill.dem, name))));
    }
  return fmt::format("coarse graining {}", fmt::join(factors, ", "));
}

std::vector<std::string> effect_names(const Runs& runs) {
  std::vector<std::string> names;
  for (const RunData& run : runs)
    for (const EffectDecision& effect : run.summary.effects)
      if (std::find(names.begin(), names.end(), effect.name) == names.end()) names.push_back(effect.name);
  return names;
}

const EffectDecision* find_effect(const RunData& run, const std::string& name) {
  for (const EffectDecision& effect : run.summary.effects)
    if (effect.name == name) return &effect;
  return nullptr;
}

/// One reason where the runs agree, else each with its run's name.
std::string reasons(const Runs& runs, const std::string& name) {
  std::set<std::string> different;
  for (const RunData& run : runs)
    if (const EffectDecision* effect = find_effect(run, name)) different.insert(effect->why);
  if (different.size() == 1) return escape_html(*different.begin());
  std::string text;
  for (const RunData& run : runs)
    if (const EffectDecision* effect = find_effect(run, name))
      text += fmt::format("{}{}: {}", text.empty() ? "" : "<br>", escape_html(run.label),
                          escape_html(effect->why));
  return text;
}

std::string settings_table(const Runs& runs) {
  HtmlTable table{"settings-table", "", run_header("", runs), {}, false};
  const auto add = [&](const std::string& name, const std::function<std::string(const Scene&)>& text) {
    std::vector<std::string> row{name};
    for (const RunData& run : runs) row.push_back(run.scene ? text(*run.scene) : not_available);
    table.rows.push_back(std::move(row));
  };
  add("Step safety, of every part’s stable step",
      [](const Scene& s) { return format_input(s.numerics.step_safety); });
  add("Coupling window", [](const Scene& s) {
    return s.numerics.coupling_window > 0 ? format_quantity(s.numerics.coupling_window, "s")
                                          : "the infill’s own step";
  });
  if (std::any_of(runs.begin(), runs.end(),
                  [](const RunData& r) { return r.scene && r.scene->conditioning.on(); }))
    add("Conditioning", [](const Scene& s) -> std::string {
      const Conditioning& c = s.conditioning;
      if (!c.on()) return "none";
      if (c.method == "roller")
        return fmt::format("{} by a roller of {} with {} studs around, {} passes at {}",
                           format_quantity(c.depth, "m"), format_quantity(c.roller.diameter, "m"),
                           c.roller.studs_around, c.roller.passes, format_quantity(c.roller.speed, "m/s"));
      if (c.presses > 1)
        return fmt::format("{} by a plate, at most {} times in {}, lifted in {}, settled for {}",
                           format_quantity(c.depth, "m"), c.presses, format_quantity(c.press_time, "s"),
                           format_quantity(c.lift_time, "s"), format_quantity(c.settle_time, "s"));
      return fmt::format("{} by a plate in {}, lifted in {}, settled for {}", format_quantity(c.depth, "m"),
                         format_quantity(c.press_time, "s"), format_quantity(c.lift_time, "s"),
                         format_quantity(c.settle_time, "s"));
    });
  add("Settling before the release",
      [](const Scene& s) { return format_quantity(s.numerics.settle_time, "s"); });
  add("Release of initial overlap",
      [](const Scene& s) { return format_quantity(s.numerics.contact_release_time, "s"); });
  add("Seed", [](const Scene& s) { return fmt::format("{}", s.numerics.seed); });
  add("Threads", [](const Scene& s) {
    return s.numerics.threads > 0 ? fmt::format("{}", s.numerics.threads) : "all cores";
  });
  add("Resolution", [](const Scene& s) {
    return s.infill.approach == Approach::sph
               ? fmt::format("pitch {}, {} preset, {}", format_quantity(s.infill.sph.pitch, "m"),
                             escape_html(s.infill.sph.preset),
                             s.infill.sph.kernel == Kernel::wendland_c2 ? "Wendland C2" : "cubic spline")
               : describe_coarse_graining(s);
  });
  return table.html();
}

/// What the run itself measured about its numerics: steps of each part, overlap, compliance.
std::string notes_table(const Runs& runs) {
  std::set<std::string> names;
  for (const RunData& run : runs)
    for (const auto& [name, quantity] : run.summary.notes) names.insert(name);
  if (names.empty()) return {};
  HtmlTable table{"notes-table", "", run_header("Measured by the run", runs), {}, false};
  for (const std::string& name : names) {
    std::vector<std::string> row{escape_html(readable_name(name))};
    for (const RunData& run : runs) {
      const auto found = run.summary.notes.find(name);
      row.push_back(found == run.summary.notes.end()
                        ? "–"
                        : escape_html(format_quantity(found->second.value, found->second.unit)));
    }
    table.rows.push_back(std::move(row));
  }
  return table.html();
}

std::string describe_grain(const GrainMaterial& grain) {
  return fmt::format("solid {} kg/m³, E {}, ν {}, restitution {}, friction {}, rolling {}, {}–{} mm",
                     format_significant(grain.density, 4), format_quantity(grain.young_modulus, "Pa"),
                     format_significant(grain.poisson_ratio, 2), format_significant(grain.restitution, 2),
                     format_significant(grain.friction, 2), format_significant(grain.rolling_friction, 2),
                     format_significant(1e3 * grain.diameter_min, 2),
                     format_significant(1e3 * grain.diameter_max, 2));
}

std::string describe_continuum(const SoilFoamMaterial& law) {
  std::array<double, 3> yield{law.yield_a0, law.yield_a1, law.yield_a2};
  if (law.mohr_coulomb) yield = sph::yield_of(*law.mohr_coulomb);
  return fmt::format("soil and foam, cohesion {}, slope α {}, G/K {}, tension cutoff {}",
                     format_quantity(std::sqrt(std::max(0.0, yield[0])), "Pa"),
                     format_significant(std::sqrt(std::max(0.0, yield[2])), 3),
                     format_significant(law.shear_ratio, 2), format_quantity(law.tension_cutoff, "Pa"));
}

std::string materials_table(const Scene& scene) {
  HtmlTable table{"materials-table",
                  "",
                  {"Material", "Bulk density", "As a continuum", "As grains", "Friction with fibres"},
                  {},
                  true};
  for (const Material& material : scene.materials) {
    std::string grains = material.grain ? describe_grain(*material.grain) : "";
    if (grains.empty())
      for (const GrainShare& share : material.grain_shares)
        grains += fmt::format("{}{:.0f} % {}", grains.empty() ? "" : ", ", 100 * share.mass_fraction,
                              escape_html(scene.materials.at(static_cast<std::size_t>(share.material)).name));
    const FrictionLaw& friction = material.fibre_friction;
    table.rows.push_back(
        {escape_html(material.name), format_input(material.bulk_density) + " kg/m³",
         material.continuum ? describe_continuum(*material.continuum) : "–", grains.empty() ? "–" : grains,
         fmt::format("{} at rest to {} sliding", format_significant(friction.static_coefficient, 2),
                     format_significant(friction.dynamic_coefficient, 2))});
  }
  return table.html();
}

}  // namespace

std::string report_effects(const Runs& runs) {
  HtmlTable table{"effects-table", "", run_header("Effect", runs), {}, true};
  table.header.push_back("Why");
  for (const std::string& name : effect_names(runs)) {
    std::vector<std::string> row{escape_html(readable_name(name))};
    for (const RunData& run : runs) {
      const EffectDecision* effect = find_effect(run, name);
      row.push_back(effect == nullptr ? "–" : effect->on ? "<b>on</b>" : "<span class=\"off\">off</span>");
    }
    row.push_back(reasons(runs, name));
    table.rows.push_back(std::move(row));
  }
  return html_section("effects", "Effects",
                      table.html() +
                          "<p class=\"note\">What each costs in time is measured by <code>tuft explain SCENE "
                          "--cost</code>, also from the scene.toml of a run’s folder.</p>\n");
}

std::string report_specimen_inputs(const Runs& runs) {
  HtmlTable table{"settings-table", "", run_header("", runs), {}, false};
  const auto add = [&](const std::string& name, const std::function<std::string(const Scene&)>& text) {
    std::vector<std::string> row{name};
    for (const RunData& run : runs) row.push_back(text(*run.scene));
    table.rows.push_back(std::move(row));
  };
  add("Pitch of the particles", [](const Scene& s) { return format_quantity(s.infill.sph.pitch, "m"); });
  add("Smoothing length", [](const Scene& s) { return format_quantity(s.infill.sph.smoothing_length, "m"); });
  add("Friction on side walls", [](const Scene& s) { return format_input(s.rig.specimen.wall_friction); });
  add("Step safety", [](const Scene& s) { return format_input(s.numerics.step_safety); });
  std::string text = "<div class=\"columns\">\n" + table.html() + notes_table(runs) + "</div>\n";
  for (const RunData& run : runs)
    text += fmt::format("<h3>Material of {}</h3>\n", escape_html(run.label)) + materials_table(*run.scene);
  return html_section("inputs", "Settings and materials",
                      text +
                          "<p class=\"note\">All inputs with every default written out are in "
                          "<code>scene.toml</code> in each run’s folder.</p>\n");
}

std::string report_inputs(const Runs& runs) {
  std::string text = "<div class=\"columns\">\n" + settings_table(runs) + notes_table(runs) + "</div>\n";
  const auto with_scene =
      std::find_if(runs.begin(), runs.end(), [](const RunData& run) { return run.scene.has_value(); });
  if (with_scene != runs.end()) text += "<h3>Materials</h3>\n" + materials_table(*with_scene->scene);
  text +=
      "<p class=\"note\">All inputs with every default written out are in <code>scene.toml</code> in each "
      "run’s folder; where each material number comes from is said beside it in the material files.</p>\n";
  return html_section("inputs", "Settings and materials", text);
}

}  // namespace tuft::app

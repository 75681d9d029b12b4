#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/effect_cost_table.h"
#include "app/number_format.h"
#include "app/progress_display.h"
#include "app/stop_signal.h"
#include "app/text_table.h"
#include "app/verbs.h"
#include "core/error.h"
#include "rigs/run.h"
#include "rigs/schedule.h"
#include "studies/effect_cost.h"
#include "studies/stepped_scene.h"

namespace tuft::app {
namespace {

struct ExplainArguments {
  SceneArguments scene;
  bool cost = false;
  double cost_seconds = 60;
  std::vector<std::string> only;
};

std::string effects_table(const rigs::RunPlan& plan) {
  TextTable table;
  table.set_prose(2);
  for (const EffectDecision& effect : plan.effects)
    table.add({effect.name, effect.on ? "on" : "off", effect.why});
  return table.text();
}

std::string sizes_table(const Scene& scene, const rigs::RunPlan& plan) {
  TextTable table;
  table.add({"patch", fmt::format("{} x {} mm", format_significant(1e3 * scene.turf.size[0], 4),
                                  format_significant(1e3 * scene.turf.size[1], 4))});
  table.add({"infill depth", format_quantity(scene.infill_depth(), "m")});
  table.add({"particles", format_count(plan.particles)});
  table.add({"shell elements", format_count(plan.shells)});
  table.add({"shell nodes", format_count(plan.nodes)});
  return table.text();
}

std::string steps_table(const Scene& scene, const rigs::RunPlan& plan) {
  TextTable table({"", "step", "steps a window"});
  table.add({"coupling window", format_quantity(plan.window, "s"), "1"});
  table.add({"carpet", format_quantity(plan.carpet_step, "s"),
             format_count(static_cast<std::uint64_t>(plan.carpet_substeps))});
  const auto add_alone = [&](const char* name, double step) {
    if (step == 0) return;
    const bool slow = plan.carpet_subcycle > 1 && step >= plan.carpet_subcycle * plan.carpet_step;
    table.add({name, format_quantity(step, "s"),
               slow ? fmt::format("subcycled, every {} of the carpet's", plan.carpet_subcycle) : ""});
  };
  add_alone("  backing alone", plan.backing_step);
  add_alone("  fibres alone", plan.fibre_step);
  table.add({"infill", format_quantity(plan.infill_step, "s"),
             format_count(static_cast<std::uint64_t>(plan.infill_substeps))});
  const rigs::Schedule schedule = rigs::make_schedule(scene);
  const std::string before =
      scene.conditioning.on()
          ? format_quantity(static_cast<double>(schedule.conditioned()) * schedule.interval, "s") +
                (scene.conditioning.presses > 1 ? " of conditioning at most, " : " of conditioning, ")
          : "";
  return table.text() + fmt::format("  {} windows: {}{} of settling, then {} of the drop\n",
                                    format_count(plan.windows), before,
                                    format_quantity(scene.numerics.settle_time, "s"),
                                    format_quantity(scene.info.duration, "s"));
}

/// Of a rig that tests the carpet alone.
void explain_component(const Scene& scene, const rigs::RunPlan& plan) {
  fmt::print("{} ({})\n", scene.info.name, scene.rig.type);
  TextTable tests({"", "gauge length", "test", "strain to"});
  const TensionRig& rig = scene.rig.tension;
  for (std::size_t i = 0; i < rig.rates.size(); ++i)
    tests.add(
        {fmt::format("{:g} 1/s", rig.rates[i]),
         format_quantity(rig.gauge_lengths.size() == 1 ? rig.gauge_lengths[0] : rig.gauge_lengths[i], "m"),
         format_quantity(rig.strain_limit / rig.rates[i], "s"), format_percent(rig.strain_limit)});
  TextTable sizes;
  sizes.add({"width", format_quantity(rig.width, "m")});
  sizes.add({"shell elements", format_count(plan.shells)});
  sizes.add({"shell nodes", format_count(plan.nodes)});
  sizes.add({"smallest step at first", format_quantity(plan.carpet_step, "s")});
  sizes.add({"steps, about", format_count(plan.windows)});
  fmt::print("\nTests\n{}\nSizes\n{}", tests.text(), sizes.text());
}

/// Of a rig that tests infill alone.
void explain_specimen(const Scene& scene, const rigs::RunPlan& plan) {
  const SpecimenRig& rig = scene.rig.specimen;
  const bool ring = scene.rig.type == "oedometer", pull = scene.rig.has_strand();
  fmt::print("{} ({}, {} infill)\n\nEffects\n{}", scene.info.name, scene.rig.type,
             scene.infill.approach == Approach::sph ? "SPH" : "DEM", effects_table(plan));
  TextTable tests({"", ring ? "preload" : pull ? "speed" : "normal stress"});
  const std::vector<double>& values = ring ? rig.preloads : pull ? rig.speeds : rig.normal_stresses;
  for (std::size_t i = 0; i < values.size(); ++i)
    tests.add({fmt::format("test {}", i + 1), format_quantity(values[i], ring ? "N" : pull ? "m/s" : "Pa")});
  TextTable sizes;
  sizes.add({"material", scene.materials.at(static_cast<std::size_t>(rig.material)).name});
  sizes.add(
      {"specimen", ring ? fmt::format("{} across, {} high", format_quantity(rig.diameter, "m"),
                                      format_quantity(rig.height, "m"))
                        : fmt::format("{} x {}, {} high", format_quantity(rig.size[0], "m"),
                                      format_quantity(rig.size[1], "m"), format_quantity(rig.height, "m"))});
  if (pull)
    sizes.add(
        {"strand", fmt::format("{} wide, {} embedded", format_quantity(scene.turf.carpet.strand_width, "m"),
                               rig.embedded_length > 0 ? format_quantity(rig.embedded_length, "m")
                                                       : "all through the box")});
  sizes.add({"particles", format_count(plan.particles)});
  sizes.add({"step at first", format_quantity(plan.window, "s")});
  sizes.add({"steps, about", format_count(plan.windows)});
  fmt::print("\nTests\n{}\nSizes\n{}", tests.text(), sizes.text());
}

/// Measures and prints what effects cost; the exit code.
int explain_cost(const ExplainArguments& arguments, const Scene& scene, const rigs::RunPlan& plan) {
  const std::atomic<bool>& stop = catch_stop_signals();
  ProgressDisplay display("");
  const double interval = studies::interval_of(scene);
  studies::CostRequest request;
  request.scene = scene;
  request.seconds = arguments.cost_seconds;
  request.only = arguments.only;
  request.memory_bytes = plan.predicted_memory_bytes;
  request.stop = &stop;
  request.on_packing = [&](double done) {
    if (stop) throw_run_error("stopped while grains were packed");
    display.show_line("packing", fmt::format("packing   {:3.0f} %", 100 * done));
  };
  request.on_progress = [&](const studies::TurnProgress& progress) {
    const std::string line = effect_cost_progress(progress, interval);
    display.show_line(line.substr(0, line.find(' ')), line);
  };
  const studies::EffectCosts costs = studies::measure_effect_costs(request);
  display.finish();
  fmt::print("\n{}", effect_cost_text(costs));
  return costs.end == studies::TurnRecord::End::stopped ? 1 : 0;
}

int explain(const ExplainArguments& arguments) {
  const Scene scene = read_scene_arguments(arguments.scene);
  const rigs::RunPlan plan = rigs::plan(scene);
  if (scene.rig.is_component()) {
    explain_component(scene, plan);
  } else if (scene.rig.is_specimen()) {
    explain_specimen(scene, plan);
  } else {
    fmt::print("{} ({} infill)\n", scene.info.name, scene.infill.approach == Approach::sph ? "SPH" : "DEM");
    fmt::print("\nEffects\n{}", effects_table(plan));
    fmt::print("\nSizes\n{}", sizes_table(scene, plan));
    fmt::print("\nSteps\n{}", steps_table(scene, plan));
  }
  TextTable cost;
  cost.add({"wall time", format_duration(plan.predicted_wall_s)});
  cost.add({"memory", format_bytes(plan.predicted_memory_bytes)});
  fmt::print("\nPredicted, on this machine\n{}", cost.text());
  if (!plan.remarks.empty()) fmt::print("\nRemarks\n");
  for (const std::string& remark : plan.remarks) fmt::print("  {}\n", remark);
  if (!arguments.cost) return 0;
  fmt::print("\n");
  return explain_cost(arguments, scene, plan);
}

}  // namespace

void register_explain(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand(
      "explain", "Which effects are on and why, sizes, steps, predicted time and memory");
  auto arguments = std::make_shared<ExplainArguments>();
  add_scene_options(*verb, arguments->scene, true);
  CLI::Option* cost = verb->add_flag(
      "--cost", arguments->cost,
      "measures what each effect costs: steps the scene with and without each, in turns (docs/effects.md)");
  verb->add_option("--cost-seconds", arguments->cost_seconds,
                   "wall time that may take once the scene is built (default: 60)")
      ->check(CLI::PositiveNumber)
      ->needs(cost);
  verb->add_option("--only", arguments->only, "an effect to look at, instead of all; may be given again")
      ->type_name("EFFECT")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false)
      ->needs(cost);
  verb->callback([arguments, &action] { action = [arguments] { return explain(*arguments); }; });
}

}  // namespace tuft::app

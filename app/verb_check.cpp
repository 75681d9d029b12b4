#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/number_format.h"
#include "app/verbs.h"
#include "rigs/run.h"

namespace tuft::app {
namespace {

int check(const SceneArguments& arguments) {
  const Scene scene = read_scene_arguments(arguments);
  rigs::check_host(scene);
  const rigs::RunPlan plan = rigs::plan(scene);
  if (scene.rig.is_component())
    fmt::print("{}: {}, {} shells, {} steps of {}\n", arguments.scene, scene.rig.type,
               format_count(plan.shells), format_count(plan.windows), format_quantity(plan.carpet_step, "s"));
  else if (scene.rig.is_specimen())
    fmt::print("{}: {}, {} particles, about {} steps\n", arguments.scene, scene.rig.type,
               format_count(plan.particles), format_count(plan.windows));
  else
    fmt::print("{}: {} infill, {} particles, {} shells, {} windows of {}\n", arguments.scene,
               scene.infill.approach == Approach::sph ? "SPH" : "DEM", format_count(plan.particles),
               format_count(plan.shells), format_count(plan.windows), format_quantity(plan.window, "s"));
  for (const std::string& remark : plan.remarks) fmt::print("note: {}\n", remark);
  fmt::print("ok\n");
  return 0;
}

}  // namespace

void register_check(CLI::App& program, Action& action) {
  CLI::App* verb =
      program.add_subcommand("check", "Everything about a scene that can be known without running it");
  auto arguments = std::make_shared<SceneArguments>();
  add_scene_options(*verb, *arguments, true);
  verb->callback([arguments, &action] { action = [arguments] { return check(*arguments); }; });
}

}  // namespace tuft::app

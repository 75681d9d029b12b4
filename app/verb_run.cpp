#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/execution.h"
#include "app/stop_signal.h"
#include "app/verbs.h"
#include "rigs/run_folder.h"

namespace tuft::app {
namespace {

struct RunArguments {
  SceneArguments scene;
  std::string folder;
  int stop_after_checkpoints = 0;
};

int run(const RunArguments& arguments) {
  rigs::RunRequest request;
  request.scene = read_scene_arguments(arguments.scene);
  const char* approach = request.scene.infill.approach == Approach::sph ? "sph" : "dem";
  if (request.scene.rig.is_component()) approach = "fe";
  request.folder = arguments.folder.empty() ? fmt::format("out/{}-{}", request.scene.info.name, approach)
                                            : arguments.folder;
  request.stop_after_checkpoints = arguments.stop_after_checkpoints;
  rigs::check_host(request.scene);
  rigs::prepare_run_folder(request.folder, request.scene);
  const std::atomic<bool>& stop = catch_stop_signals();
  request.stop = &stop;
  const rigs::RunSummary summary = AttendedRun(request, "").run(request);
  return conclude_run(request.folder, summary, stop);
}

}  // namespace

void register_run(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("run", "Run a scene; Ctrl-C writes a checkpoint and stops");
  auto arguments = std::make_shared<RunArguments>();
  add_scene_options(*verb, arguments->scene, true);
  verb->add_option("--out", arguments->folder,
                   "folder for the results (default: out/<scene name>-<approach>)")
      ->type_name("DIR");
  verb->add_option("--stop-after-checkpoints", arguments->stop_after_checkpoints,
                   "stop, to be resumed, after this many checkpoints")
      ->check(CLI::PositiveNumber);
  verb->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace tuft::app

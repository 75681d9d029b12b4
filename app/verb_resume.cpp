#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/execution.h"
#include "app/stop_signal.h"
#include "app/verbs.h"
#include "core/error.h"
#include "rigs/run_folder.h"

namespace tuft::app {
namespace {

struct ResumeArguments {
  std::string folder, host;
  int threads = -1;
  int stop_after_checkpoints = 0;
};

bool already_completed(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::exists(folder / "summary.json", ignored) &&
         rigs::read_summary(folder).status == "completed";
}

int resume(const ResumeArguments& arguments) {
  rigs::RunRequest request;
  request.folder = arguments.folder;
  request.resume = true;
  Overrides another;
  if (!arguments.host.empty()) another.push_back({"infill.dem.host", fmt::format("\"{}\"", arguments.host)});
  request.scene = rigs::read_run_scene(request.folder, another);
  if (!arguments.host.empty() && request.scene.infill.approach != Approach::dem)
    throw_input_error("--host {}: {} has no grains, and needs no host; leave it out", arguments.host,
                      arguments.folder);
  if (already_completed(request.folder)) {
    fmt::print("{}: completed already, nothing to resume\n", arguments.folder);
    return 0;
  }
  rigs::check_host(request.scene);
  std::error_code ignored;
  if (!std::filesystem::exists(request.folder / "checkpoint.h5", ignored)) {
    // The first checkpoint follows the first row. What has been recorded without is not written over.
    if (rigs::recorded_rows(request.folder) > 1)
      throw_input_error("{}: no checkpoint to resume from; run the scene again with another --out",
                        arguments.folder);
    fmt::print("{}: ended before its first checkpoint; it starts from the beginning\n", arguments.folder);
    request.resume = false;
  }
  if (arguments.threads >= 0) request.scene.numerics.threads = arguments.threads;
  request.stop_after_checkpoints = arguments.stop_after_checkpoints;
  const std::atomic<bool>& stop = catch_stop_signals();
  request.stop = &stop;
  const rigs::RunSummary summary = AttendedRun(request, "").run(request);
  return conclude_run(request.folder, summary, stop);
}

}  // namespace

void register_resume(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("resume", "Go on from a run's last checkpoint");
  auto arguments = std::make_shared<ResumeArguments>();
  verb->add_option("DIR", arguments->folder, "folder of the run")->required();
  verb->add_option("--threads", arguments->threads, "number of threads; 0: all cores")
      ->check(CLI::NonNegativeNumber);
  verb->add_option(
          "--host", arguments->host,
          "another host of the grains: path of a liggghts_host, or tcp://MACHINE:PORT of one that listens")
      ->type_name("HOST");
  verb->add_option("--stop-after-checkpoints", arguments->stop_after_checkpoints,
                   "stop again after this many checkpoints")
      ->check(CLI::PositiveNumber);
  verb->callback([arguments, &action] { action = [arguments] { return resume(*arguments); }; });
}

}  // namespace tuft::app

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/execution.h"
#include "app/number_format.h"
#include "app/report.h"
#include "app/stop_signal.h"
#include "app/summary_table.h"
#include "app/verbs.h"
#include "core/error.h"
#include "studies/compare.h"

namespace tuft::app {
namespace {

struct CompareArguments {
  SceneArguments scene;
  std::string folder;
};

std::vector<std::filesystem::path> folders_of(const std::vector<studies::ComparedRun>& runs) {
  std::vector<std::filesystem::path> folders;
  for (const studies::ComparedRun& run : runs) folders.push_back(run.folder);
  return folders;
}

/// One line for all failures: "sph: ...; dem: ...".
std::string failures_of(const std::vector<studies::ComparedRun>& runs) {
  std::string text;
  for (const studies::ComparedRun& run : runs)
    if (run.summary.status == "failed")
      text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", run.summary.approach, run.summary.error);
  return text;
}

int conclude(const std::filesystem::path& folder, const std::vector<studies::ComparedRun>& runs,
             bool stopped_by_signal) {
  std::vector<rigs::RunSummary> summaries;
  for (const studies::ComparedRun& run : runs) summaries.push_back(run.summary);
  const std::filesystem::path report = folder / "report.html";
  const std::string failures = failures_of(runs);
  if (!runs.empty()) {
    try {
      write_report(folders_of(runs), report);
      fmt::print("\n{}\nreport: {}\n", summary_table(summaries), report.string());
    } catch (const RunError&) {
      // After a full disk the runs' own errors say more than the report's.
      if (failures.empty()) throw;
      fmt::print("\n{}", summary_table(summaries));
    }
  }
  std::fflush(stdout);
  if (!failures.empty()) throw RunError(failures);
  for (const studies::ComparedRun& run : runs)
    if (run.summary.status == "stopped")
      fmt::print("{} stopped; go on with: tuft resume {}\n", run.summary.approach, run.folder.string());
  return stopped_by_signal ? 1 : 0;
}

int compare(const CompareArguments& arguments) {
  studies::CompareRequest request;
  for (const char* approach : {"sph", "dem"})
    request.scenes.push_back(read_scene_arguments(arguments.scene, approach));
  request.folder =
      arguments.folder.empty() ? "out/" + request.scenes.front().info.name + "-compare" : arguments.folder;
  const std::atomic<bool>& stop = catch_stop_signals();
  request.stop = &stop;
  std::unique_ptr<AttendedRun> attended;
  request.before_run = [&](rigs::RunRequest& run) {
    attended.reset();
    attended = std::make_unique<AttendedRun>(run, run.scene.infill.approach == Approach::sph ? "SPH" : "DEM");
  };
  request.after_run = [&](const rigs::RunSummary& summary) { attended->conclude(summary); };
  const std::vector<studies::ComparedRun> runs = studies::compare(request);
  attended.reset();
  return conclude(request.folder, runs, stop);
}

}  // namespace

void register_compare(CLI::App& program, Action& action) {
  CLI::App* verb =
      program.add_subcommand("compare", "The same scene with SPH and with DEM infill, side by side");
  auto arguments = std::make_shared<CompareArguments>();
  add_scene_options(*verb, arguments->scene, false);
  verb->add_option("--out", arguments->folder,
                   "folder for both runs and the report (default: out/<scene name>-compare)")
      ->type_name("DIR");
  verb->callback([arguments, &action] { action = [arguments] { return compare(*arguments); }; });
}

}  // namespace tuft::app

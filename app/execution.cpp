#include "app/execution.h"

#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include "app/number_format.h"
#include "app/report.h"
#include "app/summary_table.h"
#include "core/error.h"

namespace tuft::app {
namespace {

/// Progress in the log: each new stage, then a line every half minute.
class ProgressLog {
 public:
  void note(const rigs::Progress& progress) {
    if (progress.stage == stage_ && progress.wall - last_ < interval) return;
    stage_ = progress.stage;
    last_ = progress.wall;
    spdlog::info("{}", progress_line(progress));
  }

 private:
  static constexpr double interval = 30;  // s
  std::string stage_;
  double last_ = 0;
};

}  // namespace

AttendedRun::AttendedRun(rigs::RunRequest& request, const std::string& title)
    : display_(std::make_shared<ProgressDisplay>(title)), previous_logger_(spdlog::default_logger()) {
  const std::filesystem::path file = request.folder / "log.txt";
  try {
    auto logger = std::make_shared<spdlog::logger>(
        "run", std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string()));
    logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
    logger->flush_on(spdlog::level::info);
    // A full disk must end the run through its results, not print from inside the logger.
    logger->set_error_handler([](const std::string&) {});
    spdlog::set_default_logger(std::move(logger));
  } catch (const spdlog::spdlog_ex&) {
    throw_input_error("{}: cannot be written; make the folder writable or choose another --out",
                      file.string());
  }
  spdlog::info("{} '{}' with {}", request.resume ? "resuming" : "running", request.scene.info.name,
               request.scene.rig.is_component()                 ? "rig " + request.scene.rig.type
               : request.scene.infill.approach == Approach::sph ? "sph infill"
                                                                : "dem infill");
  request.on_progress = [display = display_, log = ProgressLog()](const rigs::Progress& progress) mutable {
    display->show(progress);
    log.note(progress);
  };
  // On the screen they follow the results.
  request.on_remark = [](const std::string& remark) { spdlog::warn("{}", remark); };
}

AttendedRun::~AttendedRun() {
  display_->finish();
  spdlog::set_default_logger(previous_logger_);
}

rigs::RunSummary AttendedRun::run(const rigs::RunRequest& request) {
  try {
    rigs::RunSummary summary = rigs::run(request);
    conclude(summary);
    return summary;
  } catch (const std::exception& error) {
    spdlog::error("failed: {}", error.what());
    throw;
  }
}

void AttendedRun::conclude(const rigs::RunSummary& summary) {
  if (summary.status == "failed")
    spdlog::error("failed: {}", summary.error);
  else
    spdlog::info("{} at {} after {} windows, energy error {}, in {}", summary.status,
                 format_quantity(summary.simulated_time, "s"), summary.steps,
                 format_percent(summary.energy_error), format_duration(summary.wall_s));
}

int conclude_run(const std::filesystem::path& folder, const rigs::RunSummary& summary,
                 bool stopped_by_signal) {
  const std::filesystem::path report = folder / "report.html";
  const bool failed = summary.status == "failed";
  try {
    write_report({folder}, report);
  } catch (const RunError&) {
    // After a full disk the report cannot be written either; the run's own error says more.
    if (!failed) throw;
  }
  fmt::print("\n{}", summary_table({summary}));
  for (const std::string& remark : summary.remarks) fmt::print("note: {}\n", remark);
  std::error_code ignored;
  if (std::filesystem::exists(report, ignored)) fmt::print("\nreport: {}\n", report.string());
  std::fflush(stdout);
  if (failed) throw RunError(summary.error);
  if (summary.status != "stopped") return 0;
  fmt::print("stopped at {}; go on with: tuft resume {}\n", format_quantity(summary.simulated_time, "s"),
             folder.string());
  return stopped_by_signal ? 1 : 0;
}

}  // namespace tuft::app

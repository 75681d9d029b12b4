#pragma once
/// What every verb that runs something has in common: the log in the run's folder, progress, signals.
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include "app/progress_display.h"
#include "rigs/run.h"

namespace spdlog {
class logger;
}

namespace tuft::app {

/// While it lives, a run's folder gets the log (`log.txt`, spdlog's default logger) and standard output its
/// progress.
class AttendedRun {
 public:
  /// Attaches to a request that is about to run. Throws InputError when log.txt cannot be written.
  AttendedRun(rigs::RunRequest& request, const std::string& title);
  ~AttendedRun();
  /// Runs it, and writes how it ended into the log. Throws what rigs::run throws.
  [[nodiscard]] rigs::RunSummary run(const rigs::RunRequest& request);
  /// Of a run that is made elsewhere: writes how it ended into the log.
  void conclude(const rigs::RunSummary& summary);
  AttendedRun(const AttendedRun&) = delete;
  AttendedRun& operator=(const AttendedRun&) = delete;

 private:
  std::shared_ptr<ProgressDisplay> display_;
  std::shared_ptr<spdlog::logger> previous_logger_;
};

/// Last words about a finished run, and the exit code: results, report, how to go on after a stop; for a
/// failed run throws RunError with the summary's error once everything recorded has been reported.
int conclude_run(const std::filesystem::path& folder, const rigs::RunSummary& summary,
                 bool stopped_by_signal);

}  // namespace tuft::app

#pragma once
/// Progress on standard output: one line rewritten in place on a terminal, a plain line now and then
/// elsewhere.
#include <chrono>
#include <string>

#include "rigs/run.h"

namespace tuft::app {

class ProgressDisplay {
 public:
  /// `title` begins every line: the approach, where there is more than one run.
  explicit ProgressDisplay(std::string title);
  void show(const rigs::Progress& progress);
  /// A line of one's own; a stage that is new is shown at once.
  void show_line(const std::string& stage, const std::string& line);
  /// Ends the line on a terminal. Called once the run is over.
  void finish();

 private:
  std::string title_;
  bool terminal_;
  bool line_open_ = false;
  std::string last_stage_;
  std::chrono::steady_clock::time_point last_plain_line_{};
};

/// "drop       7.40 of 30.0 ms   25 %   window 1 234   energy error 0.012 %   12.3 s, 40 s to go"
[[nodiscard]] std::string progress_line(const rigs::Progress& progress);

}  // namespace tuft::app

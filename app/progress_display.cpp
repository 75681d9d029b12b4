#include "app/progress_display.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "app/number_format.h"

namespace tuft::app {
namespace {

constexpr auto plain_line_interval = std::chrono::seconds(5);

std::size_t terminal_width() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

}  // namespace

std::string progress_line(const rigs::Progress& progress) {
  std::string line = fmt::format("{:<9}", progress.stage);
  // Packing counts its own share done; settling counts up to the release at zero.
  if (progress.end_time > 0 && progress.time >= 0 && progress.stage == "drop") {
    line += fmt::format(" {:6.2f} of {} ms  {:3.0f} %", 1e3 * progress.time,
                        format_significant(1e3 * progress.end_time, 3),
                        100 * std::clamp(progress.time / progress.end_time, 0.0, 1.0));
  } else if (progress.stage == "packing" && progress.end_time > 0 && progress.time > 0) {
    line += fmt::format(" {:3.0f} %", 100 * std::clamp(progress.time / progress.end_time, 0.0, 1.0));
  } else if (progress.time < 0) {
    line += fmt::format(" {:6.2f} ms to release", -1e3 * progress.time);
  }
  if (progress.window > 0)
    line += fmt::format("  window {}  energy error {}", format_count(progress.window),
                        format_percent(progress.energy_error, 2));
  line += fmt::format("  {}", format_duration(progress.wall));
  if (progress.eta >= 0) line += fmt::format(", {} to go", format_duration(progress.eta));
  return line;
}

ProgressDisplay::ProgressDisplay(std::string title)
    : title_(std::move(title)), terminal_(isatty(STDOUT_FILENO) == 1) {}

void ProgressDisplay::show(const rigs::Progress& progress) {
  const std::string line = progress_line(progress);
  show_line(progress.stage, title_.empty() ? line : fmt::format("{:<4} {}", title_, line));
}

void ProgressDisplay::show_line(const std::string& stage, const std::string& line) {
  if (terminal_) {
    // Longer than the terminal, a line would wrap and could no longer be rewritten. ESC [K clears what the
    // last one left.
    fmt::print("\r{}\x1b[K", line.substr(0, terminal_width() - 1));
    line_open_ = true;
  } else {
    const auto now = std::chrono::steady_clock::now();
    if (stage == last_stage_ && now - last_plain_line_ < plain_line_interval) return;
    last_stage_ = stage;
    last_plain_line_ = now;
    fmt::print("{}\n", line);
  }
  std::fflush(stdout);
}

void ProgressDisplay::finish() {
  if (line_open_) fmt::print("\n");
  line_open_ = false;
  std::fflush(stdout);
}

}  // namespace tuft::app

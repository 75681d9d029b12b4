#include "rigs/processor_time.h"

#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <fstream>

namespace tuft::rigs {
namespace {

double seconds_of(clockid_t clock) {
  timespec time{};
  return clock_gettime(clock, &time) == 0
             ? static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec)
             : 0;
}

/// Of a process and of those below it: grains on several ranks are children of mpirun.
double seconds_of_tree(int process) {
  clockid_t clock{};
  if (clock_getcpuclockid(process, &clock) != 0) return 0;
  double seconds = seconds_of(clock);
  std::error_code gone;
  for (const auto& thread :
       std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process), gone)) {
    std::ifstream children(thread.path() / "children");
    for (int child = 0; children >> child;) seconds += seconds_of_tree(child);
  }
  return seconds;
}

}  // namespace

double processor_seconds(int other) {
  return seconds_of(CLOCK_PROCESS_CPUTIME_ID) + (other > 0 ? seconds_of_tree(other) : 0);
}

}  // namespace tuft::rigs

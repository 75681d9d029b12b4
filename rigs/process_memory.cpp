#include "rigs/process_memory.h"

#include <fmt/format.h>

#include <fstream>
#include <string>

namespace tuft::rigs {
namespace {

std::uint64_t peak_of(const std::string& process) {
  std::ifstream status("/proc/" + process + "/status");
  std::string line;
  while (std::getline(status, line))
    if (line.starts_with("VmHWM:")) return 1024 * std::stoull(line.substr(6));
  return 0;
}

}  // namespace

std::uint64_t peak_memory_bytes(int other) {
  return peak_of("self") + (other > 0 ? peak_of(fmt::format("{}", other)) : 0);
}

std::uint64_t available_memory_bytes() {
  std::ifstream memory("/proc/meminfo");
  std::string line;
  while (std::getline(memory, line))
    if (line.starts_with("MemAvailable:")) return 1024 * std::stoull(line.substr(13));
  return 0;
}

}  // namespace tuft::rigs

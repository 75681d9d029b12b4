#pragma once
#include <fstream>
#include <string>

namespace tuft {

/// Of this process, bytes; 0 where the kernel does not say.
inline double resident_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmRSS:") {
      double kibibytes = 0;
      status >> kibibytes;
      return 1024 * kibibytes;
    }
  return 0;
}

}  // namespace tuft

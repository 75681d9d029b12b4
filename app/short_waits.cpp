#include "app/short_waits.h"

#include <unistd.h>

#include <cstdlib>

namespace tuft::app {

void shorten_waits(char** arguments) {
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  if (setenv("GOMP_SPINCOUNT", "1000", 0) != 0) return;
  (void)execv("/proc/self/exe", arguments);
}

}  // namespace tuft::app

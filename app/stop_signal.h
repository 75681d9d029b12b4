#pragma once
/// Ctrl-C: the first asks the run to write a checkpoint and stop, the second ends the program at once.
#include <atomic>

namespace tuft::app {

/// From now on SIGINT and SIGTERM set the flag that is returned. A second signal has its default effect.
[[nodiscard]] const std::atomic<bool>& catch_stop_signals();

}  // namespace tuft::app

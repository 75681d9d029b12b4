#pragma once
/// Processor time: what work takes, whatever else the machine does meanwhile.
namespace tuft::rigs {

/// Of this program on all its threads so far, s, and, when `other` > 0, of that process and of all that it
/// has started and that still run. Processes that are gone count 0.
[[nodiscard]] double processor_seconds(int other);

}  // namespace tuft::rigs

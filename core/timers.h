#pragma once
/// Wall time by phase. A phase is an enum value, so that a measurement is two clock reads and an addition.
#include <array>
#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>

namespace tuft {

enum class Phase {
  setup,
  packing,
  search,
  contact,
  carpet,
  infill,
  exchange,
  waiting,
  rig,
  ledger,
  record,
  checkpoint,
  conditioning,
  count
};

inline constexpr std::array<std::string_view, static_cast<std::size_t>(Phase::count)> phase_names{
    "setup",   "packing", "search", "contact", "carpet",     "infill",      "exchange",
    "waiting", "rig",     "ledger", "record",  "checkpoint", "conditioning"};

class PhaseTimers {
 public:
  void add(Phase phase, double seconds) {
    if (steps_of_ && is_of_a_step(phase)) phase = *steps_of_;
    seconds_[static_cast<std::size_t>(phase)] += seconds;
  }
  /// What is done every step counts as this phase from now on; empty: as itself again.
  void count_steps_as(std::optional<Phase> phase) { steps_of_ = phase; }
  [[nodiscard]] double seconds(Phase phase) const { return seconds_[static_cast<std::size_t>(phase)]; }

 private:
  static constexpr bool is_of_a_step(Phase phase) { return phase >= Phase::search && phase <= Phase::ledger; }
  std::array<double, static_cast<std::size_t>(Phase::count)> seconds_{};
  std::optional<Phase> steps_of_;
};

/// Adds the time of its life to a phase.
class ScopedPhase {
 public:
  ScopedPhase(PhaseTimers& timers, Phase phase) : timers_(timers), phase_(phase) {}
  ~ScopedPhase() {
    timers_.add(phase_, std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }
  ScopedPhase(const ScopedPhase&) = delete;
  ScopedPhase& operator=(const ScopedPhase&) = delete;

 private:
  PhaseTimers& timers_;
  Phase phase_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace tuft

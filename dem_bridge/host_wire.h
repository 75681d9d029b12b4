#pragma once
/// How requests, answers, files and bulk come to a host and back. HostLink speaks through one of these and
/// knows no other difference between hosts.
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene.h"
#include "dem_bridge/shared_memory.h"

namespace tuft::dem {

class HostWire {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Outcome {
    answered,  ///< by all ranks, or one has answered that it failed
    gone,      ///< the host has ended or cannot be reached any more
    silent     ///< not all have answered before the deadline
  };

  HostWire() = default;
  HostWire(const HostWire&) = delete;
  HostWire& operator=(const HostWire&) = delete;
  virtual ~HostWire() = default;

  /// Sends a request with what it needs of the memory, and waits without spinning for the answers, one a
  /// rank, and what they fill in of the memory. May throw RunError when the connection itself fails.
  virtual Outcome exchange(std::string_view message, Clock::time_point deadline,
                           std::vector<std::string>& answers) = 0;
  /// Sends without waiting for an answer, and gives the host a moment to end.
  virtual void quit(std::string_view message) = 0;
  /// After Outcome::gone: "ended with signal 9 (Killed)", and what is known of what LIGGGHTS, the system or
  /// MPI said last of it (may be empty), a line each.
  [[nodiscard]] virtual std::string how_it_went() = 0;
  [[nodiscard]] virtual std::string last_words() = 0;
  /// After Outcome::silent: "and was ended; it hangs, or ..."
  [[nodiscard]] virtual std::string why_silent() const = 0;
  virtual void kill() = 0;

  /// Files in the folder that LIGGGHTS' commands know. Throws RunError.
  virtual void write_file(const std::string& name, const std::vector<std::uint8_t>& bytes) = 0;
  /// Reads and removes.
  [[nodiscard]] virtual std::vector<std::uint8_t> take_file(const std::string& name) = 0;

  [[nodiscard]] virtual SharedMemory& memory() = 0;
  [[nodiscard]] virtual int process_id() const = 0;  ///< of the local process to watch or kill; 0: none
};

/// A host on this machine: a process (or several ranks under mpirun) that shares the memory. Throws
/// InputError when it is missing, RunError when it does not start or connect before the deadline.
[[nodiscard]] std::unique_ptr<HostWire> start_local_host(const DemOptions& options, std::size_t grains,
                                                         HostWire::Clock::time_point deadline);

/// A host that listens at options.host, "tcp://machine:port" (`liggghts_host --listen`), with a memory of its
/// own: what is shared here travels there. Its ranks are all on its machine. Nothing is encrypted, and nobody
/// asked who they are. Throws InputError for a bad address.
[[nodiscard]] std::unique_ptr<HostWire> reach_remote_host(const DemOptions& options, std::size_t grains);

/// After Outcome::gone: "liggghts_host ended with signal 9 (Killed); its last words: ...", without the latter
/// where there are none.
[[nodiscard]] std::string tell_end(HostWire& wire);

/// The answers of all ranks as one: their texts one after the other, or why the first that failed did.
[[nodiscard]] std::string join_answers(const std::vector<std::string>& answers);

}  // namespace tuft::dem

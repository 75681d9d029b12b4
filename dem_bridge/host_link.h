#pragma once
/// The driver's end: one host and its memory. Asks, waits, and turns every way in which a host can fail into
/// one RunError.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene.h"
#include "dem_bridge/host_wire.h"
#include "dem_bridge/protocol.h"
#include "dem_bridge/shared_memory.h"

namespace tuft::dem {

class HostLink {
 public:
  /// Starts a host, or reaches one, and waits for its hello. Throws InputError: missing, not executable, no
  /// address; RunError: not starting, another protocol.
  HostLink(const DemOptions& options, std::size_t grains);
  ~HostLink();
  HostLink(const HostLink&) = delete;
  HostLink& operator=(const HostLink&) = delete;

  /// Sends a request and waits for the answers; returns their texts one after the other, by rank. Throws
  /// RunError starting with `doing` when the host reports a failure, dies (with its last words) or stays
  /// silent for longer than the timeout (it is then killed). After a failure every further request throws
  /// the same error.
  std::string ask(Request request, std::string_view text, std::string_view doing);

  /// Files in the folder in which LIGGGHTS' commands find them. Throw RunError.
  void write_file(const std::string& name, const std::vector<std::uint8_t>& bytes) {
    wire_->write_file(name, bytes);
  }
  /// Reads and removes.
  [[nodiscard]] std::vector<std::uint8_t> take_file(const std::string& name) {
    return wire_->take_file(name);
  }
  [[nodiscard]] SharedMemory& memory() { return wire_->memory(); }
  [[nodiscard]] int process_id() const { return wire_->process_id(); }

 private:
  [[noreturn]] void fail(std::string message);

  double timeout_;
  std::unique_ptr<HostWire> wire_;
  std::string failure_;
};

}  // namespace tuft::dem

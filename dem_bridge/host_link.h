#pragma once
/// The driver's end of the wire: one host process, its shared memory and its socket. Asks, waits, and turns
/// every way in which a host can fail into one RunError.
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "dem_bridge/protocol.h"
#include "dem_bridge/scratch_folder.h"
#include "dem_bridge/shared_memory.h"

namespace tuft::dem {

class HostLink {
 public:
  /// Starts a host and waits for its hello. Throws RunError: missing, not starting, another protocol.
  HostLink(const std::string& host, std::size_t grains, double answer_timeout);
  ~HostLink();
  HostLink(const HostLink&) = delete;
  HostLink& operator=(const HostLink&) = delete;

  /// Sends a request and waits for the answer without spinning; returns its text. Throws RunError starting
  /// with `doing` when the host reports a failure, dies (with its last words) or stays silent for longer than
  /// the timeout (it is then killed). After a failure every further request throws the same error.
  std::string ask(Request request, std::string_view text, std::string_view doing);

  [[nodiscard]] SharedMemory& memory() { return memory_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_.path(); }
  [[nodiscard]] int process_id() const;

 private:
  struct Wire;
  [[noreturn]] void fail(std::string message);
  [[nodiscard]] std::string last_words() const;

  ScratchFolder folder_;
  SharedMemory memory_;
  std::unique_ptr<Wire> wire_;
  double timeout_;
  std::string failure_;
};

}  // namespace tuft::dem

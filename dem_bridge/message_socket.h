#pragma once
/// Whole messages over a local stream socket, and file descriptors handed over on it.
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace tuft::dem {

/// One end of a connection. A message is its length (8 bytes) and its bytes. Nothing here throws for a peer
/// that has gone: `closed` says so.
class MessageSocket {
 public:
  using Clock = std::chrono::steady_clock;

  /// Owns the descriptor of a connected stream socket.
  explicit MessageSocket(int descriptor);
  ~MessageSocket();
  MessageSocket(MessageSocket&& other) noexcept;
  MessageSocket& operator=(MessageSocket&& other) noexcept;
  MessageSocket(const MessageSocket&) = delete;

  /// False when the peer has gone or has not taken the message before the deadline.
  bool send(std::string_view message, Clock::time_point deadline = Clock::time_point::max());
  /// A message if a whole one is there; never waits.
  [[nodiscard]] std::optional<std::string> receive();
  /// The peer has gone, and all it has sent has been received.
  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] int descriptor() const { return descriptor_; }

  /// Hands over a copy of `descriptor`; false when the peer has gone.
  bool send_descriptor(int descriptor);
  /// Waits for one; -1 when the peer has gone.
  [[nodiscard]] int receive_descriptor();

 private:
  int descriptor_ = -1;
  bool closed_ = false;
  std::string arrived_;
};

/// A path at which local programs connect.
class SocketListener {
 public:
  /// Throws RunError naming the path.
  explicit SocketListener(const std::filesystem::path& path);
  ~SocketListener();
  SocketListener(const SocketListener&) = delete;
  SocketListener& operator=(const SocketListener&) = delete;

  [[nodiscard]] int descriptor() const { return descriptor_; }  ///< readable when someone has come
  /// Throws RunError when nobody has.
  [[nodiscard]] MessageSocket accept();

 private:
  int descriptor_ = -1;
};

/// Connects to a listener's path. Throws std::runtime_error.
[[nodiscard]] MessageSocket connect_to(const std::filesystem::path& path);

}  // namespace tuft::dem

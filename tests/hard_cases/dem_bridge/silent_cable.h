#pragma once
/// A cable between a driver and a host, both on this machine, that can be pulled out.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace tuft::dem::test {

/// Passes bytes on between whoever connects to `port()` and a port of this machine. After `pull`, nothing any
/// more, and nobody is told: all connections stay open, and those that are made are never answered.
class SilentCable {
 public:
  explicit SilentCable(int to_port) : to_port_(to_port), listener_(stream_socket()) {
    sockaddr_in address = loopback(0);
    socklen_t size = sizeof address;
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(listener_, 8) != 0 ||
        ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("no port for a cable");
    port_ = ntohs(address.sin_port);
    carrier_ = std::thread([this] { carry(); });
  }
  ~SilentCable() {
    over_ = true;
    carrier_.join();
    for (const auto& [one, other] : lines_) ::close(one), ::close(other);
    ::close(listener_);
  }
  SilentCable(const SilentCable&) = delete;
  SilentCable& operator=(const SilentCable&) = delete;

  [[nodiscard]] int port() const { return port_; }
  void pull() { pulled_ = true; }
  /// Connections that it has passed on.
  [[nodiscard]] int connections() const { return connections_; }

 private:
  static int stream_socket() { return ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0); }
  static sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    return address;
  }

  void carry() {
    constexpr int look = 20;  // ms
    while (!over_) {
      std::vector<pollfd> watched{{listener_, POLLIN, 0}};
      for (const auto& [one, other] : lines_) {
        watched.push_back({one, POLLIN, 0});
        watched.push_back({other, POLLIN, 0});
      }
      if (pulled_) watched.clear();
      ::poll(watched.data(), watched.size(), look);
      if (pulled_) continue;
      std::vector<std::pair<int, int>> open;
      for (std::size_t k = 0; k < lines_.size(); ++k) {
        const auto [one, other] = lines_[k];
        if (pass(one, other, watched[1 + 2 * k].revents) && pass(other, one, watched[2 + 2 * k].revents)) {
          open.push_back(lines_[k]);
        } else {  // one end has hung up: so does the other
          ::close(one);
          ::close(other);
        }
      }
      lines_ = std::move(open);
      if (watched[0].revents != 0) connect();
    }
  }
  void connect() {
    const int one = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC), other = stream_socket();
    const sockaddr_in address = loopback(to_port_);
    if (::connect(other, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      ::close(one);
      ::close(other);
      return;
    }
    lines_.emplace_back(one, other);
    ++connections_;
  }
  static bool pass(int from, int to, short what) {
    if (what == 0) return true;
    std::array<char, 65536> bytes;
    const ssize_t count = ::recv(from, bytes.data(), bytes.size(), 0);
    for (ssize_t sent = 0; sent < count;) {
      const ssize_t more =
          ::send(to, bytes.data() + sent, static_cast<std::size_t>(count - sent), MSG_NOSIGNAL);
      if (more <= 0) return false;
      sent += more;
    }
    return count > 0;
  }

  int to_port_, listener_, port_ = 0;
  std::atomic<bool> over_{false}, pulled_{false};
  std::atomic<int> connections_{0};
  std::vector<std::pair<int, int>> lines_;
  std::thread carrier_;
};

}  // namespace tuft::dem::test

#include "dem_bridge/message_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/error.h"

namespace tuft::dem {
namespace {

int milliseconds_until(MessageSocket::Clock::time_point deadline) {
  if (deadline == MessageSocket::Clock::time_point::max()) return -1;
  const auto left =
      std::chrono::duration_cast<std::chrono::milliseconds>(deadline - MessageSocket::Clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000'000));
}

sockaddr_un address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.string().size() >= sizeof address.sun_path)
    throw std::runtime_error(
        fmt::format("the path {} is too long for a socket; set TMPDIR to a shorter one", path.string()));
  std::strcpy(address.sun_path, path.c_str());
  return address;
}

/// A message that carries one descriptor.
struct DescriptorMessage {
  char byte = 0;
  iovec data{&byte, 1};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))]{};
  msghdr header{};
  DescriptorMessage() {
    header.msg_iov = &data;
    header.msg_iovlen = 1;
    header.msg_control = control;
    header.msg_controllen = sizeof control;
  }
  DescriptorMessage(const DescriptorMessage&) = delete;
  DescriptorMessage& operator=(const DescriptorMessage&) = delete;
};

}  // namespace

MessageSocket::MessageSocket(int descriptor) : descriptor_(descriptor) {}

MessageSocket::MessageSocket(MessageSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      closed_(other.closed_),
      arrived_(std::move(other.arrived_)) {}

MessageSocket& MessageSocket::operator=(MessageSocket&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(closed_, other.closed_);
  std::swap(arrived_, other.arrived_);
  return *this;
}

MessageSocket::~MessageSocket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool MessageSocket::send(std::string_view message, Clock::time_point deadline) {
  std::string bytes(sizeof(std::uint64_t), '\0');
  const std::uint64_t length = message.size();
  std::memcpy(bytes.data(), &length, sizeof length);
  bytes += message;
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count =
        ::send(descriptor_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return false;
    pollfd watched{descriptor_, POLLOUT, 0};
    if (::poll(&watched, 1, milliseconds_until(deadline)) == 0) return false;
  }
  return true;
}

std::optional<std::string> MessageSocket::receive() {
  std::uint64_t length = 0;
  while (true) {
    if (arrived_.size() >= sizeof length) {
      std::memcpy(&length, arrived_.data(), sizeof length);
      if (arrived_.size() - sizeof length >= length) {
        std::string message = arrived_.substr(sizeof length, length);
        arrived_.erase(0, sizeof length + length);
        return message;
      }
    }
    // Small messages in one call; large ones grow the buffer once to what they need.
    const std::size_t before = arrived_.size(), wanted = std::max<std::size_t>(4096, length + 8 - before);
    arrived_.resize(before + wanted);
    const ssize_t count = ::recv(descriptor_, arrived_.data() + before, wanted, MSG_DONTWAIT);
    arrived_.resize(before + static_cast<std::size_t>(std::max<ssize_t>(0, count)));
    if (count > 0 || (count < 0 && errno == EINTR)) continue;
    closed_ = closed_ || count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK);
    return {};
  }
}

bool MessageSocket::send_descriptor(int descriptor) {
  DescriptorMessage message;
  cmsghdr* const part = CMSG_FIRSTHDR(&message.header);
  part->cmsg_level = SOL_SOCKET;
  part->cmsg_type = SCM_RIGHTS;
  part->cmsg_len = CMSG_LEN(sizeof(int));
  std::memcpy(CMSG_DATA(part), &descriptor, sizeof descriptor);
  return ::sendmsg(descriptor_, &message.header, MSG_NOSIGNAL) == 1;
}

int MessageSocket::receive_descriptor() {
  DescriptorMessage message;
  ssize_t count = 0;
  do count = ::recvmsg(descriptor_, &message.header, MSG_CMSG_CLOEXEC);
  while (count < 0 && errno == EINTR);
  const cmsghdr* const part = CMSG_FIRSTHDR(&message.header);
  if (count != 1 || part == nullptr || part->cmsg_type != SCM_RIGHTS) return -1;
  int descriptor = -1;
  std::memcpy(&descriptor, CMSG_DATA(part), sizeof descriptor);
  return descriptor;
}

SocketListener::SocketListener(const std::filesystem::path& path)
    : descriptor_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const sockaddr_un address = address_of(path);
  if (descriptor_ < 0 ||
      ::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(descriptor_, SOMAXCONN) != 0) {
    const int reason = errno;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw_run_error("no socket can be made at {}: {}; set TMPDIR to a folder on a local disk with room",
                    path.string(), std::strerror(reason));
  }
}

SocketListener::~SocketListener() {
  ::close(descriptor_);
}

MessageSocket SocketListener::accept() {
  const int connected = ::accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC);
  if (connected < 0)
    throw_run_error(
        "a connection of liggghts_host cannot be accepted: {}; raise the limit of open files (ulimit -n)",
        std::strerror(errno));
  return MessageSocket(connected);
}

MessageSocket connect_to(const std::filesystem::path& path) {
  const sockaddr_un address = address_of(path);
  const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0 ||
      ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int reason = errno;
    if (descriptor >= 0) ::close(descriptor);
    throw std::runtime_error(fmt::format("cannot connect to {}: {}", path.string(), std::strerror(reason)));
  }
  return MessageSocket(descriptor);
}

}  // namespace tuft::dem

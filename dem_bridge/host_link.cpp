#include "dem_bridge/host_link.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>
#include <zmq.hpp>

#include "core/error.h"
#include "dem_bridge/host_process.h"

namespace tuft::dem {

struct HostLink::Wire {
  zmq::context_t context{1};
  zmq::socket_t socket{context, zmq::socket_type::pair};
  std::optional<HostProcess> process;
};

namespace {

using Clock = std::chrono::steady_clock;

enum class Woken { ready, death, silence };

/// Blocks until the socket can be read (ZMQ_POLLIN) or written (ZMQ_POLLOUT: the host has connected), the
/// host dies, or the deadline passes. An answer that is there goes before a death: what a host said before it
/// ended is heard.
Woken wait_for_host(zmq::socket_t& socket, short event, int process, Clock::time_point deadline) {
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return Woken::silence;
    zmq_pollitem_t watched[] = {{socket.handle(), 0, event, 0}, {nullptr, process, ZMQ_POLLIN, 0}};
    // zmq_poll returns EINTR on signals (Ctrl-C is the driver's business, after this window).
    if (zmq_poll(watched, 2, static_cast<long>(left)) < 0 && zmq_errno() != EINTR) return Woken::death;
    if ((watched[0].revents & event) != 0) return Woken::ready;
    if ((watched[1].revents & ZMQ_POLLIN) != 0) return Woken::death;
  }
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  return text.substr(0, 400);
}

/// First line with ERROR in it; empty if there is none.
std::string error_line(const std::string& text) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (line.find("ERROR") != std::string::npos) return one_line(line);
  return {};
}

/// Last line that is not blank or ruled.
std::string last_line(const std::string& text) {
  std::istringstream stream(text);
  std::string last;
  for (std::string line; std::getline(stream, line);)
    if (line.find_first_not_of(" \t\r-=*") != std::string::npos) last = line;
  return one_line(last);
}

std::string tail_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) return {};
  const auto size = static_cast<std::streamoff>(stream.tellg());
  stream.seekg(std::max<std::streamoff>(0, size - 4096));
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

HostLink::HostLink(const std::string& host, std::size_t grains, double answer_timeout)
    : memory_(SharedMemory::create(grains)), wire_(std::make_unique<Wire>()), timeout_(answer_timeout) {
  const std::filesystem::path program = find_host(host);
  const std::string endpoint = "ipc://" + (folder() / "control").string();
  wire_->socket.set(zmq::sockopt::linger, 0);
  wire_->socket.bind(endpoint);
  wire_->process.emplace(program, std::vector<std::string>{endpoint, std::to_string(::getpid())},
                         memory_.descriptor(), folder() / "host.log", folder());
  ask(Request::hello, {}, "starting liggghts_host");
}

HostLink::~HostLink() {
  if (failure_.empty()) {
    const char quit = static_cast<char>(Request::quit);
    try {
      wire_->socket.send(zmq::buffer(&quit, 1), zmq::send_flags::dontwait);
      wire_->process->wait(2.0);
    } catch (const zmq::error_t&) {  // then it is killed
    }
  }
}

int HostLink::process_id() const {
  return wire_->process->id();
}

/// LIGGGHTS' own error if it named one; else what the system, the linker or MPI said.
std::string HostLink::last_words() const {
  const std::string logged = tail_of(folder() / "host.log");
  for (const std::string& words : {error_line(memory_.words()), error_line(logged), last_line(logged)})
    if (!words.empty()) return words;
  return {};
}

void HostLink::fail(std::string message) {
  failure_ = std::move(message);
  throw RunError(failure_);
}

std::string HostLink::ask(Request request, std::string_view text, std::string_view doing) {
  if (!failure_.empty()) throw RunError(failure_);
  std::string message(1, static_cast<char>(request));
  message += text;
  HostProcess& process = *wire_->process;
  Woken woken = Woken::death;
  std::string answer;
  try {
    const auto deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_));
    woken = wait_for_host(wire_->socket, ZMQ_POLLOUT, process.descriptor(), deadline);
    if (woken == Woken::ready) {
      wire_->socket.send(zmq::buffer(message), zmq::send_flags::dontwait);
      woken = wait_for_host(wire_->socket, ZMQ_POLLIN, process.descriptor(), deadline);
    }
    if (woken == Woken::ready) {
      zmq::message_t received;
      if (wire_->socket.recv(received, zmq::recv_flags::dontwait)) answer = received.to_string();
    }
  } catch (const zmq::error_t& error) {
    process.kill();
    fail(fmt::format("{}: the connection to liggghts_host failed: {}", doing, error.what()));
  }
  if (woken == Woken::silence) {
    process.kill();
    fail(fmt::format(
        "{}: liggghts_host did not answer for {} s and was ended; it hangs, or the window is too long for "
        "the timeout",
        doing, timeout_));
  }
  if (woken == Woken::death) {
    process.wait(1.0);
    const std::string words = last_words();
    const std::string ending =
        process.ending().empty() ? "no longer answers" : "ended with " + process.ending();
    process.kill();
    fail(fmt::format("{}: liggghts_host {}{}", doing, ending,
                     words.empty() ? "" : "; its last words: " + words));
  }
  if (answer.empty() || answer[0] != static_cast<char>(Answer::done))
    fail(fmt::format("{}: {}", doing,
                     answer.size() > 1 ? answer.substr(1) : "liggghts_host gave an unknown answer"));
  answer.erase(0, 1);
  return answer;
}

}  // namespace tuft::dem

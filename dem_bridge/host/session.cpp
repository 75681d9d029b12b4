#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

#include "core/scene.h"
#include "dem_bridge/host/listen.h"
#include "dem_bridge/host/own_liggghts.h"
#include "dem_bridge/host_wire.h"
#include "dem_bridge/wire_blocks.h"
#include "dem_bridge/zmq_link.h"

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;

/// The driver alone says how long it waits; then it hangs up, and that ends this process.
constexpr auto no_deadline = HostWire::Clock::time_point::max();

/// One life of LIGGGHTS for one driver: what comes over the network goes into the memory of a host on this
/// machine, and what that answers and fills in goes back.
class Session {
 public:
  explicit Session(const std::string& endpoint) {
    prepare_link(socket_);
    end_with_driver();
    bind(endpoint);
  }
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[noreturn]] void serve() {
    while (true) {
      zmq_pollitem_t watched[] = {{socket_.handle(), 0, ZMQ_POLLIN, 0}};
      zmq_poll(watched, 1, -1);
      std::vector<zmq::message_t> frames = take_frames(socket_);
      if (frames.empty() || frames[0].size() == 0) continue;
      const std::string message = frames[0].to_string();
      if (message[0] == static_cast<char>(Request::quit)) {
        if (host_) host_->quit(message);
        host_.reset();
        ::_exit(EXIT_SUCCESS);
      }
      send_frames(socket_, answer(message, frames));
      if (!host_gone_) continue;
      hang_up();
      host_.reset();
      ::_exit(EXIT_FAILURE);
    }
  }

  void say_last_words() {
    if (!host_) return;
    const std::string words = host_->last_words();
    if (words.empty()) return;
    send_frames(socket_, {static_cast<char>(Answer::failed) + tell_end(*host_)});
    hang_up();
  }

 private:
  std::vector<std::string> answer(const std::string& message, const std::vector<zmq::message_t>& frames) {
    try {
      const auto request = static_cast<Request>(message[0]);
      if (request == Request::hello) begin(frames);
      if (!host_) throw std::runtime_error("a request before the hello");
      const auto file = static_cast<FileRequest>(message[0]);
      if (file == FileRequest::write) return {write_file(message.substr(1))};
      if (file == FileRequest::take) return {take_file(message.substr(1))};
      for (std::size_t f = 1; f < frames.size(); ++f) unpack(memory(), frames[f].to_string_view());
      return ask(request, message);
    } catch (const std::exception& error) {
      return {static_cast<char>(Answer::failed) + std::string(error.what())};
    }
  }

  std::vector<std::string> ask(Request request, const std::string& message) {
    std::vector<std::string> answers;
    if (host_->exchange(message, no_deadline, answers) == HostWire::Outcome::gone) {
      host_gone_ = true;
      const std::string end = tell_end(*host_);
      std::cerr << end << '\n';
      return {static_cast<char>(Answer::failed) + end};
    }
    std::vector<std::string> result{join_answers(answers)};
    bool some_expelled = false;
    for (std::size_t r = 0; r < memory().ranks(); ++r) some_expelled |= memory().rank(r).expelled > 0;
    for (const Block block : blocks_to_driver(request, some_expelled))
      result.push_back(pack(memory(), block));
    // The driver has what was seen so far, and sets it back in a memory of its own.
    for (std::size_t r = 0; r < memory().ranks(); ++r) memory().rank(r).overlap_largest.fill(0.0);
    return result;
  }

  void begin(const std::vector<zmq::message_t>& frames) {
    SharedState wanted;
    if (host_ || frames.size() != 2 || frames[1].size() != sizeof(Block) + sizeof wanted)
      throw std::runtime_error("host and program are of different builds");
    std::memcpy(&wanted, frames[1].data<char>() + sizeof(Block), sizeof wanted);
    if (wanted.magic != protocol_magic || wanted.version != protocol_version)
      throw std::runtime_error(
          fmt::format("protocol version {} expected, {} found: host and program are of different builds",
                      protocol_version, wanted.version));
    const std::ofstream mark(served);
    if (wanted.ranks == 1) {
      host_ = start_own_liggghts(wanted.grains);
      return;
    }
    DemOptions options;
    options.host = fs::read_symlink("/proc/self/exe").string();
    options.ranks = static_cast<int>(wanted.ranks);
    host_ = start_local_host(options, wanted.grains, no_deadline);
  }

  [[nodiscard]] SharedMemory& memory() { return host_->memory(); }

  static std::string plain_name(const std::string& name) {
    if (name.empty() || name.find('/') != std::string::npos || name[0] == '.')
      throw std::runtime_error("a file's name must be plain");
    return name;
  }
  std::string write_file(const std::string& text) {
    const std::size_t end = text.find('\n');
    const std::string name = plain_name(text.substr(0, end));
    host_->write_file(name, {text.begin() + static_cast<std::ptrdiff_t>(end) + 1, text.end()});
    return std::string(1, static_cast<char>(Answer::done));
  }
  std::string take_file(const std::string& name) {
    const std::vector<std::uint8_t> bytes = host_->take_file(plain_name(name));
    std::string answer(1, static_cast<char>(Answer::done));
    answer.append(bytes.begin(), bytes.end());
    return answer;
  }

  /// The host of the life before may still be letting go of the port.
  void bind(const std::string& endpoint) {
    for (int attempt = 0;; ++attempt) try {
        socket_.bind(endpoint);
        return;
      } catch (const zmq::error_t& error) {
        if (error.num() != EADDRINUSE || attempt == 50)
          throw std::runtime_error(fmt::format("cannot listen at {}: {}", endpoint, error.what()));
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      }
  }

  /// A connection that is gone ends this process, whatever LIGGGHTS is at; its ranks end with it. Only the
  /// first is looked at: a second driver is not served.
  void end_with_driver() {
    auto monitor = std::make_shared<zmq::socket_t>(context_, zmq::socket_type::pair);
    monitor->connect(monitor_endpoint);
    std::thread([monitor] {
      std::optional<int> driver;
      while (true) try {
          zmq_pollitem_t watched[] = {{monitor->handle(), 0, ZMQ_POLLIN, 0}};
          if (zmq_poll(watched, 1, -1) < 0) {
            if (zmq_errno() == EINTR) continue;
            return;
          }
          const LinkEvent event = take_event(*monitor);
          if (event.kind == ZMQ_EVENT_ACCEPTED && !driver) driver = event.descriptor;
          if (event.kind == ZMQ_EVENT_DISCONNECTED && driver == event.descriptor) {
            std::cerr << "the driver has gone\n";
            ::_exit(EXIT_SUCCESS);
          }
        } catch (const zmq::error_t& error) {
          if (error.num() == ETERM) return;  // the context is being closed: last words are under way
          std::cerr << "the watch on the driver failed: " << error.what() << '\n';
          ::_exit(EXIT_FAILURE);
        }
    }).detach();
  }

  /// Returns when all is said, after `linger` at the latest.
  void hang_up() {
    socket_.close();
    context_.close();
  }

  zmq::context_t context_{1};
  zmq::socket_t socket_{context_, zmq::socket_type::pair};
  std::unique_ptr<HostWire> host_;
  bool host_gone_ = false;
};

Session* current = nullptr;

}  // namespace

/// LIGGGHTS ends its process on an error: what it said last goes to the driver.
void say_last_words() {
  if (current != nullptr) current->say_last_words();
}

int serve_one_driver(const std::string& endpoint) {
  if (!std::ofstream{alive}) throw std::runtime_error("no file can be made in its folder");
  std::thread([] {
    while (true) {
      std::error_code ignored;
      fs::last_write_time(alive, fs::file_time_type::clock::now(), ignored);
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
  }).detach();
  // Never destroyed: LIGGGHTS cannot be taken apart in the middle of an error.
  current = new Session(endpoint);
  std::atexit(say_last_words);
  current->serve();
}

}  // namespace tuft::dem

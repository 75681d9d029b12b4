#include "dem_bridge/host/listen.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "dem_bridge/host/liggghts_engine.h"
#include "dem_bridge/host/serve.h"
#include "dem_bridge/host_process.h"
#include "dem_bridge/last_words.h"
#include "dem_bridge/scratch_folder.h"
#include "dem_bridge/wire_blocks.h"
#include "dem_bridge/zmq_link.h"

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;
constexpr const char* served = "served";  // a file that a host makes in its folder when a driver has come
constexpr const char* alive = "alive";    // one whose time it renews as long as it runs

/// One life of LIGGGHTS for one driver.
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
      if (message[0] == static_cast<char>(Request::quit)) ::_exit(EXIT_SUCCESS);
      send_frames(socket_, answer(message, frames));
    }
  }

  /// LIGGGHTS ends its process on an error: what it said last goes to the driver.
  void say_last_words() {
    if (!memory_) return;
    std::string words = memory_->words();
    const std::size_t error = words.find("ERROR");
    if (error == std::string::npos) return;
    words = words.substr(error, words.find('\n', error) - error);
    send_frames(socket_, {static_cast<char>(Answer::failed) +
                          ("liggghts_host ended; its last words: " + words.substr(0, 400))});
    socket_.close();
    context_.close();  // returns when the words are gone, after `linger` at the latest
  }

 private:
  std::vector<std::string> answer(const std::string& message, const std::vector<zmq::message_t>& frames) {
    try {
      const auto file = static_cast<FileRequest>(message[0]);
      if (file == FileRequest::write) return {write_file(message.substr(1))};
      if (file == FileRequest::take) return {take_file(message.substr(1))};
      const auto request = static_cast<Request>(message[0]);
      if (request == Request::hello) begin(frames);
      if (!engine_) throw std::runtime_error("a request before the hello");
      for (std::size_t f = 1; f < frames.size(); ++f) unpack(*memory_, frames[f].to_string_view());
      std::vector<std::string> result{answer_to(*engine_, message)};
      for (const Block block : blocks_to_driver(request, memory_->rank(0).expelled > 0))
        result.push_back(pack(*memory_, block));
      return result;
    } catch (const std::exception& error) {
      return {static_cast<char>(Answer::failed) + std::string(error.what())};
    }
  }

  void begin(const std::vector<zmq::message_t>& frames) {
    SharedState wanted;
    if (engine_ || frames.size() != 2 || frames[1].size() != sizeof(Block) + sizeof wanted)
      throw std::runtime_error("host and program are of different builds");
    std::memcpy(&wanted, frames[1].data<char>() + sizeof(Block), sizeof wanted);
    if (wanted.magic != protocol_magic || wanted.version != protocol_version)
      throw std::runtime_error(
          fmt::format("protocol version {} expected, {} found: host and program are of different builds",
                      protocol_version, wanted.version));
    std::ofstream{served};
    memory_.emplace(SharedMemory::create(wanted.grains));
    engine_ = std::make_unique<LiggghtsEngine>(*memory_, 0);
  }

  static fs::path plain_name(const std::string& name) {
    if (name.empty() || name.find('/') != std::string::npos || name[0] == '.')
      throw std::runtime_error("a file's name must be plain");
    return name;
  }
  static std::string write_file(const std::string& text) {
    const std::size_t end = text.find('\n');
    const fs::path name = plain_name(text.substr(0, end));
    std::ofstream stream(name, std::ios::binary);
    stream.write(text.data() + end + 1, static_cast<std::streamsize>(text.size() - end - 1));
    stream.close();
    if (!stream) throw std::runtime_error("it cannot be written on the host's machine");
    return std::string(1, static_cast<char>(Answer::done));
  }
  static std::string take_file(const std::string& text) {
    const fs::path name = plain_name(text);
    std::ifstream stream(name, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (!stream || bytes.empty()) throw std::runtime_error("LIGGGHTS left no such file");
    fs::remove(name);
    return static_cast<char>(Answer::done) + bytes;
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

  /// A connection that is gone ends this process, whatever LIGGGHTS is at. Only the first is looked at: a
  /// second driver is not served.
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

  zmq::context_t context_{1};
  zmq::socket_t socket_{context_, zmq::socket_type::pair};
  std::optional<SharedMemory> memory_;
  std::unique_ptr<LiggghtsEngine> engine_;
};

Session* current = nullptr;

}  // namespace

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
  std::atexit([] { current->say_last_words(); });
  current->serve();
}

namespace {

/// How the life of one host went.
struct Life {
  std::string ending;
  std::string words;     ///< the last, ": " before them; may be empty
  bool in_vain = false;  ///< it failed soon after its start, before a driver had come: so may the next
};

/// Waits for the end of a host; false when it has not run for `frozen_after` (s), stopped as a whole: what
/// LIGGGHTS is at does not matter.
bool ended_by_itself(HostProcess& host, const fs::path& folder, double frozen_after) {
  // Looks are counted, not seconds: where the listener has been stopped too, or the machine slept, none is
  // missed. Before the file is there the host is only starting.
  const double pause = std::min(1.0, 0.1 * frozen_after);
  const double most = frozen_after / pause;
  int unchanged = 0;
  fs::file_time_type last{};
  while (!host.wait(pause)) {
    std::error_code none;
    const fs::file_time_type now = fs::last_write_time(folder / alive, none);
    unchanged = none || now != last ? 0 : unchanged + 1;
    last = now;
    if (unchanged > most) return false;
  }
  return true;
}

Life live(const std::string& program, const std::string& endpoint, double frozen_after) {
  constexpr std::chrono::seconds soon{10};
  const ScratchFolder folder;
  const fs::path log = folder.path() / "host.log";
  const auto start = std::chrono::steady_clock::now();
  HostProcess host({program, "--serve", endpoint, std::to_string(::getpid())}, log, folder.path());
  if (!ended_by_itself(host, folder.path(), frozen_after)) {
    host.kill();
    std::error_code ignored;
    return {host.ending(), fmt::format(": it had been frozen for {:g} s and was ended", frozen_after),
            !fs::exists(folder.path() / served, ignored)};
  }
  std::ostringstream said;
  said << std::ifstream(log).rdbuf();
  std::error_code ignored;
  return {host.ending(), (said.str().empty() ? "" : ": ") + telling_line(said.str()),
          host.ending() != "exit code 0" && std::chrono::steady_clock::now() - start < soon &&
              !fs::exists(folder.path() / served, ignored)};
}

}  // namespace

int listen_for_drivers(const std::string& endpoint, bool once, double frozen_after) {
  constexpr int tries = 5;
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  std::cout << "liggghts_host listens at " << endpoint << "; whoever can reach it can run commands as "
            << "this user, so let only trusted machines" << std::endl;
  for (int in_vain = 0;;) {
    const Life life = live(program, endpoint, frozen_after);
    std::cout << "a run's host ended with " << life.ending << life.words << std::endl;
    if (life.ending == "exit code " + std::to_string(cannot_listen)) return EXIT_FAILURE;
    if (once) return life.ending == "exit code 0" ? EXIT_SUCCESS : EXIT_FAILURE;
    in_vain = life.in_vain ? in_vain + 1 : 0;
    if (in_vain == tries)
      throw std::runtime_error(fmt::format(
          "{} hosts in a row at {} ended before a driver came, the last with {}{}; remove the cause "
          "and listen again",
          tries, endpoint, life.ending, life.words));
    if (in_vain > 0) std::this_thread::sleep_for(std::chrono::seconds(1 << (in_vain - 1)));
  }
}

}  // namespace tuft::dem

#include <algorithm>
#include <filesystem>

#include "core/error.h"
#include "dem_bridge/host_wire.h"
#include "dem_bridge/last_words.h"
#include "dem_bridge/protocol.h"
#include "dem_bridge/wire_blocks.h"
#include "dem_bridge/zmq_link.h"

namespace tuft::dem {
namespace {

using Clock = HostWire::Clock;

/// A host that listens on another machine, or on this one.
class TcpWire final : public HostWire {
 public:
  TcpWire(const DemOptions& options, std::size_t grains)
      : endpoint_(options.host),
        timeout_(options.answer_timeout),
        memory_(SharedMemory::create(grains, static_cast<std::size_t>(options.ranks))) {
    prepare_link(socket_);
    monitor_.connect(monitor_endpoint);
    try {
      socket_.connect(endpoint_);
    } catch (const zmq::error_t& error) {
      throw_input_error(
          "infill.dem.host = \"{}\" is no address: {}; give it as \"tcp://machine:port\", with the port that "
          "liggghts_host listens on",
          endpoint_, error.what());
    }
  }
  ~TcpWire() override { hang_up(); }

  Outcome exchange(std::string_view message, Clock::time_point deadline,
                   std::vector<std::string>& answers) override {
    const auto request = static_cast<Request>(message[0]);
    std::vector<std::string> frames{std::string(message)};
    for (const Block block : blocks_to_host(request, first_window_)) frames.push_back(pack(memory_, block));
    if (request == Request::commands) first_window_ = true;
    if (request == Request::advance || request == Request::resume) first_window_ = false;
    return carry(frames, deadline, answers);
  }

  void quit(std::string_view message) override {
    try {
      if (!gone_) send_frames(socket_, {std::string(message)});
      // Until it has ended: the next host at this address must not be taken for it.
      for (const auto deadline = Clock::now() + std::chrono::seconds(3); !gone_ && Clock::now() < deadline;)
        wait(deadline);
    } catch (const zmq::error_t&) {  // then there is nobody to tell
    }
  }

  std::string how_it_went() override {
    return fmt::format(
        "at {} can no longer be reached: it or its machine has ended, it serves another run, or the network "
        "is down",
        endpoint_);
  }
  std::string why_silent() const override {
    if (met_) return fmt::format("at {}; it hangs, or the window is too long for the timeout", endpoint_);
    return fmt::format("at {}: it hangs, or nobody listens there; start `liggghts_host --listen {}` there",
                       endpoint_, listening_address());
  }
  /// As of its last answer: an error if LIGGGHTS had named one by then, else nothing. What else it had
  /// printed says nothing of the end.
  std::string last_words() override {
    for (std::size_t r = 0; r < memory_.ranks(); ++r)
      if (const std::string error = error_line(memory_.words(r)); !error.empty()) return error;
    return {};
  }
  /// The host ends a life whose connection is gone.
  void kill() override { hang_up(); }

  void write_file(const std::string& name, const std::vector<std::uint8_t>& bytes) override {
    std::string message = static_cast<char>(FileRequest::write) + name + "\n";
    message.append(bytes.begin(), bytes.end());
    ask_file(message, name);
  }
  std::vector<std::uint8_t> take_file(const std::string& name) override {
    const std::string bytes = ask_file(static_cast<char>(FileRequest::take) + name, name);
    return {bytes.begin(), bytes.end()};
  }

  SharedMemory& memory() override { return memory_; }
  int process_id() const override { return 0; }

 private:
  Outcome carry(const std::vector<std::string>& frames, Clock::time_point deadline,
                std::vector<std::string>& answers) {
    try {
      if (gone_) return Outcome::gone;
      // Before anyone is there the socket keeps the message; a host that comes in time answers it.
      if (!can_send(deadline)) return gone_ ? Outcome::gone : Outcome::silent;
      send_frames(socket_, frames);
      while (true) {
        auto received = take_frames(socket_);
        if (!received.empty()) {
          for (std::size_t f = 1; f < received.size(); ++f) unpack(memory_, received[f].to_string_view());
          answers = {received[0].to_string()};
          return Outcome::answered;
        }
        if (gone_) return Outcome::gone;
        if (Clock::now() >= deadline) return Outcome::silent;
        wait(deadline);
      }
    } catch (const std::exception& error) {
      throw_run_error("the connection to liggghts_host at {} failed: {}", endpoint_, error.what());
    }
  }

  bool can_send(Clock::time_point deadline) {
    while (!gone_) {
      if ((socket_.get(zmq::sockopt::events) & ZMQ_POLLOUT) != 0) return true;
      if (Clock::now() >= deadline) return false;
      wait(deadline, ZMQ_POLLOUT);
    }
    return false;
  }

  /// For a message, or for the end of the connection.
  void wait(Clock::time_point deadline, short event = ZMQ_POLLIN) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    zmq_pollitem_t watched[] = {{socket_.handle(), 0, event, 0}, {monitor_.handle(), 0, ZMQ_POLLIN, 0}};
    zmq_poll(watched, 2, static_cast<long>(std::max<std::int64_t>(0, left)));  // EINTR: looked at again
    if ((watched[0].revents & event) != 0) return;  // what was said before the end is heard first
    for (LinkEvent link = take_event(monitor_); link.kind != 0; link = take_event(monitor_)) {
      met_ |= link.kind == ZMQ_EVENT_HANDSHAKE_SUCCEEDED;
      gone_ |= met_ && link.kind == ZMQ_EVENT_DISCONNECTED;
    }
  }

  std::string ask_file(const std::string& message, const std::string& name) {
    std::vector<std::string> answers;
    const auto deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeout_));
    switch (carry({message}, deadline, answers)) {
      case Outcome::gone:
        throw_run_error("file {} for LIGGGHTS: liggghts_host {}", name, how_it_went());
      case Outcome::silent:
        throw_run_error("file {} for LIGGGHTS: liggghts_host at {} did not answer for {} s", name, endpoint_,
                        timeout_);
      case Outcome::answered:
        break;
    }
    if (answers[0].empty() || answers[0][0] != static_cast<char>(Answer::done))
      throw_run_error("file {} for LIGGGHTS: {}", name,
                      answers[0].empty() ? "liggghts_host gave an unknown answer" : answers[0].substr(1));
    return answers[0].substr(1);
  }

  /// What to give the host: every address of its machine, the same port.
  [[nodiscard]] std::string listening_address() const {
    return "tcp://*" + endpoint_.substr(std::min(endpoint_.rfind(':'), endpoint_.size()));
  }

  void hang_up() {
    if (!socket_.handle()) return;
    socket_.set(zmq::sockopt::linger, 0);
    socket_.close();
    gone_ = true;
  }

  std::string endpoint_;
  double timeout_;
  SharedMemory memory_;
  zmq::context_t context_{1};
  zmq::socket_t monitor_{context_, zmq::socket_type::pair};
  zmq::socket_t socket_{context_, zmq::socket_type::pair};
  /// Until hands have been shaken, a connection that breaks was with a host that was just ending; ZeroMQ
  /// keeps what is to be sent and tries again.
  bool met_ = false;
  bool gone_ = false;
  bool first_window_ = false;
};

}  // namespace

std::unique_ptr<HostWire> reach_remote_host(const DemOptions& options, std::size_t grains) {
  return std::make_unique<TcpWire>(options, grains);
}

}  // namespace tuft::dem

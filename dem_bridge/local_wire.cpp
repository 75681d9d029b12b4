#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

#include "core/error.h"
#include "dem_bridge/host_process.h"
#include "dem_bridge/host_wire.h"
#include "dem_bridge/last_words.h"
#include "dem_bridge/message_socket.h"
#include "dem_bridge/protocol.h"
#include "dem_bridge/scratch_folder.h"

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;
using Clock = HostWire::Clock;

std::string tail_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) return {};
  const auto size = static_cast<std::streamoff>(stream.tellg());
  stream.seekg(std::max<std::streamoff>(0, size - 4096));
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Milliseconds to wait, rounded up; 0 when the deadline has passed.
int wait_time(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<std::int64_t>(left, 0, 1'000'000'000));
}

class LocalWire final : public HostWire {
 public:
  LocalWire(const DemOptions& options, std::size_t grains, Clock::time_point deadline)
      : memory_(SharedMemory::create(grains, ranks_of(options))),
        listener_(folder_.path() / "control"),
        process_(host_command(find_host(options.host), ranks_of(options)), folder_.path() / "host.log",
                 folder_.path(), options.ranks > 1 ? Launch::mpirun : Launch::alone) {
    connect_ranks(options, deadline);
  }

  Outcome exchange(std::string_view message, Clock::time_point deadline,
                   std::vector<std::string>& answers) override {
    answers.assign(ranks_.size(), {});
    for (MessageSocket& rank : ranks_)
      if (!rank.send(message, deadline)) return Clock::now() < deadline ? Outcome::gone : Outcome::silent;
    std::size_t missing = ranks_.size();
    while (missing > 0) {
      std::vector<pollfd> watched;
      for (std::size_t r = 0; r < ranks_.size(); ++r)
        watched.push_back({answers[r].empty() ? ranks_[r].descriptor() : -1, POLLIN, 0});
      watched.push_back({process_.descriptor(), POLLIN, 0});
      // EINTR: Ctrl-C is the driver's business, after this window.
      const int woken = ::poll(watched.data(), watched.size(), wait_time(deadline));
      if (woken < 0 && errno != EINTR) return Outcome::gone;
      if (woken == 0) return Outcome::silent;
      if (woken < 0) continue;
      // An answer that is there goes before a death: what a host said before it ended is heard.
      bool gone = watched.back().revents != 0;
      for (std::size_t r = 0; r < ranks_.size(); ++r) {
        if (watched[r].revents == 0) continue;
        if (auto answer = ranks_[r].receive()) {
          answers[r] = std::move(*answer);
          --missing;
          if (answers[r].empty() || answers[r][0] != static_cast<char>(Answer::done))
            return Outcome::answered;
        } else if (ranks_[r].closed()) {
          gone = true;
        }
      }
      if (gone && missing > 0) return Outcome::gone;
    }
    return Outcome::answered;
  }

  void quit(std::string_view message) override {
    for (MessageSocket& rank : ranks_) rank.send(message, Clock::now());
    process_.wait(2.0);
  }

  /// mpirun, when a rank has ended, gives the others a second to do so before it says what it saw.
  std::string how_it_went() override {
    process_.wait(ranks_.size() == 1 ? 1.0 : 5.0);
    return process_.ending().empty() ? "no longer answers" : "ended with " + process_.ending();
  }
  /// LIGGGHTS' own error if it named one; else what the system, the linker or MPI said, if all is over.
  std::string last_words() override {
    std::vector<std::string> texts;
    for (std::size_t r = 0; r < memory_.ranks(); ++r) texts.push_back(memory_.words(r));
    texts.push_back(tail_of(folder_.path() / "host.log"));
    for (const std::string& text : texts)
      if (const std::string error = error_line(text); !error.empty()) return error;
    return process_.ending().empty() ? "" : telling_line(texts.back());
  }
  std::string why_silent() const override {
    return "and was ended; it hangs, or the window is too long for the timeout";
  }
  void kill() override { process_.kill(); }

  void write_file(const std::string& name, const std::vector<std::uint8_t>& bytes) override {
    const fs::path file = folder_.path() / name;
    std::ofstream stream(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) throw_run_error("{} cannot be written; free space in the temporary folder", file.string());
  }
  std::vector<std::uint8_t> take_file(const std::string& name) override {
    const fs::path file = folder_.path() / name;
    std::ifstream stream(file, std::ios::binary);
    std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (!stream || bytes.empty()) throw_run_error("liggghts_host left no file {}", file.string());
    std::error_code ignored;
    fs::remove(file, ignored);
    return bytes;
  }

  SharedMemory& memory() override { return memory_; }
  int process_id() const override { return process_.id(); }

 private:
  static std::size_t ranks_of(const DemOptions& options) { return static_cast<std::size_t>(options.ranks); }

  [[nodiscard]] std::vector<std::string> host_command(const fs::path& program, std::size_t ranks) const {
    std::vector<std::string> command{program.string(), "--driver", std::to_string(::getpid()), "--socket",
                                     (folder_.path() / "control").string()};
    if (ranks == 1) return command;
    const std::vector<std::string> launcher{find_mpirun().string(), "-n",        std::to_string(ranks),
                                            "--oversubscribe",      "--bind-to", "none"};
    command.insert(command.begin(), launcher.begin(), launcher.end());
    return command;
  }

  /// Each rank says who it is and is given the memory.
  void connect_ranks(const DemOptions& options, Clock::time_point deadline) {
    std::vector<std::optional<MessageSocket>> known(memory_.ranks());
    std::vector<MessageSocket> strangers;
    for (std::size_t missing = known.size(); missing > 0;) {
      // Asked in every round, since there may be someone at the door in every one.
      if (Clock::now() >= deadline)
        throw_run_error(
            "starting liggghts_host: it did not connect within {} s and was ended; raise "
            "infill.dem.answer_timeout if the machine is busy",
            options.answer_timeout);
      std::vector<pollfd> watched{{listener_.descriptor(), POLLIN, 0}, {process_.descriptor(), POLLIN, 0}};
      for (const MessageSocket& stranger : strangers) watched.push_back({stranger.descriptor(), POLLIN, 0});
      if (::poll(watched.data(), watched.size(), wait_time(deadline)) <= 0) continue;
      if (watched[0].revents != 0) strangers.push_back(listener_.accept());
      for (auto stranger = strangers.begin(); stranger != strangers.end();) {
        if (const auto said = stranger->receive()) {
          const std::size_t rank = std::strtoul(said->c_str(), nullptr, 10);
          if (rank >= known.size() || known[rank])
            throw_run_error("starting liggghts_host: an unexpected rank {} of {}", rank, known.size());
          stranger->send_descriptor(memory_.descriptor());
          known[rank].emplace(std::move(*stranger));
          --missing;
        } else if (!stranger->closed()) {
          ++stranger;
          continue;
        }
        stranger = strangers.erase(stranger);  // one that has gone would wake us in every round
      }
      if (watched[1].revents != 0 && missing > 0)
        throw_run_error("starting liggghts_host: {}", tell_end(*this));
    }
    for (auto& rank : known) ranks_.push_back(std::move(*rank));
  }

  ScratchFolder folder_;
  SharedMemory memory_;
  SocketListener listener_;
  HostProcess process_;
  std::vector<MessageSocket> ranks_;
};

}  // namespace

std::unique_ptr<HostWire> start_local_host(const DemOptions& options, std::size_t grains,
                                           HostWire::Clock::time_point deadline) {
  return std::make_unique<LocalWire>(options, grains, deadline);
}

}  // namespace tuft::dem

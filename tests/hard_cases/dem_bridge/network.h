#pragma once
/// A host that listens at a port of this machine, and what a test does with it.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>

#include <iostream>
#include <memory>
#include <sstream>

#include "core/error.h"
#include "dem_bridge/host_process.h"
#include "dem_bridge/scratch_folder.h"
#include "tests/hard_cases/dem_bridge/traces.h"
#include "tests/verification/dem_bridge/same_run.h"

namespace tuft::dem::test {

inline int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ::bind(socket, reinterpret_cast<sockaddr*>(&address), size);
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(socket);
  return ntohs(address.sin_port);
}

class Network : public Traces {
 protected:
  void SetUp() override {
    Traces::SetUp();
    endpoint_ = "tcp://127.0.0.1:" + std::to_string(free_port());
    settings_.rolling_resistance = true;
    settings_.options.answer_timeout = 30;
  }
  void listen(const std::vector<std::string>& options = {}) {
    const std::string program = find_host("").string();
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    for (const int output : {1, 2})
      ::posix_spawn_file_actions_addopen(&actions, output, (folder() / "listener.log").c_str(),
                                         O_WRONLY | O_CREAT | O_APPEND, 0600);
    std::vector<std::string> words{program, "--listen", endpoint_};
    words.insert(words.end(), options.begin(), options.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ASSERT_EQ(::posix_spawn(&listener_, program.c_str(), &actions, nullptr, arguments.data(), ::environ), 0);
    ::posix_spawn_file_actions_destroy(&actions);
  }
  [[nodiscard]] int server() const {
    std::ifstream children("/proc/" + std::to_string(listener_) + "/task/" + std::to_string(listener_) +
                           "/children");
    int child = 0;
    children >> child;
    return child;
  }
  /// After the next run's sweep.
  [[nodiscard]] bool swept_folders_left() const {
    { const ScratchFolder next; }
    for (const auto& entry : std::filesystem::directory_iterator(folder()))
      if (entry.is_directory()) return true;
    return false;
  }
  void stop_listening() {
    if (listener_ <= 0) return;
    ::kill(listener_, SIGSTOP);  // it starts no other meanwhile
    const std::vector<int> below = descendants(listener_);
    ::kill(listener_, SIGKILL);
    ::waitpid(listener_, nullptr, 0);
    listener_ = -1;
    for (const int process : below) EXPECT_TRUE(gone_within(process, 5.0)) << "an orphan was left";
    // What was just being started may be making its folders yet: the kernel ends it when it has got that far.
    for (int k = 0; k < 500 && swept_folders_left(); ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (HasFailure()) std::cerr << std::ifstream(folder() / "listener.log").rdbuf();
    std::filesystem::remove(folder() / "listener.log");
  }
  void TearDown() override {
    stop_listening();
    Traces::TearDown();
  }
  std::unique_ptr<DemInfill> local() const {
    return std::make_unique<DemInfill>(block_.grains, block_.materials, settings_);
  }
  std::unique_ptr<DemInfill> remote() const { return remote(endpoint_); }
  std::unique_ptr<DemInfill> remote(const std::string& endpoint) const {
    DemSettings settings = settings_;
    settings.options.host = endpoint;
    return std::make_unique<DemInfill>(block_.grains, block_.materials, settings);
  }
  /// What the listener has said so far.
  [[nodiscard]] std::string said() const {
    std::ostringstream text;
    text << std::ifstream(folder() / "listener.log").rdbuf();
    return text.str();
  }
  void advance(DemInfill& infill, int windows) const {
    const double window = 2 * 0.5 * infill.stable_step();
    for (int k = 0; k < windows; ++k) infill.advance(window, 2, block_.confine(infill, window));
  }
  void expect_the_bits_of_shared_memory_and_resume() {
    listen();
    const auto shared = local();
    auto over_tcp = remote();
    for (DemInfill* infill : {shared.get(), over_tcp.get()}) {
      block_.shake(*infill, 0.5);
      advance(*infill, 80);
    }
    expect_same_bits(*shared, *over_tcp);
    EXPECT_GT(over_tcp->overlaps().contacts, 10u);
    EXPECT_EQ(over_tcp->fields()[0].values, shared->fields()[0].values);
    EXPECT_EQ(over_tcp->contacts().other, shared->contacts().other);

    const std::filesystem::path file = folder() / "checkpoint.h5";
    for (DemInfill* infill : {shared.get(), over_tcp.get()}) save_run(*infill, file);
    over_tcp.reset();  // a listening host serves one life at a time
    auto resumed = remote();
    resumed->load(h5::File::open(file).root());
    advance(*shared, 40);
    advance(*resumed, 40);
    expect_same_bits(*shared, *resumed);
    std::filesystem::remove(file);
  }

  ShakenBlock block_{5};
  DemSettings settings_ = settings_in_box(0.05, Vec3(0, 0, -9.81));
  std::string endpoint_;
  pid_t listener_ = -1;
};

}  // namespace tuft::dem::test

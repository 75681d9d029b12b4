/// A host that listens at a TCP port: the same bits as with shared memory, and a clear line when it is gone.
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
#include "tests/verification/dem_bridge/clump_scene.h"
#include "tests/verification/dem_bridge/same_run.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;

int free_port() {
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
    for (const auto& entry : fs::directory_iterator(folder()))
      if (entry.is_directory()) return true;
    return false;
  }
  void TearDown() override {
    if (listener_ > 0) {
      ::kill(listener_, SIGSTOP);  // it starts no other meanwhile
      const int child = server();
      ::kill(listener_, SIGKILL);
      ::waitpid(listener_, nullptr, 0);
      if (child > 0) {
        EXPECT_TRUE(gone_within(child, 3.0)) << "an orphan was left";
      }
      // What was just being started may be making its folders yet: the kernel ends it when it has got that
      // far.
      for (int k = 0; k < 500 && swept_folders_left(); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      if (HasFailure()) std::cerr << std::ifstream(folder() / "listener.log").rdbuf();
      fs::remove(folder() / "listener.log");
    }
    Traces::TearDown();
  }
  std::unique_ptr<DemInfill> local() {
    return std::make_unique<DemInfill>(block_.grains, block_.materials, settings_);
  }
  std::unique_ptr<DemInfill> remote() {
    DemSettings settings = settings_;
    settings.options.host = endpoint_;
    return std::make_unique<DemInfill>(block_.grains, block_.materials, settings);
  }
  void advance(DemInfill& infill, int windows) const {
    const double window = 2 * 0.5 * infill.stable_step();
    for (int k = 0; k < windows; ++k) infill.advance(window, 2, block_.confine(infill, window));
  }

  ShakenBlock block_{5};
  DemSettings settings_ = settings_in_box(0.05, Vec3(0, 0, -9.81));
  std::string endpoint_;
  pid_t listener_ = -1;
};

TEST_F(Network, GivesTheBitsOfSharedMemoryAndResumes) {
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

  const fs::path file = folder() / "checkpoint.h5";
  for (DemInfill* infill : {shared.get(), over_tcp.get()}) {
    auto checkpoint = h5::File::create_atomically(file);
    h5::Group group = checkpoint.root();
    infill->save(group);
    checkpoint.commit();
  }
  over_tcp.reset();  // a listening host serves one life at a time
  auto resumed = remote();
  resumed->load(h5::File::open(file).root());
  advance(*shared, 40);
  advance(*resumed, 40);
  expect_same_bits(*shared, *resumed);
  fs::remove(file);
}

/// Two clumps meet and then leave, and so does a sphere; loads come and go.
TEST_F(Network, GivesTheBitsOfSharedMemoryForClumpsAndGrainsThatLeave) {
  block_.materials = {clumped(Clump{}), rubber()};
  Grains& grains = block_.grains;
  grains = {};
  add_clump(grains, block_.materials[0], Vec3(0.0475, 0, 0), 0.002, turn_about(Vec3(1, 2, 3), 0.7));
  add_clump(grains, block_.materials[0], Vec3(0.0445, 0.0002, 0), 0.002);
  for (const double height : {0.0492, -0.02}) {
    add_grain(grains, Vec3(0, 0, height), 0.001, 1150);
    grains.body.push_back(-1);
    grains.material.back() = 1;
  }
  listen();
  const auto shared = local();
  const auto over_tcp = remote();
  for (DemInfill* infill : {shared.get(), over_tcp.get()}) {
    for (std::size_t i = 4; i < 8; ++i) infill->set_velocity(i, Vec3(8, 0, 0), Vec3(0, 0, 0));
    infill->set_velocity(8, Vec3(0, 0, 4), Vec3(0, 100, 0));
    ContactImpulses contact = no_impulses(grains.size());
    const double window = infill->stable_step();
    for (int k = 0; k < 500; ++k) {
      const double push = k % 3 == 0 ? 1e-8 : 0;
      for (const std::size_t i : {1, 9}) {
        contact.linear.set(i, push * Vec3(1, 2, 0));
        contact.angular.set(i, 1e-3 * push * Vec3(0, 1, 1));
      }
      infill->advance(window, 2, contact);
    }
  }
  expect_same_bits(*shared, *over_tcp);
  EXPECT_GT(shared->energy().dissipated, 0) << "the clumps have met";
  EXPECT_EQ(shared->expelled().particles, 3u) << "a sphere, and clumps as one each";
  EXPECT_EQ(over_tcp->expelled().particles, shared->expelled().particles);
  EXPECT_EQ(over_tcp->expelled().momentum, shared->expelled().momentum);
  EXPECT_EQ(over_tcp->expelled().kinetic_energy, shared->expelled().kinetic_energy);
}

TEST_F(Network, AHostThatIsKilledIsOneClearLineAndTheNextRunIsServed) {
  listen();
  auto infill = remote();
  advance(*infill, 2);
  ::kill(server(), SIGKILL);
  const std::string message = message_of<RunError>([&] { advance(*infill, 1); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find(endpoint_ + " can no longer be reached"), std::string::npos) << message;
  infill.reset();
  infill = remote();
  advance(*infill, 2);
}

TEST_F(Network, AHostThatHangsOrIsNotThereIsReportedAfterTheTimeout) {
  settings_.options.answer_timeout = 0.5;
  const std::string nobody = message_of<RunError>([&] { (void)remote(); });
  EXPECT_NE(nobody.find("did not answer for 0.5 s"), std::string::npos) << nobody;
  EXPECT_NE(nobody.find("--listen tcp://*:"), std::string::npos) << nobody;
  settings_.options.answer_timeout = 10;
  listen();
  const auto infill = remote();
  advance(*infill, 1);
  const int host = server();
  ::kill(host, SIGSTOP);
  const std::string message = message_of<RunError>([&] { advance(*infill, 1); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find(endpoint_), std::string::npos) << message;
  ::kill(host, SIGCONT);
  EXPECT_TRUE(gone_within(host, 5.0)) << "a host whose driver has hung up ends";
}

/// Not even its watch on the driver runs then.
TEST_F(Network, AHostThatStaysFrozenIsEndedAndTheNextDriverServed) {
  listen({"--frozen-after", "5"});
  int host = 0;
  {
    const auto infill = remote();
    advance(*infill, 1);
    host = server();
    ::kill(host, SIGSTOP);
    EXPECT_NE(message_of<RunError>([&] { advance(*infill, 1); }), "");
  }
  EXPECT_TRUE(gone_within(host, 20.0)) << "it is still there";
  const auto next = remote();
  advance(*next, 1);
  std::stringstream said;
  said << std::ifstream(folder() / "listener.log").rdbuf();
  EXPECT_NE(said.str().find("frozen for 5 s and was ended"), std::string::npos) << said.str();
}

TEST_F(Network, AnErrorOfLiggghtsComesWithItsWords) {
  listen();
  block_.materials[0].grain->restitution = 0.01;  // LIGGGHTS wants 0.05 to 1
  const std::string message = message_of<RunError>([&] { (void)remote(); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("oefficientRestitution"), std::string::npos) << message;
}

TEST_F(Network, TakesOneRank) {
  settings_.options.ranks = 2;
  EXPECT_NE(message_of<InputError>([&] { (void)remote(); }).find("infill.dem.ranks = 2"), std::string::npos);
}

}  // namespace
}  // namespace tuft::dem::test

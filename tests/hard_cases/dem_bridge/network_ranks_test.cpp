/// A host that listens, on several MPI ranks of its machine: the bits of such ranks here, the same clear
/// ends.
#include "tests/hard_cases/dem_bridge/network.h"

namespace tuft::dem::test {
namespace {

class NetworkRanks : public Network {
 protected:
  void SetUp() override {
    Network::SetUp();
    settings_.options.ranks = 2;
    settings_.options.answer_timeout = 60;
  }
  /// Below the listener: the process that serves the driver, its mpirun and the ranks.
  [[nodiscard]] std::vector<int> all() const { return descendants(listener_); }
  [[nodiscard]] static std::string name_of(int process) {
    std::string name;
    std::ifstream("/proc/" + std::to_string(process) + "/comm") >> name;
    return name;
  }
  [[nodiscard]] int mpirun() const {
    for (const int process : all())
      if (name_of(process) == "mpirun") return process;
    ADD_FAILURE() << "there is no mpirun";
    return 0;
  }
  [[nodiscard]] std::vector<int> ranks() const {
    std::vector<int> ranks;
    for (const int process : descendants(mpirun()))
      if (name_of(process) == "liggghts_host") ranks.push_back(process);
    return ranks;
  }
  /// As on a machine with other programs.
  void listen_with_path(const std::string& other) {
    const std::string path = std::getenv("PATH") == nullptr ? "" : std::getenv("PATH");
    ::setenv("PATH", other.c_str(), 1);
    listen();
    ::setenv("PATH", path.c_str(), 1);
  }
  static void expect_gone(const std::vector<int>& processes) {
    for (const int process : processes) EXPECT_TRUE(gone_within(process, 10.0)) << process << " was left";
  }
  void expect_the_next_is_served() const {
    const auto next = remote();
    advance(*next, 1);
    EXPECT_EQ(ranks().size(), 2u);
  }
};

TEST_F(NetworkRanks, GiveTheBitsOfTheSameRanksOnThisMachineAndResume) {
  expect_the_bits_of_shared_memory_and_resume();
}

TEST_F(NetworkRanks, AreProcessesOfMpirunBelowTheListener) {
  listen();
  const auto infill = remote();
  advance(*infill, 1);
  EXPECT_EQ(ranks().size(), 2u);
  EXPECT_TRUE(descendants(::getpid()) == [&] {
    std::vector<int> own{listener_};
    const std::vector<int> below = all();
    own.insert(own.end(), below.begin(), below.end());
    return own;
  }()) << "none is started on the driver's side";
}

/// The grain is on the second rank.
TEST_F(NetworkRanks, AGrainThatLeavesOnAnotherRankIsBookedAsOnThisMachine) {
  block_.grains = {};
  add_grain(block_.grains, Vec3(-0.03, 0, 0), 0.001, 1150);
  add_grain(block_.grains, Vec3(0.0495, 0, 0), 0.001, 1150);
  listen();
  const auto shared = local();
  const auto over_tcp = remote();
  for (DemInfill* infill : {shared.get(), over_tcp.get()}) {
    infill->set_velocity(1, Vec3(3, 0, 0), Vec3(0, 0, 0));
    for (int k = 0; k < 300; ++k) infill->advance(1e-6, 1, no_impulses(2));
  }
  expect_same_bits(*shared, *over_tcp);
  EXPECT_EQ(over_tcp->expelled().particles, 1u);
  EXPECT_EQ(over_tcp->particles().expelled[1], 1);
  EXPECT_EQ(over_tcp->expelled().momentum, shared->expelled().momentum);
  EXPECT_EQ(over_tcp->expelled().kinetic_energy, shared->expelled().kinetic_energy);
}

TEST_F(NetworkRanks, OneThatIsKilledIsOneClearLineAndEndsAll) {
  listen();
  const auto infill = remote();
  advance(*infill, 1);
  const std::vector<int> before = all();
  ASSERT_EQ(ranks().size(), 2u);
  ::kill(ranks().back(), SIGKILL);
  const std::string message = message_of<RunError>([&] { advance(*infill, 1); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("liggghts_host ended with exit code"), std::string::npos) << message;
  EXPECT_NE(message.find("exited on signal 9 (Killed)"), std::string::npos) << message;
  EXPECT_EQ(message_of<RunError>([&] { advance(*infill, 1); }), message) << "asking again must not hang";
  expect_gone(before);
  expect_the_next_is_served();
}

TEST_F(NetworkRanks, AnMpirunThatIsKilledIsOneClearLineAndEndsAll) {
  listen();
  const auto infill = remote();
  advance(*infill, 1);
  const std::vector<int> before = all();
  ::kill(mpirun(), SIGKILL);
  // Ranks know of it a moment later, and may answer till then.
  const std::string message = message_of<RunError>([&] { advance(*infill, 1'000'000); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("liggghts_host ended with signal 9"), std::string::npos) << message;
  EXPECT_EQ(message.find("its last words"), std::string::npos) << "nobody said any: " << message;
  expect_gone(before);
  expect_the_next_is_served();
}

TEST_F(NetworkRanks, AllEndWhenTheirDriverIsKilled) {
  listen();
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t driver = ::fork();
  if (driver == 0) {
    const auto infill = remote();
    advance(*infill, 1);
    if (::write(pipe_ends[1], "", 1) != 1) ::_exit(1);
    ::raise(SIGKILL);
  }
  char ready = 0;
  ::close(pipe_ends[1]);
  EXPECT_EQ(::read(pipe_ends[0], &ready, 1), 1);
  ::close(pipe_ends[0]);
  const std::vector<int> before = all();
  ASSERT_EQ(::waitpid(driver, nullptr, 0), driver);
  expect_gone(before);
  expect_the_next_is_served();
}

/// Not even the end of the process that serves them reaches them then.
TEST_F(NetworkRanks, ThatAreFrozenWithTheirMpirunAreEndedWhenTheDriverGivesUp) {
  listen();
  settings_.options.answer_timeout = 10;  // for their start, too
  const auto infill = remote();
  advance(*infill, 1);
  const std::vector<int> before = all();
  std::vector<int> frozen = ranks();
  ASSERT_EQ(frozen.size(), 2u);
  frozen.push_back(mpirun());
  for (const int process : frozen) ::kill(process, SIGSTOP);
  const std::string message = message_of<RunError>([&] { advance(*infill, 1); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("did not answer for 10 s at " + endpoint_ + "; it hangs"), std::string::npos)
      << message;
  EXPECT_EQ(message.find("its last words"), std::string::npos) << message;
  expect_gone(before);
  settings_.options.answer_timeout = 60;
  expect_the_next_is_served();
}

TEST_F(NetworkRanks, AnErrorOfLiggghtsComesWithItsWords) {
  listen();
  block_.materials[0].grain->restitution = 0.01;  // LIGGGHTS wants 0.05 to 1
  const std::string message = message_of<RunError>([&] { (void)remote(); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("oefficientRestitution"), std::string::npos) << message;
  EXPECT_NE(message.find("its last words: ERROR"), std::string::npos) << message;
}

TEST_F(NetworkRanks, ThatDoNotComeAreEndedWhenTheDriverGivesUp) {
  const std::filesystem::path mpirun = folder() / "mpirun", note = folder() / "note";
  std::ofstream(mpirun) << "#!/bin/sh\necho $$ > " << note.string() << "\nexec /bin/sleep 100\n";
  std::filesystem::permissions(mpirun, std::filesystem::perms::owner_all);
  listen_with_path(folder().string());
  settings_.options.answer_timeout = 4;
  const std::string message = message_of<RunError>([&] { (void)remote(); });
  EXPECT_NE(message.find("did not answer for 4 s"), std::string::npos) << message;
  int started = 0;
  std::ifstream(note) >> started;
  ASSERT_GT(started, 0) << "nothing is tested";
  EXPECT_TRUE(gone_within(started, 10.0));
  std::filesystem::remove(mpirun);
  std::filesystem::remove(note);
}

TEST_F(NetworkRanks, WithoutMpirunOnTheHostsMachineSaySo) {
  listen_with_path(folder().string());
  const std::string message = message_of<RunError>([&] { (void)remote(); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("there is no mpirun in PATH"), std::string::npos) << message;
}

}  // namespace
}  // namespace tuft::dem::test

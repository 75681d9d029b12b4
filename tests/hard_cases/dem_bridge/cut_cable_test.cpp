/// A network that is gone without a word, as by a cable pulled out: both ends end, soon, and the run goes on.
#include <chrono>

#include "dem_bridge/zmq_link.h"
#include "tests/hard_cases/dem_bridge/network.h"
#include "tests/hard_cases/dem_bridge/silent_cable.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// s, after which a silent network is given up (zmq_link.h), and what a busy machine may add.
constexpr double silence = 1e-3 * (heartbeat_interval + heartbeat_timeout), margin = 6;

class CutCable : public Network {
 protected:
  void SetUp() override {
    Network::SetUp();
    settings_.options.answer_timeout = 60;  // far beyond
    listen();
  }
  [[nodiscard]] int port() const { return std::stoi(endpoint_.substr(endpoint_.rfind(':') + 1)); }

  void expect_both_ends_to_end_and_the_run_to_go_on(int ranks) {
    settings_.options.ranks = ranks;
    const fs::path file = folder() / "checkpoint.h5";
    SilentCable cable(port());
    const std::string through_cable = "tcp://127.0.0.1:" + std::to_string(cable.port());
    auto infill = remote(through_cable);
    block_.shake(*infill, 0.5);
    advance(*infill, 40);
    save_run(*infill, file);
    advance(*infill, 5);
    EXPECT_EQ(cable.connections(), 1);
    const std::vector<int> there = descendants(listener_);
    ASSERT_GE(there.size(), ranks > 1 ? 4u : 1u);

    cable.pull();
    const auto start = Clock::now();
    const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    const std::string message = message_of<RunError>([&] { advance(*infill, 1); });
    EXPECT_LT(passed(), silence + margin);
    EXPECT_TRUE(is_one_line(message)) << message;
    EXPECT_NE(message.find(through_cable + " can no longer be reached"), std::string::npos) << message;
    EXPECT_EQ(message.find("its last words"), std::string::npos) << message;
    for (const int process : there)
      EXPECT_TRUE(gone_within(process, std::max(1.0, silence + margin - passed()))) << process << " was left";

    const auto whole = local();
    block_.shake(*whole, 0.5);
    advance(*whole, 40);
    const fs::path left = folder() / "left.h5";
    fs::rename(file, left);
    save_run(*whole, file);
    advance(*whole, 20);
    const auto resumed = remote();
    resumed->load(h5::File::open(left).root());
    advance(*resumed, 20);
    expect_same_bits(*whole, *resumed);
    fs::remove(file);
    fs::remove(left);
  }
};

TEST_F(CutCable, EndsBothEndsSoonAndTheRunGoesOn) {
  expect_both_ends_to_end_and_the_run_to_go_on(1);
}

TEST_F(CutCable, EndsRanksThereTooAndTheRunGoesOn) {
  expect_both_ends_to_end_and_the_run_to_go_on(2);
}

}  // namespace
}  // namespace tuft::dem::test

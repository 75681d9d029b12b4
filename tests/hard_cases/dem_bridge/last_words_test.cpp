/// What an error says of a host on another machine that has ended: LIGGGHTS' own last words if it had named
/// an error, else nothing of last words.
#include <algorithm>

#include "dem_bridge/host_wire.h"
#include "dem_bridge/liggghts_script.h"
#include "dem_bridge/protocol.h"
#include "tests/hard_cases/dem_bridge/network.h"

namespace tuft::dem::test {
namespace {

class LastWords : public Network {
 protected:
  void reach(int ranks) {
    listen();
    settings_.options.host = endpoint_;
    settings_.options.ranks = ranks;
    wire_ = reach_remote_host(settings_.options, block_.grains.size());
    ASSERT_EQ(ask(Request::hello, ""), HostWire::Outcome::answered);
    wire_->write_file("grains.data", data_file(block_.grains, {0}, host_domain(settings_)));
  }
  HostWire::Outcome ask(Request request, const std::string& text = "") {
    return wire_->exchange(static_cast<char>(request) + text,
                           HostWire::Clock::now() + std::chrono::seconds(30), answers_);
  }
  /// Sets grains up, and then has LIGGGHTS do some more.
  HostWire::Outcome set_up_and(const std::string& more) {
    const auto [smallest, largest] =
        std::minmax_element(block_.grains.radius.begin(), block_.grains.radius.end());
    return ask(Request::commands, set_up_commands("read_data grains.data", {0}, block_.materials, settings_,
                                                  {block_.grains.size(), *smallest, *largest}, 1e-6) +
                                      more);
  }
  void TearDown() override {
    wire_.reset();
    Network::TearDown();
  }
  std::unique_ptr<HostWire> wire_;
  std::vector<std::string> answers_;
};

TEST_F(LastWords, AreNoneOfAHostThatIsKilledAfterItHadPrintedThisAndThat) {
  reach(1);
  ASSERT_EQ(set_up_and("print \"Loop time of 3.2\"\n"), HostWire::Outcome::answered);
  ASSERT_EQ(answers_[0], std::string(1, static_cast<char>(Answer::done)));
  EXPECT_NE(wire_->memory().words().find("Loop time"), std::string::npos) << "nothing is tested";
  ::kill(server(), SIGKILL);
  EXPECT_EQ(ask(Request::energy), HostWire::Outcome::gone);
  EXPECT_EQ(wire_->last_words(), "");
  EXPECT_EQ(tell_end(*wire_).find("words"), std::string::npos) << tell_end(*wire_);
}

TEST_F(LastWords, AreTheErrorThatAHostHadNamedBeforeItWasKilled) {
  reach(1);
  ASSERT_EQ(set_up_and("print \"ERROR: made up\"\nprint \"Loop time of 3.2\"\n"),
            HostWire::Outcome::answered);
  ::kill(server(), SIGKILL);
  EXPECT_EQ(ask(Request::energy), HostWire::Outcome::gone);
  EXPECT_EQ(wire_->last_words(), "ERROR: made up");
  EXPECT_TRUE(tell_end(*wire_).ends_with("; its last words: ERROR: made up")) << tell_end(*wire_);
}

/// LIGGGHTS has a file opened by one rank, and Error::one aborts MPI.
TEST_F(LastWords, ComeOfAHostThatAborts) {
  for (const int ranks : {1, 2}) {
    reach(ranks);
    ASSERT_EQ(set_up_and("include no_such_file\n"), HostWire::Outcome::answered);
    EXPECT_EQ(answers_[0][0], static_cast<char>(Answer::failed));
    EXPECT_TRUE(is_one_line(answers_[0])) << answers_[0];
    EXPECT_NE(answers_[0].find("its last words: ERROR"), std::string::npos) << answers_[0];
    EXPECT_NE(answers_[0].find("no_such_file"), std::string::npos) << answers_[0];
    wire_.reset();
    stop_listening();
  }
}

/// Ranks are told of by the process that started them, however they end.
TEST_F(LastWords, ComeOfRanksThatAreKilledRightAfterThem) {
  reach(2);
  ASSERT_EQ(set_up_and("print \"ERROR: made up\"\nshell kill -9 $PPID\n"), HostWire::Outcome::answered);
  EXPECT_EQ(answers_[0][0], static_cast<char>(Answer::failed));
  EXPECT_NE(answers_[0].find("liggghts_host"), std::string::npos) << answers_[0];
  EXPECT_NE(answers_[0].find("its last words: ERROR: made up"), std::string::npos) << answers_[0];
}

}  // namespace
}  // namespace tuft::dem::test

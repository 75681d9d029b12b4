#include "studies/turns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "core/error.h"

namespace tuft::studies {
namespace {

/// A machine whose clock goes on by what scenes take.
struct Machine {
  double now = 100;
  std::string order;  ///< letters of the scenes, as they were stepped
  /// What was saved last: intervals settled and moved of a scene.
  std::pair<std::uint64_t, std::uint64_t> saved{0, 0};
};

/// A scene that takes `each` s an interval, and whose rig presses from the first interval after its release
/// to before the second. `fails_at`, `ends_at`, `stopped_at`: intervals after the release.
struct FakeSetting {
  char letter = 'a';
  bool adopts = true, fits = true;
  double each = 0.01;
  std::pair<std::uint64_t, std::uint64_t> pressed{40, 1000000};
  std::uint64_t much = 1000000;  ///< from when on it presses 20 times as much
  std::uint64_t fails_at = 1000000, ends_at = 1000000, stopped_at = 60;
};

class FakeScene final : public SteppedScene {
 public:
  FakeScene(Machine& machine, const FakeSetting& setting) : machine_(machine), setting_(setting) {}
  Stretch walk(std::uint64_t intervals) override {
    machine_.order += setting_.letter;
    Stretch s;
    for (std::uint64_t i = 0; i < intervals; ++i) {
      if (released_ && moved_ == setting_.fails_at) throw RunError("the energy balance is off");
      if (released_ && moved_ == setting_.ends_at) return s;
      ++s.intervals;
      machine_.now += setting_.each;
      s.processor_s += setting_.each;
      s.windows += 2;
      s.particle_steps += 20;
      if (!released_) {
        ++settled_;
        continue;
      }
      if (moved_ >= setting_.pressed.first && moved_ < setting_.pressed.second)
        s.push += moved_ >= setting_.much ? 20 : 1;
      s.motion = moved_ < setting_.stopped_at ? 4 : 0.5;
      ++moved_;
    }
    return s;
  }
  void release() override { released_ = true; }
  void save(const std::filesystem::path&) override { machine_.saved = {settled_, moved_}; }
  void adopt(const std::filesystem::path&) override {
    if (!setting_.fits) throw InputError("another number of shells");
    std::tie(settled_, moved_) = machine_.saved;
    released_ = true;
  }

 private:
  Machine& machine_;
  FakeSetting setting_;
  std::uint64_t settled_ = 0, moved_ = 0;
  bool released_ = false;
};

TurnRequest request_for(Machine& machine, const std::vector<FakeSetting>& settings) {
  TurnRequest request;
  for (const FakeSetting& setting : settings)
    request.entrants.push_back({std::string(1, setting.letter), setting.adopts, [&machine, setting](bool) {
                                  return std::make_unique<FakeScene>(machine, setting);
                                }});
  request.clock = [&machine] { return machine.now; };
  request.settle_least = 5;
  request.settle_most = 20;
  request.moving = 100;
  request.seconds = 1000;
  return request;
}

TEST(Turns, TakeAllThroughTheSameTimeInChangingOrder) {
  Machine machine;
  const TurnRecord record =
      take_turns(request_for(machine, {{.letter = 'a'}, {.letter = 'b'}, {.letter = 'c'}}));
  EXPECT_EQ(record.end, TurnRecord::End::whole);
  const std::size_t turns = record.turns();
  ASSERT_GT(turns, 25u);
  for (const auto& stretches : record.stretches) EXPECT_EQ(stretches.size(), turns);
  const std::string order = machine.order.substr(machine.order.size() - 3 * turns);
  std::map<char, int> first;
  for (std::size_t turn = 0; turn < turns; ++turn) {
    std::string letters = order.substr(3 * turn, 3);
    ++first[letters[0]];
    std::sort(letters.begin(), letters.end());
    EXPECT_EQ(letters, "abc") << turn;
  }
  for (const char letter : {'a', 'b', 'c'}) EXPECT_GT(first[letter], 3) << letter;
  for (std::size_t k = 1; k < order.size(); ++k) EXPECT_NE(order[k], order[k - 1]) << k;
}

TEST(Turns, BeginWhereTheRigBeginsToPress) {
  Machine machine;
  const TurnRecord record = take_turns(request_for(machine, {{.letter = 'a'}, {.letter = 'b'}}));
  EXPECT_EQ(record.settled, 20u) << "in full, where there is time";
  EXPECT_EQ(record.turn, 2u) << "a fiftieth of all that follows";
  EXPECT_EQ(record.start, 43u) << "after a stretch that is pressed, and one interval for lists";
  for (const auto& stretches : record.stretches)
    for (const Stretch& s : stretches) EXPECT_GT(s.push, 0);
}

TEST(Turns, BeginOnceMoreWhereItPressesTenTimesAsMuch) {
  Machine machine;
  const TurnRecord late = take_turns(request_for(
      machine, {{.letter = 'a', .pressed = {10, 1000000}, .much = 50, .stopped_at = 70}, {.letter = 'b'}}));
  EXPECT_EQ(late.start, 53u) << "a touch before that is none of the blow";
}

TEST(Turns, KeepToTheTime) {
  Machine machine;
  TurnRequest request = request_for(machine, {{.letter = 'a'}, {.letter = 'b'}});
  request.seconds = 1.2;
  const TurnRecord record = take_turns(request);
  EXPECT_EQ(record.settled, 5u) << "no more than it takes";
  EXPECT_EQ(record.turn, 1u);
  EXPECT_EQ(record.end, TurnRecord::End::out_of_time);
  EXPECT_GT(record.turns(), 10u);
  EXPECT_LE(machine.now - 100, 1.2 + 1e-9);
}

TEST(Turns, AreOfWhatWasReachedWhereTimeIsShort) {
  Machine machine;
  TurnRequest request =
      request_for(machine, {{.letter = 'a', .pressed = {90, 100}, .stopped_at = 95}, {.letter = 'b'}});
  request.seconds = 1;
  const TurnRecord record = take_turns(request);
  EXPECT_TRUE(record.cut);
  EXPECT_LT(record.start, 60u);
  EXPECT_GT(record.turns(), 0u);
  request.seconds = 1000;
  EXPECT_FALSE(take_turns(request).cut);
}

TEST(Turns, EndWithoutOneWhereSettlingTakesAllTheTime) {
  Machine machine;
  TurnRequest request = request_for(machine, {{.letter = 'a'}, {.letter = 'b'}});
  request.settle_least = request.settle_most = 50;
  request.seconds = 0.05;
  const TurnRecord record = take_turns(request);
  EXPECT_EQ(record.turns(), 0u);
  EXPECT_EQ(record.end, TurnRecord::End::out_of_time);
}

TEST(Turns, EndWhenTheRigLetsGo) {
  Machine machine;
  const TurnRecord record =
      take_turns(request_for(machine, {{.letter = 'a', .pressed = {20, 60}}, {.letter = 'b'}}));
  EXPECT_EQ(record.end, TurnRecord::End::struck);
  EXPECT_LT(record.start + 2 * record.turns(), 70u);
}

TEST(Turns, GiveARunUpToWhatTheStateDoesNotFit) {
  Machine machine;
  const TurnRecord record = take_turns(request_for(
      machine,
      {{.letter = 'a'}, {.letter = 'b', .fits = false}, {.letter = 'c', .adopts = false}, {.letter = 'd'}}));
  EXPECT_EQ(record.failures, std::vector<std::string>(4));
  for (const auto& stretches : record.stretches) {
    ASSERT_EQ(stretches.size(), record.turns());
    EXPECT_GT(stretches.front().push, 0) << "it stands where the first does";
  }
}

TEST(Turns, SayForWhatThereWasNoTime) {
  Machine machine;
  TurnRequest request =
      request_for(machine, {{.letter = 'a'}, {.letter = 'b', .adopts = false}, {.letter = 'c'}});
  request.seconds = 1.2;
  request.entrants[1].adopts = false;
  const TurnRecord record = take_turns(request);
  EXPECT_NE(record.failures[1].find("run-up of its own"), std::string::npos) << record.failures[1];
  EXPECT_NE(record.failures[1].find("--cost-seconds"), std::string::npos);
  EXPECT_GT(record.stretches[2].size(), 0u);
}

TEST(Turns, BreakOffARunUpThatIsMuchSlower) {
  Machine machine;
  TurnRequest request =
      request_for(machine, {{.letter = 'a'}, {.letter = 'b', .adopts = false, .each = 1}, {.letter = 'c'}});
  request.seconds = 20;
  const TurnRecord record = take_turns(request);
  EXPECT_NE(record.failures[1].find("run-up of its own"), std::string::npos) << record.failures[1];
  EXPECT_EQ(record.stretches[2].size(), record.turns());
  EXPECT_LT(machine.now - 100, 20);
}

TEST(Turns, LeaveOutWhatFailsAndGoOnWithTheRest) {
  Machine machine;
  TurnRequest request =
      request_for(machine, {{.letter = 'a'}, {.letter = 'b', .fails_at = 60}, {.letter = 'c'}});
  request.entrants.push_back(
      {"d", false, [](bool) -> std::unique_ptr<SteppedScene> { throw InputError("no such grains"); }});
  const TurnRecord record = take_turns(request);
  EXPECT_GT(record.turns(), 25u);
  EXPECT_EQ(record.stretches[1].size(), 8u);
  EXPECT_EQ(record.stretches[2].size(), record.turns());
  EXPECT_EQ(record.failures,
            (std::vector<std::string>{"", "the energy balance is off", "", "no such grains"}));
}

TEST(Turns, FailWhereTheFirstFails) {
  Machine machine;
  EXPECT_THROW(
      static_cast<void>(take_turns(request_for(machine, {{.letter = 'a', .fails_at = 30}, {.letter = 'b'}}))),
      RunError);
}

TEST(Turns, EndWithTheFirstScene) {
  Machine machine;
  const TurnRecord record = take_turns(
      request_for(machine, {{.letter = 'a', .pressed = {0, 1000000}, .ends_at = 40}, {.letter = 'b'}}));
  EXPECT_EQ(record.end, TurnRecord::End::whole);
  EXPECT_GT(record.turns(), 10u);
  EXPECT_LE(record.start + record.turn * record.turns(), 40u);
}

TEST(Turns, StopBetweenTwoStretchesAndForgetTheUnfinishedTurn) {
  Machine machine;
  std::atomic<bool> stop = false;
  TurnRequest request = request_for(machine, {{.letter = 'a'}, {.letter = 'b'}});
  request.stop = &stop;
  request.on_progress = [&](const TurnProgress& progress) {
    stop = progress.stage == TurnProgress::Stage::turns && progress.done == 7;
  };
  const TurnRecord record = take_turns(request);
  EXPECT_EQ(record.end, TurnRecord::End::stopped);
  EXPECT_EQ(record.turns(), 7u);
  EXPECT_EQ(record.stretches[0].size(), record.stretches[1].size());
}

TEST(Turns, SayWhatTheyDo) {
  Machine machine;
  TurnRequest request = request_for(machine, {{.letter = 'a'}, {.letter = 'b'}});
  std::map<TurnProgress::Stage, int> seen;
  request.on_progress = [&](const TurnProgress& progress) {
    ++seen[progress.stage];
    EXPECT_EQ(progress.scenes, 2u);
    EXPECT_GE(progress.left, 0);
  };
  const TurnRecord record = take_turns(request);
  EXPECT_EQ(seen[TurnProgress::Stage::building], 3);
  EXPECT_GE(seen[TurnProgress::Stage::settling], 5);
  EXPECT_GE(seen[TurnProgress::Stage::run_up], 10);
  EXPECT_EQ(seen[TurnProgress::Stage::turns], static_cast<int>(record.turns()));
}

}  // namespace
}  // namespace tuft::studies

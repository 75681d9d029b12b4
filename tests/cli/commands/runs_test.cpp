/// Whole runs through the command line: what they leave, stopping, resuming, failing.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "cli/commands/command.h"

namespace tuft::test {
namespace {

nlohmann::json summary_in(const std::string& folder) {
  return nlohmann::json::parse(read_text(folder + "/summary.json"));
}

TEST(Run, LeavesEveryFileOfTheContractAndSaysNothingOnStandardError) {
  const Workplace place;
  const Outcome outcome = run_tuft(tiny_run(place.path("run")));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_TRUE(outcome.error.empty()) << outcome.error;
  for (const char* name :
       {"scene.toml", "summary.json", "run.h5", "run.xdmf", "checkpoint.h5", "log.txt", "report.html"})
    EXPECT_TRUE(std::filesystem::exists(place.path(std::string("run/") + name))) << name;
  EXPECT_EQ(summary_in(place.path("run"))["status"], "completed");
  EXPECT_NE(outcome.out.find("report: "), std::string::npos);
}

TEST(Run, ShowsAsJsonWhatItsSummaryHolds) {
  const Workplace place;
  ASSERT_EQ(run_tuft(tiny_run(place.path("run"))).exit_code, 0);
  const Outcome shown = run_tuft({"show", place.path("run"), "--json"});
  ASSERT_EQ(shown.exit_code, 0) << shown.error;
  EXPECT_EQ(nlohmann::json::parse(shown.out), summary_in(place.path("run")));
}

TEST(Run, ThatIsStoppedCanBeResumedToTheEnd) {
  const Workplace place;
  const Outcome stopped = run_tuft(tiny_run(place.path("run"), {"--stop-after-checkpoints", "1"}));
  ASSERT_EQ(stopped.exit_code, 0) << stopped.error;
  EXPECT_EQ(summary_in(place.path("run"))["status"], "stopped");
  EXPECT_NE(stopped.out.find("tuft resume"), std::string::npos);
  const Outcome resumed = run_tuft({"resume", place.path("run")});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.error;
  EXPECT_EQ(summary_in(place.path("run"))["status"], "completed");
  const Outcome again = run_tuft({"resume", place.path("run")});
  EXPECT_EQ(again.exit_code, 0) << again.error;
  EXPECT_NE(again.out.find("completed already"), std::string::npos);
}

std::vector<std::string> conditioned_run(const std::string& folder,
                                         const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{
      "--set", "conditioning.method=compaction", "--set", "conditioning.press_time=2 ms",
      "--set", "conditioning.lift_time=1 ms",    "--set", "conditioning.settle_time=1 ms"};
  words.insert(words.end(), more.begin(), more.end());
  return tiny_run(folder, words);
}

TEST(Run, OfConditionedTurfNamesItsStagesAndItsCost) {
  const Workplace place;
  const Outcome outcome = run_tuft(conditioned_run(place.path("run")));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* stage : {"pressing ", "lifting ", "settling ", "drop "})
    EXPECT_NE(outcome.out.find(stage), std::string::npos) << stage << outcome.out;
  const auto summary = summary_in(place.path("run"));
  EXPECT_GT(summary["cost"]["conditioning"], 0);
  EXPECT_TRUE(summary["notes"].contains("conditioning_energy_let_go"));
}

TEST(Run, OfConditionedTurfThatIsStoppedUnderThePlateCanBeResumedToTheEnd) {
  const Workplace place;
  const Outcome stopped = run_tuft(conditioned_run(place.path("run"), {"--stop-after-checkpoints", "1"}));
  ASSERT_EQ(stopped.exit_code, 0) << stopped.error;
  EXPECT_LT(summary_in(place.path("run"))["simulated_time"], -0.003);
  const Outcome resumed = run_tuft({"resume", place.path("run")});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.error;
  EXPECT_EQ(summary_in(place.path("run"))["status"], "completed");
}

TEST(Run, OfALawThatCompactionCannotLeaveSoDenseIsRefusedBeforeTheBedIsPressed) {
  const Workplace place;
  const Outcome outcome = run_tuft(conditioned_run(
      place.path("run"), {"--set", "conditioning.depth=13 mm", "--set", "conditioning.state=compacted"}));
  expect_bad_input(outcome,
                   {"conditioning.state: ", " cannot be left so dense: ", "or set it to \"initial\""});
}

TEST(Run, IsResumedFromItsResolvedSceneAloneWithoutTheOriginal) {
  const Workplace place;
  ASSERT_EQ(run_tuft(tiny_run(place.path("run"), {"--stop-after-checkpoints", "1"})).exit_code, 0);
  std::filesystem::rename(place.path("run"), place.path("moved"));
  const Outcome resumed = run_tuft({"resume", place.path("moved"), "--threads", "1"});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
}

TEST(Run, ThatIsInterruptedWritesACheckpointAndStops) {
  const Workplace place;
  const Outcome outcome =
      run_tuft(tiny_run(place.path("run"), {"--set", "scene.duration=10 s"}), {.interrupt_after = 3});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.error;
  EXPECT_EQ(summary_in(place.path("run"))["status"], "stopped");
  EXPECT_TRUE(std::filesystem::exists(place.path("run/checkpoint.h5")));
  EXPECT_NE(outcome.out.find("tuft resume"), std::string::npos);
}

TEST(Run, OverItsEnergyLimitFailsAndKeepsItsRecords) {
  const Workplace place;
  const Outcome outcome =
      run_tuft(tiny_run(place.path("run"), {"--set", "numerics.energy_error_limit=1e-12"}));
  expect_failed_run(outcome, {"energy"});
  const auto summary = summary_in(place.path("run"));
  EXPECT_EQ(summary["status"], "failed");
  EXPECT_NE(outcome.error.find(summary["error"].get<std::string>()), std::string::npos);
  EXPECT_EQ(run_tuft({"report", place.path("run")}).exit_code, 0);
  EXPECT_NE(read_text(place.path("run/report.html")).find("state failed"), std::string::npos);
}

TEST(Run, WhoseDiskIsFullFailsAndStaysReadable) {
  const Workplace place;
  const Outcome outcome = run_tuft(
      tiny_run(place.path("run"), {"--set", "output.frames=0.02 ms", "--set", "scene.duration=4 ms"}),
      {.largest_file = 300'000});
  expect_failed_run(outcome, {"run.h5"});
  EXPECT_EQ(summary_in(place.path("run"))["status"], "failed");
  EXPECT_EQ(run_tuft({"show", place.path("run")}).exit_code, 0);
  EXPECT_EQ(run_tuft({"report", place.path("run")}).exit_code, 0);
}

/// Its scene is there from the start, long before anything is recorded.
TEST(Run, WhoseHostIsKilledWhilePackingStartsAnewWhenResumed) {
  const Workplace place;
  const std::string folder = place.path("run");
  expect_failed_run(run_tuft(grain_run(folder), kill_host_at(place.path("run/log.txt"))),
                    {"liggghts_host", "signal"});
  EXPECT_FALSE(std::filesystem::exists(place.path("run/run.h5")));
  const Outcome resumed = run_tuft({"resume", folder});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.error;
  EXPECT_NE(resumed.out.find("starts from the beginning"), std::string::npos);
  EXPECT_EQ(summary_in(folder)["status"], "completed");
}

TEST(Run, IsResumedWithAnotherHostWhereOneIsNamed) {
  const Workplace place;
  const std::string folder = place.path("run");
  const Outcome stopped = run_tuft(grain_run(folder, {"--stop-after-checkpoints", "1"}));
  ASSERT_EQ(stopped.exit_code, 0) << stopped.error;
  expect_bad_input(run_tuft({"resume", folder, "--host", "tcp://nowhere"}),
                   {"infill.dem.host", "tcp://nowhere"});
  expect_bad_input(run_tuft({"resume", folder, "--host", "/no/such/host"}), {"/no/such/host"});
  const Outcome resumed = run_tuft({"resume", folder, "--host", HOST_PROGRAM});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
}

TEST(Run, ThatIsAtWorkIsNotResumedByAnother) {
  const Workplace place;
  ASSERT_EQ(run_tuft(tiny_run(place.path("run"), {"--stop-after-checkpoints", "1"})).exit_code, 0);
  const int folder = open(place.path("run").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(folder, LOCK_EX | LOCK_NB), 0);
  expect_bad_input(run_tuft({"resume", place.path("run")}), {place.path("run"), "at work in this folder"});
  close(folder);
  EXPECT_EQ(run_tuft({"resume", place.path("run")}).exit_code, 0);
}

TEST(Run, OnAContinuumIsNotResumedWithAHost) {
  const Workplace place;
  ASSERT_EQ(run_tuft(tiny_run(place.path("run"), {"--stop-after-checkpoints", "1"})).exit_code, 0);
  expect_bad_input(run_tuft({"resume", place.path("run"), "--host", "/bin/false"}), {"--host", "no grains"});
}

TEST(Run, WhoseHostIsKilledFailsKeepsItsRecordsAndGoesOnWhenResumed) {
  const Workplace place;
  const std::string folder = place.path("run");
  const std::vector<std::string> words = grain_run(folder, {"--set", "scene.duration=12 ms"});
  const Outcome outcome = run_tuft(words, kill_host_at(place.path("run/checkpoint.h5")));
  expect_failed_run(outcome, {"liggghts_host", "signal"});
  EXPECT_EQ(summary_in(folder)["status"], "failed");
  EXPECT_EQ(run_tuft({"report", folder}).exit_code, 0);
  const Outcome resumed = run_tuft({"resume", folder});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.error;
  EXPECT_EQ(summary_in(folder)["status"], "completed");
}

TEST(Check, SaysOk) {
  std::vector<std::string> words{"check"};
  const auto scene = tiny_scene();
  words.insert(words.end(), scene.begin(), scene.end());
  const Outcome outcome = run_tuft(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.out.find("ok\n"), std::string::npos) << outcome.out;
}

TEST(Check, SaysWhatConditioningOfGrainsIsOfTheRun) {
  const auto check = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"check", "inputs/clegg_small.toml", "--infill", "dem"});
    return run_tuft(words);
  };
  const Outcome pressed = check({"--set", "conditioning.method=compaction", "--set",
                                 "conditioning.press_time=20ms", "--set", "conditioning.lift_time=5ms",
                                 "--set", "conditioning.settle_time=5ms", "--set", "conditioning.presses=2"});
  ASSERT_EQ(pressed.exit_code, 0) << pressed.error;
  // Two presses of 30 ms, then some 30 ms of settling and 25 ms of the drop.
  EXPECT_NE(pressed.out.find("at most 60 ms under a plate, 52 % of"), std::string::npos) << pressed.out;
  const Outcome rolled = check({"--set", "conditioning.method=roller"});
  EXPECT_NE(rolled.out.find("ms under a roller, "), std::string::npos) << rolled.out << rolled.error;
  EXPECT_EQ(check({}).out.find("under a"), std::string::npos);
}

TEST(Explain, NamesEffectsSizesStepsAndPrediction) {
  std::vector<std::string> words{"explain"};
  const auto scene = tiny_scene();
  words.insert(words.end(), scene.begin(), scene.end());
  const Outcome outcome = run_tuft(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* part : {"Effects", "fibres", "off", "particles", "coupling window", "wall time", "memory"})
    EXPECT_NE(outcome.out.find(part), std::string::npos) << part << " is missing in:\n" << outcome.out;
}

/// With a host that is none DEM fails; SPH must run, be reported, and the whole exit with 1.
TEST(Compare, ReportsTheRunThatSucceededWhenTheOtherFails) {
  const Workplace place;
  std::vector<std::string> words{"compare"};
  const auto scene = tiny_scene();
  words.insert(words.end(), scene.begin(), scene.end());
  words.insert(words.end(), {"--set", "infill.dem.host=/bin/false", "--out", place.path("both")});
  const Outcome outcome = run_tuft(words);
  expect_failed_run(outcome, {"dem: ", "liggghts_host ended with exit code 1"});
  EXPECT_EQ(summary_in(place.path("both/sph"))["status"], "completed");
  EXPECT_EQ(summary_in(place.path("both/dem"))["status"], "failed");
  const std::string page = read_text(place.path("both/report.html"));
  EXPECT_NE(page.find("state completed"), std::string::npos);
  EXPECT_NE(page.find("state failed"), std::string::npos);
  const Outcome shown = run_tuft({"show", place.path("both"), "--json"});
  ASSERT_EQ(shown.exit_code, 0) << shown.error;
  EXPECT_EQ(nlohmann::json::parse(shown.out)["dem"]["status"], "failed");
}

}  // namespace
}  // namespace tuft::test

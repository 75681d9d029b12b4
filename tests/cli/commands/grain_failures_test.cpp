/// What a run with grains comes to when its host hangs, fails or is killed, or is killed itself: one clear
/// line, nothing left behind, and a run that goes on.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "cli/commands/command.h"
#include "cli/commands/same_records.h"
#include "rigs/run_folder.h"
#include "tests/hard_cases/dem_bridge/traces.h"

namespace tuft::test {
namespace {

namespace fs = std::filesystem;

class GrainFailure : public dem::test::Traces {
 protected:
  void SetUp() override {
    Traces::SetUp();
    // Whoever loses its parent becomes a child of this process, which looks at the end whether one is left.
    ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  }
  void TearDown() override {
    expect_no_process_left();
    Traces::TearDown();
    ::prctl(PR_SET_CHILD_SUBREAPER, 0);
  }
  static void expect_no_process_left() {
    for (int i = 0; i < 1000; ++i) {
      if (::waitpid(-1, nullptr, WNOHANG) < 0) return;
      ::usleep(10'000);
    }
    ADD_FAILURE() << "a process is left";
  }

  [[nodiscard]] std::vector<std::string> words(const std::string& folder,
                                               const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"--set", "scene.duration=6 ms", "--set", "output.checkpoint_every=1 ms"};
    all.insert(all.end(), more.begin(), more.end());
    return grain_run(folder, all);
  }
  /// Some rows into the run.
  [[nodiscard]] Trouble in_the_middle(std::function<void(const Processes&)> blow) const {
    return {.blow_at = run_ + "/checkpoint.h5", .blow = std::move(blow)};
  }
  [[nodiscard]] nlohmann::json summary() const {
    return nlohmann::json::parse(read_text(run_ + "/summary.json"));
  }
  void expect_readable_records() const {
    EXPECT_GT(rigs::recorded_rows(run_), 0u);
    if (!fs::exists(run_ + "/summary.json")) return;
    EXPECT_EQ(summary()["status"], "failed");
    EXPECT_GT(summary()["steps"], 0);
    EXPECT_EQ(run_tuft({"report", run_}).exit_code, 0);
  }
  void expect_to_go_on(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> resume{"resume", run_};
    resume.insert(resume.end(), more.begin(), more.end());
    const Outcome resumed = run_tuft(resume);
    ASSERT_EQ(resumed.exit_code, 0) << resumed.error;
    EXPECT_TRUE(resumed.error.empty()) << resumed.error;
    EXPECT_EQ(summary()["status"], "completed");
  }
  void expect_bits_of_an_unbroken_run() const {
    const std::string whole = place_.path("whole");
    const Outcome outcome = run_tuft(words(whole));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    expect_same_records(run_, whole);
    const auto unbroken = nlohmann::json::parse(read_text(whole + "/summary.json"));
    EXPECT_EQ(summary()["results"], unbroken["results"]);
    EXPECT_EQ(summary()["steps"], unbroken["steps"]);
    EXPECT_EQ(summary()["energy_error"], unbroken["energy_error"]);
  }
  /// A host that does something in its folder before it is one. Returns its path.
  [[nodiscard]] std::string host_after(const std::string& command) const {
    place_.write("host", "#!/bin/sh\n" + command + "\nexec '" HOST_PROGRAM "' \"$@\"\n");
    fs::permissions(place_.path("host"), fs::perms::owner_all);
    return place_.path("host");
  }
  /// LIGGGHTS finds a folder where it is to write its next restart file.
  void put_in_the_way_of_restart_files() const {
    for (int i = 0; i < 10'000; ++i) {
      for (const auto& scratch : fs::directory_iterator(folder())) {
        std::error_code there_is_one_just_now;
        if (fs::exists(scratch.path() / "control") &&  // the driver's socket
            fs::create_directory(scratch.path() / "restart", there_is_one_just_now))
          return;
      }
      ::usleep(200);
    }
    ADD_FAILURE() << "the host's folder was not found";
  }

  const Workplace place_;
  const std::string run_ = place_.path("run");
};

TEST_F(GrainFailure, OfAHostThatHangsIsOneLineAfterItsTimeoutAndTheRunGoesOn) {
  const Outcome outcome = run_tuft(words(run_, {"--set", "infill.dem.answer_timeout=5 s"}),
                                   in_the_middle([](const Processes& run) { ::kill(run.host, SIGSTOP); }));
  ASSERT_TRUE(outcome.struck);
  expect_failed_run(outcome, {"liggghts_host did not answer for 5 s", "hangs"});
  EXPECT_GT(outcome.seconds, 4);
  EXPECT_LT(outcome.seconds, 20);
  expect_no_process_left();
  expect_readable_records();
  expect_to_go_on();
}

TEST_F(GrainFailure, OfLiggghtsInItsSetUpComesWithItsWords) {
  const std::string host = host_after("ln -s /dev/null grains.data");  // no grains for LIGGGHTS to read
  expect_failed_run(run_tuft(words(run_, {"--set", "infill.dem.host=" + host})),
                    {"exit code 1", "ERROR", "Unexpected end of data file"});
  EXPECT_EQ(summary()["status"], "failed");
  expect_no_process_left();
  expect_to_go_on({"--host", HOST_PROGRAM});
}

TEST_F(GrainFailure, OfLiggghtsInTheMiddleComesWithItsWordsAndTheRunGoesOn) {
  const Outcome outcome =
      run_tuft(words(run_), in_the_middle([&](const Processes&) { put_in_the_way_of_restart_files(); }));
  ASSERT_TRUE(outcome.struck);
  expect_failed_run(outcome, {"exit code 1", "ERROR", "Cannot open restart file"});
  expect_no_process_left();
  expect_readable_records();
  expect_to_go_on();
  expect_bits_of_an_unbroken_run();
}

TEST_F(GrainFailure, OfTuftItselfEndsItsHostAndTheRunGoesOnToTheBitsOfAnUnbrokenOne) {
  const Outcome outcome =
      run_tuft(words(run_), in_the_middle([](const Processes& run) { ::kill(run.tuft, SIGKILL); }));
  ASSERT_EQ(outcome.exit_code, 128 + SIGKILL);
  expect_no_process_left();
  EXPECT_FALSE(fs::exists(run_ + "/summary.json"));
  expect_readable_records();
  expect_to_go_on();
  expect_bits_of_an_unbroken_run();
}

TEST_F(GrainFailure, OfBothAtOnceLeavesARunThatGoesOnToTheBitsOfAnUnbrokenOne) {
  const Outcome outcome = run_tuft(words(run_), in_the_middle([](const Processes& run) {
                                     ::kill(run.host, SIGKILL);
                                     ::kill(run.tuft, SIGKILL);
                                   }));
  ASSERT_EQ(outcome.exit_code, 128 + SIGKILL);
  expect_no_process_left();
  expect_readable_records();
  expect_to_go_on();
  expect_bits_of_an_unbroken_run();
}

/// It had stopped well: what it measured stays in its summary and report.
TEST_F(GrainFailure, OfAHostToResumeWithLeavesSummaryAndReportAsTheyWere) {
  ASSERT_EQ(run_tuft(words(run_, {"--stop-after-checkpoints", "1"})).exit_code, 0);
  const std::string kept = read_text(run_ + "/summary.json"), page = read_text(run_ + "/report.html");
  ASSERT_NE(kept.find("\"stopped\""), std::string::npos);
  const auto expect_as_it_was = [&] {
    EXPECT_EQ(read_text(run_ + "/summary.json"), kept);
    EXPECT_EQ(read_text(run_ + "/report.html"), page);
  };
  expect_bad_input(run_tuft({"resume", run_, "--host", "/no/such/host"}),
                   {"/no/such/host", "does not exist"});
  expect_as_it_was();
  const Outcome refused = run_tuft({"resume", run_, "--host", "/bin/false"});
  expect_failed_run(refused, {"liggghts_host ended with exit code 1"});
  EXPECT_NE(read_text(run_ + "/log.txt").find("failed: " + refused.error.substr(13, 40)), std::string::npos);
  expect_as_it_was();
  expect_to_go_on();
}

TEST_F(GrainFailure, OfAHostThatIsNotThereIsBadInputBeforeAnythingIsWritten) {
  place_.write("no_program", "");
  for (const std::string& host : {std::string("/no/such/host"), place_.path("no_program")}) {
    const std::string set = "infill.dem.host=" + host;
    expect_bad_input(run_tuft(words(run_, {"--set", set})), {host});
    EXPECT_FALSE(fs::exists(run_));
    const Outcome checked = run_tuft({"check", "inputs/clegg_small.toml", "--infill", "dem", "--set", set});
    expect_bad_input(checked, {host});
    const Outcome compared = run_tuft({"compare", "inputs/clegg_small.toml", "--set", set, "--out", run_});
    expect_bad_input(compared, {host});
    EXPECT_FALSE(fs::exists(run_));
  }
  EXPECT_EQ(
      run_tuft({"check", "inputs/clegg_small.toml", "--set", "infill.dem.host=/no/such/host"}).exit_code, 0)
      << "a continuum needs no host";
}

}  // namespace
}  // namespace tuft::test

/// Whatever happens to the host or to its driver: one clear line, soon, and nothing left behind.
#include <fcntl.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <memory>

#include "core/error.h"
#include "dem_bridge/message_socket.h"
#include "dem_bridge/scratch_folder.h"
#include "tests/hard_cases/dem_bridge/traces.h"
#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
double thread_seconds() {
  timespec spent{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class HostFailure : public Traces {
 protected:
  void start(double timeout = 20) {
    DemSettings settings = settings_in_box(0.05);
    settings.options.answer_timeout = timeout;
    infill_ = std::make_unique<DemInfill>(block_.grains, block_.materials, settings);
    advance(1);
  }
  void advance(int substeps) {
    infill_->advance(substeps * 1e-6, substeps, no_impulses(block_.grains.size()));
  }
  void TearDown() override {
    infill_.reset();
    Traces::TearDown();
  }
  ShakenBlock block_{4};
  std::unique_ptr<DemInfill> infill_;
};

TEST_F(HostFailure, KilledBetweenWindowsIsAClearErrorWithinASecond) {
  start();
  ::kill(infill_->host_process(), SIGKILL);
  const auto begin = Clock::now();
  const std::string message = message_of<RunError>([&] { advance(1); });
  EXPECT_LT(seconds_since(begin), 1.0);
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("signal 9"), std::string::npos) << message;
  EXPECT_NE(message.find("t = 1e-06 s"), std::string::npos) << message;
  EXPECT_EQ(message_of<RunError>([&] { advance(1); }), message) << "asking again must not hang";
  EXPECT_EQ(message_of<RunError>([&] { (void)infill_->energy(); }), message);
}

TEST_F(HostFailure, KilledInTheMiddleOfAWindowIsAClearErrorWithinASecond) {
  start();
  const int host = infill_->host_process();
  Clock::time_point killed;
  std::thread killer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    killed = Clock::now();
    ::kill(host, SIGKILL);
  });
  const std::string message = message_of<RunError>([&] { advance(50'000'000); });
  killer.join();
  EXPECT_LT(seconds_since(killed), 1.0);
  EXPECT_NE(message.find("signal 9"), std::string::npos) << message;
  EXPECT_TRUE(gone_within(host, 0.1));
}

TEST_F(HostFailure, ThatHangsIsEndedAfterTheTimeout) {
  start(3);
  const int host = infill_->host_process();
  ::kill(host, SIGSTOP);
  const auto begin = Clock::now();
  const std::string message = message_of<RunError>([&] { advance(1); });
  EXPECT_LT(seconds_since(begin), 5.0);
  EXPECT_NE(message.find("did not answer for 3 s"), std::string::npos) << message;
  EXPECT_TRUE(gone_within(host, 1.0));
}

TEST_F(HostFailure, MissingNamesThePathAndWhatToDo) {
  DemSettings settings = settings_in_box(0.05);
  settings.options.host = (folder() / "nowhere" / "liggghts_host").string();
  const std::string message =
      message_of<InputError>([&] { DemInfill infill(block_.grains, block_.materials, settings); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find(settings.options.host), std::string::npos) << message;
  EXPECT_NE(message.find("TUFT_LIGGGHTS_HOST"), std::string::npos) << message;
}

TEST_F(HostFailure, NotExecutableSaysSo) {
  const fs::path program = folder() / "liggghts_host";
  std::fclose(std::fopen(program.c_str(), "w"));
  fs::permissions(program, fs::perms::owner_read);
  DemSettings settings = settings_in_box(0.05);
  settings.options.host = program.string();
  const std::string message =
      message_of<InputError>([&] { DemInfill infill(block_.grains, block_.materials, settings); });
  EXPECT_NE(message.find("not executable"), std::string::npos) << message;
  fs::remove(program);
}

TEST_F(HostFailure, NotAProgramSaysSoAndWhatToDo) {
  const fs::path program = folder() / "liggghts_host";
  std::ofstream(program) << "of another processor\n";
  fs::permissions(program, fs::perms::owner_all);
  DemSettings settings = settings_in_box(0.05);
  settings.options.host = program.string();
  const std::string message =
      message_of<RunError>([&] { DemInfill infill(block_.grains, block_.materials, settings); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find(program.string() + " cannot be started"), std::string::npos) << message;
  EXPECT_NE(message.find("fits this machine"), std::string::npos) << message;
  fs::remove(program);
}

TEST_F(HostFailure, AProgramThatIsNoHostIsReportedWithItsWords) {
  const fs::path program = folder() / "impostor";
  {
    std::ofstream script(program);
    script << "#!/bin/sh\necho 'ERROR: libliggghts.so.3: cannot open shared object file' >&2\nexit 127\n";
  }
  fs::permissions(program, fs::perms::owner_all);
  DemSettings settings = settings_in_box(0.05);
  settings.options.host = program.string();
  const std::string message =
      message_of<RunError>([&] { DemInfill infill(block_.grains, block_.materials, settings); });
  EXPECT_NE(message.find("exit code 127"), std::string::npos) << message;
  EXPECT_NE(message.find("libliggghts.so.3"), std::string::npos) << message;
  fs::remove(program);
}

/// Someone comes to the door and goes without a word while the host, which never connects, is waited for.
TEST_F(HostFailure, ThatDoesNotConnectIsEndedAfterTheTimeoutWhoeverElseComes) {
  const fs::path program = folder() / "impostor";
  std::ofstream(program) << "#!/bin/sh\nexec sleep 8\n";
  fs::permissions(program, fs::perms::owner_all);
  std::atomic<bool> over{false};
  std::atomic<int> visits{0};
  std::thread visitor([&] {
    while (!over) {
      std::error_code ignored;
      for (fs::directory_iterator entry(folder(), ignored), end; entry != end; entry.increment(ignored)) try {
          (void)connect_to(entry->path() / "control");
          ++visits;
        } catch (const std::runtime_error&) {
        }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  DemSettings settings = settings_in_box(0.05);
  settings.options.host = program.string();
  settings.options.answer_timeout = 1.5;
  const auto begin = Clock::now();
  const double spent = thread_seconds();
  const std::string message =
      message_of<RunError>([&] { DemInfill infill(block_.grains, block_.materials, settings); });
  EXPECT_LT(thread_seconds() - spent, 0.5) << "it spins";
  EXPECT_LT(seconds_since(begin), 5.0);
  over = true;
  visitor.join();
  EXPECT_GT(visits, 0);
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("did not connect within 1.5 s"), std::string::npos) << message;
  EXPECT_NE(message.find("infill.dem.answer_timeout"), std::string::npos) << message;
  fs::remove(program);
}

TEST_F(HostFailure, AnErrorOfLiggghtsComesWithItsWords) {
  std::vector<Material> materials{rubber()};
  materials[0].grain->restitution = 0.01;  // LIGGGHTS wants 0.05 to 1
  const std::string message =
      message_of<RunError>([&] { DemInfill infill(block_.grains, materials, settings_in_box(0.05)); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("exit code 1"), std::string::npos) << message;
  EXPECT_NE(message.find("ERROR"), std::string::npos) << message;
  EXPECT_NE(message.find("oefficientRestitution"), std::string::npos) << message;
}

TEST_F(HostFailure, CleanEndLeavesNoProcess) {
  start();
  const int host = infill_->host_process();
  EXPECT_FALSE(process_is_gone(host));
  infill_.reset();
  EXPECT_TRUE(process_is_gone(host));
}

TEST_F(HostFailure, HostIsOutOfReachOfCtrlCAndInheritsNoFiles) {
  const fs::path secret = folder() / "open-file";
  const int descriptor =
      ::open(secret.c_str(), O_RDWR | O_CREAT, 0600);  // without O_CLOEXEC, as libraries do
  start();
  EXPECT_NE(::getpgid(infill_->host_process()), ::getpgrp());
  for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(infill_->host_process()) + "/fd"))
    EXPECT_NE(fs::read_symlink(entry.path()), secret);
  ::close(descriptor);
  fs::remove(secret);
}

/// A child process builds an infill, tells its host's number and is killed.
TEST_F(HostFailure, HostEndsItselfWhenItsDriverIsKilledAndTheNextRunSweepsUp) {
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t driver = ::fork();
  if (driver == 0) {
    start();
    const int host = infill_->host_process();
    if (::write(pipe_ends[1], &host, sizeof host) != sizeof host) ::_exit(1);
    ::raise(SIGKILL);
  }
  int host = 0;
  ASSERT_EQ(::read(pipe_ends[0], &host, sizeof host), static_cast<ssize_t>(sizeof host));
  ::close(pipe_ends[0]);
  ::close(pipe_ends[1]);
  ASSERT_EQ(::waitpid(driver, nullptr, 0), driver);
  EXPECT_TRUE(gone_within(host, 3.0));
  EXPECT_FALSE(fs::is_empty(folder())) << "the killed driver could not clean up: then nothing is tested here";
  { const ScratchFolder next; }
  EXPECT_TRUE(fs::is_empty(folder()));
}

TEST_F(HostFailure, FoldersInUseAreNotSwept) {
  const ScratchFolder first;
  const ScratchFolder second;
  EXPECT_TRUE(fs::exists(first.path()));
  EXPECT_NE(first.path(), second.path());
}

}  // namespace
}  // namespace tuft::dem::test

/// Runs that are killed go on from their checkpoint, and runs beside each other do not meet.
#include <sys/wait.h>

#include <memory>

#include "core/error.h"
#include "dem_bridge/scratch_folder.h"
#include "tests/hard_cases/dem_bridge/traces.h"
#include "tests/verification/dem_bridge/same_run.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;

class KilledRun : public Traces {
 protected:
  void advance(DemInfill& infill, int windows) const {
    const double window = 0.5 * infill.stable_step();
    for (int k = 0; k < windows; ++k) infill.advance(window, 1, block_.confine(infill, window));
  }
  void save(DemInfill& infill) const { save_run(infill, checkpoint()); }
  std::unique_ptr<DemInfill> fresh() const {
    return std::make_unique<DemInfill>(block_.grains, block_.materials, settings_);
  }
  [[nodiscard]] fs::path checkpoint() const { return folder() / "checkpoint.h5"; }

  /// A process of its own makes a run, saves, goes on, and `end` makes its end; what it left is then gone on
  /// with.
  template <class End>
  void expect_resumable_after(End&& end) {
    const pid_t driver = ::fork();
    if (driver == 0) {
      const auto run = fresh();
      block_.shake(*run, 0.5);
      advance(*run, 60);
      save(*run);
      advance(*run, 20);
      end(*run);
      try {
        advance(*run, 1);
      } catch (const RunError&) {
        ::_exit(1);
      }
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(driver, &status, 0), driver);
    ASSERT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 1) << "the run did not fail";

    const auto whole = fresh();
    block_.shake(*whole, 0.5);
    advance(*whole, 60);
    const fs::path left = folder() / "left.h5";
    fs::rename(checkpoint(), left);
    save(*whole);
    fs::remove(checkpoint());
    advance(*whole, 60);
    const auto resumed = fresh();
    resumed->load(h5::File::open(left).root());
    advance(*resumed, 60);
    expect_same_bits(*whole, *resumed);
    fs::remove(left);
  }

  ShakenBlock block_{5};
  DemSettings settings_ = settings_in_box(0.05, Vec3(0, 0, -9.81));
};

TEST_F(KilledRun, GoesOnToTheBitAfterItsHostWasKilled) {
  expect_resumable_after([](DemInfill& run) { ::kill(run.host_process(), SIGKILL); });
}

TEST_F(KilledRun, GoesOnToTheBitAfterItsDriverWasKilled) {
  expect_resumable_after([](DemInfill&) { ::raise(SIGKILL); });
}

TEST_F(KilledRun, GoesOnToTheBitAfterBothWereKilled) {
  expect_resumable_after([](DemInfill& run) {
    ::kill(run.host_process(), SIGKILL);
    ::raise(SIGKILL);
  });
}

TEST_F(KilledRun, LeavesOneBesideItAlone) {
  const auto alone = fresh();
  block_.shake(*alone, 0.5);
  advance(*alone, 60);

  auto killed = fresh();
  const auto survivor = fresh();
  for (DemInfill* run : {killed.get(), survivor.get()}) block_.shake(*run, 0.5);
  for (int k = 0; k < 30; ++k) {
    advance(*killed, 1);
    advance(*survivor, 1);
  }
  ::kill(killed->host_process(), SIGKILL);
  EXPECT_NE(message_of<RunError>([&] { advance(*killed, 1); }), "");
  killed.reset();
  advance(*survivor, 30);
  expect_same_bits(*alone, *survivor);
}

}  // namespace
}  // namespace tuft::dem::test

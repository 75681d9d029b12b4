#include "dem_bridge/host/listen.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "dem_bridge/host_process.h"
#include "dem_bridge/last_words.h"
#include "dem_bridge/scratch_folder.h"

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;

/// How the life of one host went.
struct Life {
  std::string ending;
  std::string words;     ///< the last, ": " before them; may be empty
  bool in_vain = false;  ///< it failed soon after its start, before a driver had come: so may the next
};

/// Waits for the end of a host; false when it has not run for `frozen_after` (s), stopped as a whole: what
/// LIGGGHTS is at does not matter.
bool ended_by_itself(HostProcess& host, const fs::path& folder, double frozen_after) {
  // Looks are counted, not seconds: where the listener has been stopped too, or the machine slept, none is
  // missed. Before the file is there the host is only starting.
  const double pause = std::min(1.0, 0.1 * frozen_after);
  const double most = frozen_after / pause;
  int unchanged = 0;
  fs::file_time_type last{};
  while (!host.wait(pause)) {
    std::error_code none;
    const fs::file_time_type now = fs::last_write_time(folder / alive, none);
    unchanged = none || now != last ? 0 : unchanged + 1;
    last = now;
    if (unchanged > most) return false;
  }
  return true;
}

/// Ends whatever a host has left: its ranks and mpirun end with it by themselves, unless they are frozen.
/// This process is the parent of all whose own has ended (PR_SET_CHILD_SUBREAPER).
void end_orphans() {
  constexpr int looks = 500;
  for (int k = 0; k < looks; ++k) {
    pid_t ended = 0;
    while ((ended = ::waitpid(-1, nullptr, WNOHANG)) > 0) {
    }
    if (ended < 0) return;  // there is none
    std::ifstream orphans("/proc/thread-self/children");
    for (pid_t orphan = 0; orphans >> orphan;) ::kill(orphan, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

Life live(const std::string& program, const std::string& endpoint, double frozen_after) {
  constexpr std::chrono::seconds soon{10};
  const ScratchFolder folder;
  const fs::path log = folder.path() / "host.log";
  const auto start = std::chrono::steady_clock::now();
  HostProcess host({program, "--serve", endpoint, std::to_string(::getpid())}, log, folder.path());
  const bool frozen = !ended_by_itself(host, folder.path(), frozen_after);
  host.kill();
  end_orphans();
  std::error_code ignored;
  if (frozen)
    return {host.ending(), fmt::format(": it had been frozen for {:g} s and was ended", frozen_after),
            !fs::exists(folder.path() / served, ignored)};
  std::ostringstream said;
  said << std::ifstream(log).rdbuf();
  return {host.ending(), (said.str().empty() ? "" : ": ") + telling_line(said.str()),
          host.ending() != "exit code 0" && std::chrono::steady_clock::now() - start < soon &&
              !fs::exists(folder.path() / served, ignored)};
}

}  // namespace

int listen_for_drivers(const std::string& endpoint, bool once, double frozen_after) {
  constexpr int tries = 5;
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  std::cout << "liggghts_host listens at " << endpoint << "; whoever can reach it can run commands as "
            << "this user, so let only trusted machines" << std::endl;
  for (int in_vain = 0;;) {
    const Life life = live(program, endpoint, frozen_after);
    std::cout << "a run's host ended with " << life.ending << life.words << std::endl;
    if (life.ending == "exit code " + std::to_string(cannot_listen)) return EXIT_FAILURE;
    if (once) return life.ending == "exit code 0" ? EXIT_SUCCESS : EXIT_FAILURE;
    in_vain = life.in_vain ? in_vain + 1 : 0;
    if (in_vain == tries)
      throw std::runtime_error(fmt::format(
          "{} hosts in a row at {} ended before a driver came, the last with {}{}; remove the cause "
          "and listen again",
          tries, endpoint, life.ending, life.words));
    if (in_vain > 0) std::this_thread::sleep_for(std::chrono::seconds(1 << (in_vain - 1)));
  }
}

}  // namespace tuft::dem

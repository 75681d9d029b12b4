#include "dem_bridge/host_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string_view>
#include <system_error>

#include "core/error.h"

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;

/// The host's environment: ours, except that its MPI must not take itself for a rank of a job we may run in,
/// needs no daemon, and leaves its files in the scratch folder, which is removed. Its processes yield while
/// they wait for each other: there may be fewer processors than ranks and driver need.
std::vector<std::string> host_environment(const fs::path& scratch, Launch launch) {
  std::vector<std::string> environment;
  for (char** entry = ::environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    bool drop = false;
    for (const char* prefix : {"OMPI_", "PMIX_", "PMI_", "PRTE_", "OMP_NUM_THREADS=", "TMPDIR="})
      drop |= text.starts_with(prefix);
    if (!drop) environment.emplace_back(text);
  }
  environment.insert(environment.end(),
                     {"OMPI_MCA_pml=ob1", "OMPI_MCA_mpi_yield_when_idle=1", "OMPI_MCA_plm_rsh_agent=false",
                      "OMPI_MCA_opal_signal=", "OMP_NUM_THREADS=1", "TMPDIR=" + scratch.string()});
  if (launch == Launch::alone)
    environment.insert(environment.end(), {"OMPI_MCA_ess_singleton_isolated=1", "OMPI_MCA_btl=self"});
  else  // mpirun refuses to run as root unless told twice that it is meant
    environment.insert(environment.end(), {"OMPI_MCA_btl=self,vader", "OMPI_MCA_plm=isolated",
                                           "OMPI_MCA_btl_vader_backing_directory=" + scratch.string(),
                                           "OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"});
  return environment;
}

std::vector<char*> pointers_to(std::vector<std::string>& strings) {
  std::vector<char*> pointers;
  for (std::string& text : strings) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::string describe(const siginfo_t& info) {
  if (info.si_code == CLD_EXITED) return fmt::format("exit code {}", info.si_status);
  return fmt::format("signal {} ({})", info.si_status, ::strsignal(info.si_status));
}

void require_executable(const fs::path& path, std::string_view source) {
  std::error_code failure;
  if (!fs::is_regular_file(path, failure))
    throw_input_error(
        "liggghts_host: {} ({}) does not exist; build the target liggghts_host, or set "
        "TUFT_LIGGGHTS_HOST or infill.dem.host to its path",
        path.string(), source);
  if (::access(path.c_str(), X_OK) != 0)
    throw_input_error("liggghts_host: {} ({}) is not executable: {}; correct its mode or name another path",
                      path.string(), source, std::strerror(errno));
}

}  // namespace

fs::path find_host(const std::string& wanted) {
  if (!wanted.empty()) {
    require_executable(wanted, "infill.dem.host");
    return fs::absolute(wanted);
  }
  const char* given = std::getenv("TUFT_LIGGGHTS_HOST");
  if (given != nullptr && *given != '\0') {
    require_executable(given, "TUFT_LIGGGHTS_HOST");
    return fs::absolute(given);
  }
  std::error_code failure;
  const fs::path folder = fs::read_symlink("/proc/self/exe", failure).parent_path();
  const fs::path beside = folder / "liggghts_host";
  const fs::path in_build_tree = folder.parent_path() / "dem_bridge" / "liggghts_host";
  if (!fs::exists(beside, failure) && fs::exists(in_build_tree, failure)) {
    require_executable(in_build_tree, "build tree");
    return in_build_tree;
  }
  require_executable(beside, "beside the program");
  return beside;
}

fs::path find_mpirun() {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (const fs::path program = fs::path(folder) / "mpirun"; ::access(program.c_str(), X_OK) == 0)
      return fs::absolute(program);
  throw_run_error("infill.dem.ranks above 1: there is no mpirun in PATH; install openmpi-bin, or use 1 rank");
}

HostProcess::HostProcess(std::vector<std::string> command, const fs::path& log, const fs::path& scratch,
                         Launch launch) {
  std::vector<std::string> environment_texts = host_environment(scratch, launch);
  auto argument_pointers = pointers_to(command);
  auto environment_pointers = pointers_to(environment_texts);

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  ::posix_spawn_file_actions_addchdir_np(&actions, scratch.c_str());
  sigset_t none, standard;
  ::sigemptyset(&none);
  ::sigfillset(&standard);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setsigdefault(&attributes, &standard);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  ::posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  pid_t child = -1;
  const int failure = ::posix_spawn(&child, command.front().c_str(), &actions, &attributes,
                                    argument_pointers.data(), environment_pointers.data());
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  if (failure != 0)
    throw_run_error(
        "liggghts_host: {} cannot be started, with its output in {}: {}; see that the program fits this "
        "machine and that limits of processes and memory (ulimit -u, -v) are not reached",
        command.front(), log.string(), std::strerror(failure));
  id_ = child;
  descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, child, 0));
  if (descriptor_ < 0) {
    const int reason = errno;
    kill();
    throw_run_error("liggghts_host: cannot be watched (pidfd_open: {}); Linux 5.3 or newer is needed",
                    std::strerror(reason));
  }
}

HostProcess::~HostProcess() {
  kill();
  if (descriptor_ >= 0) ::close(descriptor_);
}

void HostProcess::reap() {
  siginfo_t info{};
  int result = 0;
  do result = ::waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED);
  while (result != 0 && errno == EINTR);
  ending_ = result == 0 ? describe(info) : "an end nobody saw";
}

bool HostProcess::wait(double seconds) {
  if (!ending_.empty()) return true;
  pollfd watched{descriptor_, POLLIN, 0};
  if (::poll(&watched, 1, static_cast<int>(seconds * 1000)) <= 0) return false;
  reap();
  return true;
}

void HostProcess::kill() {
  if (id_ < 0 || !ending_.empty()) return;
  ::kill(id_, SIGKILL);  // not reaped yet, so the number cannot belong to anyone else
  reap();
}

}  // namespace tuft::dem

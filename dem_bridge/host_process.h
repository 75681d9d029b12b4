#pragma once
/// The child process liggghts_host: found, started, watched, ended. No zombie, no inherited descriptor.
#include <filesystem>
#include <string>
#include <vector>

namespace tuft::dem {

/// Where the host is: `wanted` (the scene's infill.dem.host) if not empty, else the environment's
/// TUFT_LIGGGHTS_HOST, else beside the running program, else ../dem_bridge/ from there (a build tree). Throws
/// InputError naming the path that is missing or not executable, and what to do.
[[nodiscard]] std::filesystem::path find_host(const std::string& wanted);

/// mpirun of Open MPI in PATH. Throws RunError.
[[nodiscard]] std::filesystem::path find_mpirun();

enum class Launch { alone, mpirun };

class HostProcess {
 public:
  /// Starts `command` (a program's path and its arguments) with its output in `log`, in a process group of
  /// its own (Ctrl-C must reach the driver, which then checkpoints, and not the host). `scratch` is its
  /// working and temporary folder. Throws RunError. The thread that starts it should live as long as the
  /// host: the kernel ends the host with it.
  HostProcess(std::vector<std::string> command, const std::filesystem::path& log,
              const std::filesystem::path& scratch, Launch launch = Launch::alone);
  /// Kills it if it still runs; never leaves a zombie.
  ~HostProcess();
  HostProcess(const HostProcess&) = delete;
  HostProcess& operator=(const HostProcess&) = delete;

  [[nodiscard]] int id() const { return id_; }
  /// A descriptor that becomes readable when the process ends.
  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// True when it ended within the time; how is then in `ending()`.
  bool wait(double seconds);
  void kill();
  /// "exit code 1", "signal 9 (Killed)"; empty while it runs.
  [[nodiscard]] const std::string& ending() const { return ending_; }

 private:
  void reap();
  int id_ = -1;
  int descriptor_ = -1;
  std::string ending_;
};

}  // namespace tuft::dem

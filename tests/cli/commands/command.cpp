#include "cli/commands/command.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace tuft::test {
namespace {

[[noreturn]] void become_tuft(const std::vector<std::string>& arguments, const std::string& out,
                              const std::string& error, long largest_file) {
  const int out_file = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int error_file = open(error.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(out_file, STDOUT_FILENO);
  dup2(error_file, STDERR_FILENO);
  if (largest_file > 0) {
    // Ignored, the signal stays ignored in the new program, and a write beyond the limit fails with EFBIG.
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{static_cast<rlim_t>(largest_file), static_cast<rlim_t>(largest_file)};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  std::vector<char*> words{const_cast<char*>(TUFT_PROGRAM)};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  execv(TUFT_PROGRAM, words.data());
  _exit(127);
}

bool has_ended(pid_t process) {
  siginfo_t ended{};
  return waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         ended.si_pid == process;
}

/// The host is the only child of tuft's main thread. False when tuft ends first.
bool strike(pid_t tuft, const Trouble& trouble) {
  const std::string id = std::to_string(tuft);
  while (!has_ended(tuft)) {
    pid_t host = 0;
    if (std::filesystem::exists(trouble.blow_at) &&
        std::ifstream("/proc/" + id + "/task/" + id + "/children") >> host) {
      trouble.blow({tuft, host});
      return true;
    }
    usleep(2'000);
  }
  return false;
}

void expect_one_line(const Outcome& outcome, int exit_code, const std::vector<std::string>& parts) {
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.error;
  EXPECT_EQ(outcome.error.rfind("tuft: error: ", 0), 0u) << outcome.error;
  EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  for (const std::string& part : parts)
    EXPECT_NE(outcome.error.find(part), std::string::npos) << "no '" << part << "' in: " << outcome.error;
}

}  // namespace

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Trouble kill_host_at(const std::string& file) {
  return {.blow_at = file, .blow = [](const Processes& run) { kill(run.host, SIGKILL); }};
}

RunningTuft::RunningTuft(const std::vector<std::string>& arguments, const Trouble& trouble)
    : trouble_(trouble), start_(std::chrono::steady_clock::now()), process_(fork()) {
  if (process_ < 0) throw std::runtime_error("cannot fork");
  if (process_ == 0) become_tuft(arguments, place_.path("out"), place_.path("error"), trouble.largest_file);
}

RunningTuft::~RunningTuft() {
  if (process_ == 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

Outcome RunningTuft::wait() {
  if (trouble_.interrupt_after > 0) {
    usleep(static_cast<useconds_t>(1e6 * trouble_.interrupt_after));
    kill(process_, SIGINT);
  }
  Outcome outcome;
  if (!trouble_.blow_at.empty()) outcome.struck = strike(process_, trouble_);
  if (outcome.struck) start_ = std::chrono::steady_clock::now();
  int status = 0;
  waitpid(process_, &status, 0);
  process_ = 0;
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = read_text(place_.path("out"));
  outcome.error = read_text(place_.path("error"));
  return outcome;
}

Outcome run_tuft(const std::vector<std::string>& arguments, const Trouble& trouble) {
  return RunningTuft(arguments, trouble).wait();
}

void expect_bad_input(const Outcome& outcome, const std::vector<std::string>& parts) {
  expect_one_line(outcome, 2, parts);
}
void expect_failed_run(const Outcome& outcome, const std::vector<std::string>& parts) {
  expect_one_line(outcome, 1, parts);
}

Workplace::Workplace() {
  std::string name = (std::filesystem::temp_directory_path() / "tuft-cli-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder: " + name);
  root_ = name;
}

Workplace::~Workplace() {
  std::error_code ignored;
  std::filesystem::remove_all(root_, ignored);
}

void Workplace::write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories((root_ / name).parent_path());
  std::ofstream(root_ / name) << text;
}

std::vector<std::string> tiny_scene() {
  std::vector<std::string> words{"inputs/clegg_small.toml"};
  for (const char* setting :
       {"scene.duration=1 ms", "infill.sph.pitch=8 mm", "infill.sph.smoothing_length=10.4 mm",
        "effects.fibres=false", "effects.backing=true", "numerics.settle_time=0.4 ms",
        "output.checkpoint_every=0.4 ms", "output.frames=0.2 ms"})
    words.insert(words.end(), {"--set", setting});
  return words;
}

std::vector<std::string> tiny_run(const std::string& folder, const std::vector<std::string>& more) {
  std::vector<std::string> words{"run"};
  const auto scene = tiny_scene();
  words.insert(words.end(), scene.begin(), scene.end());
  words.insert(words.end(), {"--out", folder});
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::vector<std::string> grain_run(const std::string& folder, const std::vector<std::string>& more) {
  std::vector<std::string> words{"--infill", "dem",
                                 "--set",    "infill.dem.material_coarse_graining={ sbr = 7.0, sand = 9.0 }",
                                 "--set",    "infill.dem.use_cache=false",
                                 "--set",    "infill.dem.settle_time=1 ms"};
  words.insert(words.end(), more.begin(), more.end());
  return tiny_run(folder, words);
}

}  // namespace tuft::test

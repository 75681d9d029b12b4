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

/// The host is the only child of tuft's main thread. Gives up when tuft ends first.
void kill_host_of(pid_t tuft, const std::string& at) {
  for (int i = 0; i < 6000; ++i) {
    if (std::filesystem::exists(at)) {
      const std::string id = std::to_string(tuft);
      pid_t host = 0;
      std::ifstream("/proc/" + id + "/task/" + id + "/children") >> host;
      if (host > 0) {
        kill(host, SIGKILL);
        return;
      }
    }
    siginfo_t ended{};
    if (waitid(P_PID, static_cast<id_t>(tuft), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
        ended.si_pid == tuft)
      return;
    usleep(10'000);
  }
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

Outcome run_tuft(const std::vector<std::string>& arguments, const Trouble& trouble) {
  const Workplace place;
  const std::string out = place.path("out"), error = place.path("error");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) become_tuft(arguments, out, error, trouble.largest_file);
  if (trouble.interrupt_after > 0) {
    usleep(static_cast<useconds_t>(1e6 * trouble.interrupt_after));
    kill(child, SIGINT);
  }
  if (!trouble.kill_host_at.empty()) kill_host_of(child, trouble.kill_host_at);
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read_text(out), read_text(error)};
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

}  // namespace tuft::test

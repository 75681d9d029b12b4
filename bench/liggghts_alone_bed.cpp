#include "bench/liggghts_alone_bed.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "dem_bridge/liggghts_script.h"

namespace tuft::bench {
namespace {

namespace fs = std::filesystem;

/// As the bridge sets grains up, but for what ties them to it.
std::string commands_for(const dem::Grains& grains, const Material& material,
                         const dem::DemSettings& settings, const std::string& source, double half_width,
                         double step) {
  // Type 2 is the walls: the same stuff.
  const auto [smallest, largest] = std::minmax_element(grains.radius.begin(), grains.radius.end());
  std::istringstream of_bridge(dem::set_up_commands(source, {0, 1}, {material, material}, settings,
                                                    {grains.size(), *smallest, *largest}, step));
  std::ostringstream text;
  text.precision(17);
  for (std::string line; std::getline(of_bridge, line);)
    if (!line.starts_with("fix coupling")) text << line << '\n';
  text << "fix integrate all nve/sphere\nfix weight all gravity " << settings.gravity.norm()
       << " vector 0 0 -1\n";
  const auto wall = [&](const char* name, const char* plane, double at) {
    text << "fix " << name << " all wall/gran model hertz tangential history primitive type 2 " << plane
         << ' ' << at << '\n';
  };
  wall("floor", "zplane", 0);
  wall("x_low", "xplane", -half_width);
  wall("x_high", "xplane", half_width);
  wall("y_low", "yplane", -half_width);
  wall("y_high", "yplane", half_width);
  return text.str();
}

}  // namespace

LiggghtsAloneBed::LiggghtsAloneBed(const dem::Grains& grains, const Material& material,
                                   const dem::DemSettings& settings, double half_width, double step) {
  std::string name = (fs::temp_directory_path() / "liggghts-alone-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for LIGGGHTS alone: " + name);
  folder_ = name;
  const std::vector<std::uint8_t> data = dem::data_file(grains, {0, 1}, dem::host_domain(settings));
  std::ofstream(folder_ + "/grains.data", std::ios::binary)
      .write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));

  std::array<int, 2> to_program{}, from_program{};
  if (::pipe2(to_program.data(), O_CLOEXEC) != 0 || ::pipe2(from_program.data(), O_CLOEXEC) != 0)
    throw std::runtime_error("no pipe to LIGGGHTS alone");
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, to_program[0], STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, from_program[1], STDOUT_FILENO);
  std::string program = LIGGGHTS_ALONE;
  std::array<char*, 2> arguments{program.data(), nullptr};
  const int failed = ::posix_spawn(&process_, program.c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(to_program[0]);
  ::close(from_program[1]);
  if (failed != 0) throw std::runtime_error("cannot start " + program);
  commands_ = ::fdopen(to_program[1], "w");
  answers_ = ::fdopen(from_program[0], "r");

  std::istringstream lines(
      commands_for(grains, material, settings, "read_data " + folder_ + "/grains.data", half_width, step));
  for (std::string line; std::getline(lines, line);) command(line);
  command("run 0 post no");
}

LiggghtsAloneBed::~LiggghtsAloneBed() {
  std::fclose(commands_);  // its input ends, and so does it
  std::fclose(answers_);
  ::waitpid(process_, nullptr, 0);
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Seconds LiggghtsAloneBed::command(const std::string& line) {
  Seconds taken;
  std::fprintf(commands_, "%s\n", line.c_str());
  std::fflush(commands_);
  if (std::fscanf(answers_, "%lf %lf", &taken.wall, &taken.processor) != 2)
    throw std::runtime_error("LIGGGHTS alone has ended at: " + line);
  return taken;
}

Seconds LiggghtsAloneBed::advance(int steps) {
  return command("run " + std::to_string(steps) + " pre no post no");
}

void LiggghtsAloneBed::settle(int steps, double rate) {
  command("fix drag all viscous " + std::to_string(rate));
  command("run " + std::to_string(steps) + " post no");
  command("unfix drag");
  command("run 0 post no");
}

}  // namespace tuft::bench

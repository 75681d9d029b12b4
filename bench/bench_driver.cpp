/// Runs the benchmark programs (all files named *_bench in a folder) and the small drops, prints the figures
/// and writes them as {name: {"value", "unit", "threads"}}.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/benchmark_figures.h"
#include "bench/child_program.h"
#include "bench/drop_figures.h"

namespace {

using tuft::bench::Figures;
namespace fs = std::filesystem;

/// A folder of our own that goes away with the program.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "tuft_bench_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder " + name);
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void run_benchmark(const fs::path& program, const std::vector<std::string>& options, const fs::path& log) {
  std::vector<std::string> command{program.string()};
  command.insert(command.end(), options.begin(), options.end());
  if (const int code = tuft::bench::run_program(command, log); code != 0)
    throw std::runtime_error(fmt::format("{} ended with code {}", program.string(), code));
}

/// Of its benchmarks' names, what comes before the first slash: each a bed or the like of its own.
std::set<std::string> subjects_of(const fs::path& program, const fs::path& log) {
  run_benchmark(program, {"--benchmark_list_tests=true"}, log);
  std::set<std::string> subjects;
  std::ifstream file(log);
  for (std::string line; std::getline(file, line);)
    if (line.find('/') != std::string::npos) subjects.insert(line.substr(0, line.find('/')));
  return subjects;
}

/// Every subject in a process of its own: behind others in one process large beds of SPH are a tenth slower.
Figures measure_program(const fs::path& program, const fs::path& scratch) {
  const std::string name = program.filename().string();
  const fs::path report = scratch / (name + ".json"), log = scratch / (name + ".log");
  Figures figures;
  for (const std::string& subject : subjects_of(program, log)) {
    run_benchmark(program,
                  {"--benchmark_filter=^" + subject + "(/|$)", "--benchmark_out=" + report.string(),
                   "--benchmark_out_format=json", "--benchmark_repetitions=3"},
                  log);
    std::ifstream file(report);
    figures.merge(tuft::bench::figures_of_benchmark(nlohmann::json::parse(file)));
  }
  return figures;
}

void print(const Figures& figures) {
  for (const auto& [name, figure] : figures)
    fmt::print("{:<28} {:>12.4g} {}\n", name, figure.value, figure.unit);
  std::fflush(stdout);
}

void write_json(const Figures& figures, const fs::path& path) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, figure] : figures) {
    json[name] = {{"value", figure.value}, {"unit", figure.unit}, {"threads", figure.threads}};
  }
  std::ofstream file(path);
  file << json.dump(2) << '\n';
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

std::vector<fs::path> benchmark_programs(const fs::path& folder) {
  std::vector<fs::path> programs;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().filename().string().ends_with("_bench"))
      programs.push_back(entry.path());
  }
  std::sort(programs.begin(), programs.end());
  return programs;
}

struct Request {
  fs::path programs, json;
  tuft::bench::DropRequest drops;
};

Figures measure(Request request) {
  const ScratchFolder scratch;
  Figures all;
  const auto add = [&all](Figures figures) {
    print(figures);
    all.merge(figures);
  };
  if (!request.programs.empty()) {
    for (const fs::path& program : benchmark_programs(request.programs))
      add(measure_program(program, scratch.path()));
  }
  if (!request.drops.scene.empty()) {
    request.drops.folder = scratch.path();
    add(tuft::bench::figures_of_drops(request.drops));
  }
  return all;
}

/// A benchmark that was not built or has lost its name must not go unnoticed.
void check_complete(const Figures& figures) {
  std::vector<std::string> missing;
  for (const std::string& name : tuft::bench::benchmark_figure_names()) {
    if (!figures.contains(name)) missing.push_back(name);
  }
  if (!missing.empty())
    throw std::runtime_error(fmt::format("no program measures {}", fmt::join(missing, ", ")));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("measures the speed of tuft");
  Request request;
  app.add_option("--programs", request.programs, "folder of Google Benchmark programs named *_bench")
      ->check(CLI::ExistingDirectory);
  CLI::Option* tuft =
      app.add_option("--tuft", request.drops.program, "the built tuft")->check(CLI::ExistingFile);
  app.add_option("--scene", request.drops.scene, "scene of the drops; without it no drops")
      ->check(CLI::ExistingFile)
      ->needs(tuft);
  app.add_option("--drops", request.drops.repetitions, "drops of each kind, the fastest counts")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--json", request.json, "file to write");
  CLI11_PARSE(app, argc, argv);
  try {
    const Figures figures = measure(request);
    if (!request.json.empty()) write_json(figures, request.json);
    if (!request.programs.empty()) check_complete(figures);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench: {}\n", error.what());
    return 1;
  }
  return 0;
}

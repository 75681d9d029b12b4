#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <nlohmann/json.hpp>

#include "app/calibration_page.h"
#include "app/calibration_summary.h"
#include "app/number_format.h"
#include "app/stop_signal.h"
#include "app/verbs.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/scene_files.h"
#include "rigs/run_folder.h"

namespace tuft::app {
namespace {

namespace fs = std::filesystem;

struct CalibrateArguments {
  std::string file, folder;
  int threads = -1;
};

/// A folder of the same calibration is gone on with; one of anything else is not touched.
void prepare_folder(const fs::path& folder, const studies::Problem& problem) {
  std::error_code error;
  const fs::path mark = folder / "calibration.json";
  if (!fs::exists(mark, error)) {
    rigs::check_run_folder(folder);
  } else {
    const auto json = nlohmann::json::parse(read_text_file(mark), nullptr, false);
    if (json.is_discarded() || json.value("problem", "") != problem.fingerprint)
      throw_input_error(
          "{}: holds another calibration (other models, materials, targets or start); choose another --out "
          "or "
          "remove it",
          folder.string());
  }
  fs::create_directories(folder / "materials", error);
  if (error)
    throw_input_error("{}: cannot be created: {}; choose another --out", folder.string(), error.message());
}

void write_results(const fs::path& folder, const studies::Problem& problem,
                   const studies::CalibrationResult& result) {
  const std::string remark = "calibrated: tuft calibrate " + problem.file.file;
  const auto texts = problem.texts(result.fitted.values, remark);
  for (std::size_t m = 0; m < texts.size(); ++m)
    rigs::write_text_file(folder / "materials" / (problem.materials[m].name + ".toml"), texts[m]);
  rigs::write_text_file(folder / "calibration.json", calibration_json(problem, result));
  rigs::write_text_file(folder / "report.html", calibration_page(problem, result));
}

/// A line every two seconds, so that a log of the terminal stays short.
auto progress_lines() {
  using Clock = std::chrono::steady_clock;
  return [last = Clock::now()](std::size_t evaluations, double least) mutable {
    if (Clock::now() - last < std::chrono::seconds(2)) return;
    last = Clock::now();
    fmt::print("evaluation {}, least misfit {}\n", evaluations, format_significant(least));
    std::fflush(stdout);
  };
}

int calibrate(const CalibrateArguments& arguments) {
  if (arguments.threads > 0) set_threads(arguments.threads);
  const studies::Problem problem = studies::make_problem(read_calibration(arguments.file));
  const fs::path folder =
      arguments.folder.empty() ? fs::path("out") / problem.file.name : fs::path(arguments.folder);
  prepare_folder(folder, problem);
  rigs::write_text_file(folder / "calibration.json", calibration_mark(problem));
  rigs::write_text_file(folder / "calibration.toml", read_text_file(arguments.file));
  studies::EvaluationLog log(folder / "evaluations.csv", problem);
  if (log.found_before() > 0)
    fmt::print("{}: {} evaluations of an earlier run are taken as they are\n", folder.string(),
               log.found_before());

  const std::atomic<bool>& stop = catch_stop_signals();
  studies::CalibrationRequest request;
  request.problem = &problem;
  request.log = &log;
  request.stop = &stop;
  request.on_progress = progress_lines();
  const studies::CalibrationResult result = studies::calibrate(request);
  write_results(folder, problem, result);

  fmt::print("{}\n{}\n{} evaluations, {} of them failed, in {}: {}\nreport: {}\n",
             calibration_tables(problem, result), verdict(problem, result), result.evaluations, result.failed,
             format_duration(result.wall_seconds), result.end_reason, (folder / "report.html").string());
  if (result.status == "completed") return 0;
  fmt::print("stopped; the best so far is written. Go on by the same command\n");
  return 1;
}

}  // namespace

void register_calibrate(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand(
      "calibrate",
      "Fit numbers of materials so that tests come out as targets say; Ctrl-C stops with the best");
  auto arguments = std::make_shared<CalibrateArguments>();
  verb->add_option("CALIBRATION", arguments->file,
                   "calibration file (TOML), e.g. inputs/calibrations/sbr.toml")
      ->required();
  verb->add_option("--out", arguments->folder,
                   "folder for the results, or of an earlier run to go on with (default: out/NAME)")
      ->type_name("DIR");
  verb->add_option("--threads", arguments->threads, "number of threads; 0: all cores")
      ->check(CLI::NonNegativeNumber);
  verb->callback([arguments, &action] { action = [arguments] { return calibrate(*arguments); }; });
}

}  // namespace tuft::app

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "app/report_data.h"
#include "app/summary_table.h"
#include "app/verbs.h"

namespace tuft::app {
namespace {

struct ShowArguments {
  std::string folder;
  bool json = false;
};

/// One run: its summary.json. A comparison: an object with one of them by approach.
std::string as_json(const std::vector<rigs::RunSummary>& summaries) {
  if (summaries.size() == 1) return rigs::summary_json(summaries.front());
  nlohmann::ordered_json all;
  for (const rigs::RunSummary& summary : summaries)
    all[summary.approach] = nlohmann::ordered_json::parse(rigs::summary_json(summary));
  return all.dump(2) + "\n";
}

int show(const ShowArguments& arguments) {
  std::vector<rigs::RunSummary> summaries;
  for (const std::filesystem::path& folder : expand_run_folders({arguments.folder}))
    summaries.push_back(rigs::read_summary(folder));
  if (arguments.json) {
    fmt::print("{}", as_json(summaries));
    return 0;
  }
  fmt::print("{}\n{}", summaries.front().scene_name, summary_table(summaries));
  for (const rigs::RunSummary& summary : summaries)
    if (!summary.error.empty()) fmt::print("  {}: {}\n", summary.approach, summary.error);
  return 0;
}

}  // namespace

void register_show(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("show", "The summary of a run or a comparison");
  auto arguments = std::make_shared<ShowArguments>();
  verb->add_option("DIR", arguments->folder, "folder of a run, or of a comparison")->required();
  verb->add_flag("--json", arguments->json, "as JSON");
  verb->callback([arguments, &action] { action = [arguments] { return show(*arguments); }; });
}

}  // namespace tuft::app

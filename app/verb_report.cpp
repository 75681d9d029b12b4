#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/report.h"
#include "app/verbs.h"

namespace tuft::app {
namespace {

struct ReportArguments {
  std::vector<std::string> folders;
  std::string out;
};

int report(const ReportArguments& arguments) {
  const std::vector<std::filesystem::path> folders(arguments.folders.begin(), arguments.folders.end());
  std::filesystem::path file = arguments.out.empty() ? folders.front() : std::filesystem::path(arguments.out);
  if (file.extension() != ".html") file /= "report.html";
  write_report(folders, file);
  fmt::print("report: {}\n", file.string());
  return 0;
}

}  // namespace

void register_report(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand("report", "One self-contained HTML page from one or more runs");
  auto arguments = std::make_shared<ReportArguments>();
  verb->add_option("DIR", arguments->folders, "folders of runs, or of a comparison")->required();
  verb->add_option("--out", arguments->out,
                   "file (.html) or folder for the page (default: in the first folder)");
  verb->callback([arguments, &action] { action = [arguments] { return report(*arguments); }; });
}

}  // namespace tuft::app

#include <fmt/format.h>

#include <map>
#include <set>

#include "app/html.h"
#include "app/report.h"
#include "app/report_sections.h"
#include "rigs/run_folder.h"

namespace tuft::app {
namespace {

/// Adds to labels that are shared what `told_apart` gives of their runs, where that differs.
template <class ToldApart>
void tell_apart(std::vector<RunData>& runs, ToldApart&& told_apart) {
  std::map<std::string, std::set<std::string>> found;
  std::map<std::string, int> count;
  for (const RunData& run : runs) {
    found[run.label].insert(told_apart(run));
    ++count[run.label];
  }
  for (RunData& run : runs)
    if (const std::string own = run.label; count[own] > 1 && found[own].size() > 1)
      run.label += " · " + told_apart(run);
}

/// "SPH" stays "SPH" unless two runs share it; then the folder's name tells them apart. Tests of one material
/// are told apart by approach first.
void make_labels_unique(std::vector<RunData>& runs) {
  tell_apart(runs,
             [](const RunData& run) { return std::string(run.summary.approach == "dem" ? "DEM" : "SPH"); });
  tell_apart(runs, [](const RunData& run) {
    const std::filesystem::path name = run.folder.has_filename() ? run.folder : run.folder.parent_path();
    const bool member = name.filename() == "sph" || name.filename() == "dem";
    return (member ? name.parent_path().filename() : name.filename()).string();
  });
}

std::string body_of(const Runs& runs) {
  if (all_of_components(runs)) return report_tension(runs) + report_cost(runs) + report_tension_inputs(runs);
  if (all_of_specimens(runs))
    return report_specimen(runs) + report_remarks(runs) + report_cost(runs) + report_effects(runs) +
           report_specimen_inputs(runs);
  return report_results(runs) + report_remarks(runs) + report_curves(runs) + report_sections(runs) +
         report_energy(runs) + report_cost(runs) + report_effects(runs) + report_inputs(runs);
}

}  // namespace

std::string run_style(const Runs& runs, std::size_t index) {
  bool pair = runs.size() <= 2;
  if (runs.size() == 2) pair = runs[0].summary.approach != runs[1].summary.approach;
  return fmt::format("c{}", pair ? (runs[index].summary.approach == "dem" ? 1 : 0) : index % 6);
}

double time_origin(const RunData& run) {
  return run.touch_time.value_or(0.0);
}

std::vector<std::string> run_header(const std::string& first, const Runs& runs) {
  std::vector<std::string> header{first};
  for (std::size_t i = 0; i < runs.size(); ++i)
    header.push_back(
        fmt::format("<span class=\"key {}\"></span>{}", run_style(runs, i), escape_html(runs[i].label)));
  return header;
}

std::string report_page(const std::vector<RunData>& runs) {
  const std::string name = runs.empty() ? "no run" : runs.front().summary.scene_name;
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
             "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{} · "
             "tuft</title>\n"
             "<style>{}</style>\n</head>\n<body>\n<main>\n",
             escape_html(name), report_style()) +
         report_head(runs) + body_of(runs) + "</main>\n<script>" + report_script() +
         "</script>\n</body>\n</html>\n";
}

void write_report(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& file) {
  std::vector<RunData> runs;
  for (const std::filesystem::path& folder : expand_run_folders(folders)) runs.push_back(read_run(folder));
  make_labels_unique(runs);
  rigs::write_text_file(file, report_page(runs));
}

}  // namespace tuft::app

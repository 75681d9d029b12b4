#include "app/report_data.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/scene_reader.h"
#include "rigs/clegg.h"
#include "rigs/run_folder.h"

namespace tuft::app {
namespace {

/// All columns cut to the shortest: a kill in the middle of a flush can leave some a row longer. Empty ones
/// are left out: what is computed at the end of a run (filtered signals) is missing in one that was killed.
TimeTable read_time_table(const h5::Group& root, const std::string& name) {
  TimeTable table;
  if (!root.has(name)) return table;
  const h5::Group group = root.open_group(name);
  if (!group.has("time")) return table;
  std::size_t rows = group.shape("time").at(0);
  for (const std::string& member : group.names()) {
    if (group.shape(member).size() != 1) continue;
    std::vector<double> values = group.read_doubles(member);
    if (values.empty() && member != "time") continue;
    rows = std::min(rows, values.size());
    if (member == "time")
      table.time = std::move(values);
    else
      table.columns[member] = std::move(values);
  }
  table.time.resize(rows);
  for (auto& [column, values] : table.columns) values.resize(rows);
  return table;
}

/// As the rig finds it, from the release on.
std::optional<double> find_touch(const TimeTable& history, double touch_force) {
  if (!history.has("contact_force")) return std::nullopt;
  const std::vector<double>& force = history.at("contact_force");
  rigs::TouchClock clock(touch_force);
  const auto released =
      static_cast<std::size_t>(std::ranges::lower_bound(history.time, 0.0) - history.time.begin());
  for (std::size_t i = released; i < force.size(); ++i) clock.sample(force[i]);
  return clock.touched() ? std::optional(history.time[released + clock.touch()]) : std::nullopt;
}

void read_records(RunData& run) {
  const h5::Group root = h5::File::open(run.folder / "run.h5").root();
  if (root.has("scene"))
    run.scene = read_scene_text(root.read_string("scene"), (run.folder / "run.h5").string());
  run.history = read_time_table(root, "history");
  run.energy = read_time_table(root, "energy");
  if (root.has("frames") && root.open_group("frames").has("time"))
    run.frame_times = root.open_group("frames").read_doubles("time");
}

}  // namespace

RunData read_run(const std::filesystem::path& folder) {
  RunData run;
  run.folder = folder;
  run.summary = rigs::read_summary(folder);
  run.label = run.summary.approach;
  std::transform(run.label.begin(), run.label.end(), run.label.begin(),
                 [](char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); });
  std::error_code ignored;
  if (std::filesystem::exists(folder / "run.h5", ignored)) {
    try {
      read_records(run);
    } catch (const RunError& error) {
      // As of a run that died while its file was being made: the report shows the summary, and says so.
      run.unreadable = error.what();
    }
  }
  if (!run.scene && std::filesystem::exists(folder / "scene.toml", ignored))
    run.scene = rigs::read_run_scene(folder);
  if (run.scene) run.touch_time = find_touch(run.history, run.scene->rig.clegg.touch_force);
  // Of a specimen its material tells more than the approach.
  if (run.scene && run.scene->rig.is_specimen())
    run.label = run.scene->materials.at(static_cast<std::size_t>(run.scene->rig.specimen.material)).name;
  return run;
}

std::vector<std::filesystem::path> expand_run_folders(const std::vector<std::filesystem::path>& folders) {
  std::vector<std::filesystem::path> runs;
  std::error_code ignored;
  for (const std::filesystem::path& folder : folders) {
    const bool is_run = std::filesystem::exists(folder / "summary.json", ignored);
    bool expanded = false;
    for (const char* member : {"sph", "dem"}) {
      if (is_run || !std::filesystem::exists(folder / member / "summary.json", ignored)) continue;
      runs.push_back(folder / member);
      expanded = true;
    }
    if (!expanded) runs.push_back(folder);
  }
  return runs;
}

bool has_fibres(const RunData& run) {
  return std::none_of(run.summary.effects.begin(), run.summary.effects.end(),
                      [](const EffectDecision& effect) { return effect.name == "fibres" && !effect.on; });
}

std::optional<double> peak_time(const RunData& run) {
  if (!run.history.has("acceleration_filtered")) return std::nullopt;
  const std::vector<double>& acceleration = run.history.at("acceleration_filtered");
  std::optional<double> at;
  double largest = 0;
  for (std::size_t i = 0; i < acceleration.size(); ++i) {
    if (run.history.time[i] < 0 || acceleration[i] <= largest) continue;
    largest = acceleration[i];
    at = run.history.time[i];
  }
  return at;
}

}  // namespace tuft::app

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/number_format.h"
#include "app/point_page.h"
#include "app/text_table.h"
#include "app/verbs.h"
#include "core/error.h"
#include "rigs/run_folder.h"
#include "sph_infill/path_results.h"

namespace tuft::app {
namespace {

namespace fs = std::filesystem;

struct PointArguments {
  std::string file, out;
  std::vector<std::string> settings;
};

/// Names and units of the columns of path.csv, as they are written below.
constexpr const char* csv_header =
    "segment,time [s],strain_xx [1],strain_yy [1],strain_zz [1],strain_xy [1],strain_yz [1],strain_zx [1],"
    "compression [1],plastic_compression [1],largest_compression [1],lost_strength [1],pressure [Pa],q [Pa],"
    "q_at_yield [Pa],stress_xx [Pa],stress_yy [Pa],stress_zz [Pa],stress_xy [Pa],stress_yz [Pa],stress_zx "
    "[Pa],"
    "bulk_modulus [Pa],work [J/m^3],dissipated [J/m^3],stored [J/m^3]\n";

/// Tensors are positive in extension; compression, pressure and q in compression. As many digits as bring
/// back the same bits.
std::string csv_of(const sph::PathRecord& record) {
  std::string text = csv_header;
  for (const sph::PathRow& r : record.rows) {
    const sph::SymmetricTensor& e = r.strain;
    const sph::SymmetricTensor s = r.stress();
    text += fmt::format("{}", r.segment);
    for (const double value : {r.time,
                               e.xx,
                               e.yy,
                               e.zz,
                               e.xy,
                               e.yz,
                               e.zx,
                               r.state.compression,
                               r.state.plastic_compression,
                               r.state.largest_compression,
                               r.state.lost_strength,
                               r.state.pressure,
                               r.q(),
                               std::sqrt(3.0) * r.yield,
                               s.xx,
                               s.yy,
                               s.zz,
                               s.xy,
                               s.yz,
                               s.zx,
                               r.state.bulk_modulus,
                               r.work,
                               r.dissipated,
                               r.stored})
      text += fmt::format(",{}", value);
    text += '\n';
  }
  return text;
}

nlohmann::json summary_of(const PointRun& run) {
  nlohmann::json results = nlohmann::json::object(), effects = nlohmann::json::object();
  for (const sph::PathResult& result : sph::path_results(run.test, run.record))
    results[result.name] = {{"value", result.value}, {"unit", result.unit}};
  for (const EffectDecision& effect : run.effects)
    effects[effect.name] = {{"on", effect.on}, {"why", effect.why}};
  return {{"status", run.error.empty() ? "completed" : "failed"},
          {"error", run.error},
          {"test", run.test.name},
          {"material", run.test.tested().name},
          {"results", results},
          {"energy_error", energy_gap(run)},
          {"steps", run.record.steps},
          {"wall_s", run.wall_seconds},
          {"effects", effects},
          {"version", TUFT_VERSION}};
}

/// Nothing of another kind of run may be written over; an earlier test of a point may.
void prepare_folder(const fs::path& out) {
  std::error_code error;
  if (!fs::exists(out / "point.toml", error)) rigs::check_run_folder(out);
  fs::create_directories(out, error);
  if (error)
    throw_input_error("{}: cannot be made ({}); choose another --out", out.string(), error.message());
}

/// The measures that the test names; empty where it names none.
std::string measures_table(const PointRun& run) {
  if (run.test.measures.empty()) return "";
  TextTable table({"measure", "value"});
  for (const sph::PathResult& result : sph::path_results(run.test, run.record))
    for (const PointMeasure& measure : run.test.measures)
      if (measure.name == result.name) table.add({result.name, format_quantity(result.value, result.unit)});
  return table.text();
}

std::string ends_table(const PointRun& run) {
  TextTable table({"segment", "compression", "pressure", "q", "stress along z", "shear stress"});
  const auto& rows = run.record.rows;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k + 1 < rows.size() && rows[k + 1].segment == rows[k].segment) continue;
    const sph::PathRow& r = rows[k];
    table.add({r.segment == 0 ? "start" : fmt::format("{}", r.segment), format_percent(r.state.compression),
               format_quantity(r.state.pressure, "Pa"), format_quantity(r.q(), "Pa"),
               format_quantity(-r.stress().zz, "Pa"), format_quantity(sph::shear_stress(run.test, r), "Pa")});
  }
  return table.text();
}

int point(const PointArguments& arguments) {
  PointRun run;
  run.test = read_point_test(arguments.file, parse_settings(arguments.settings));
  run.effects = decide_effects(run.test);
  run.law = sph::law_of(run.test, run.effects);
  const fs::path out = arguments.out.empty() ? fs::path("out") / run.test.name : fs::path(arguments.out);
  prepare_folder(out);
  rigs::write_text_file(out / "point.toml", write_point_test(run.test));

  const auto start = std::chrono::steady_clock::now();
  try {
    sph::run_strain_path(run.law, run.test, run.record);
  } catch (const RunError& error) {
    run.error = error.what();
  }
  run.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  rigs::write_text_file(out / "path.csv", csv_of(run.record));
  rigs::write_text_file(out / "summary.json", summary_of(run).dump(2) + "\n");
  rigs::write_text_file(out / "report.html", point_page(run));
  if (!run.error.empty()) throw RunError(run.error);
  fmt::print("{}{}report: {}\n", ends_table(run), measures_table(run), (out / "report.html").string());
  return 0;
}

}  // namespace

void register_point(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand(
      "point", "One point of a material along a path of strain and stress: table, summary and page");
  auto arguments = std::make_shared<PointArguments>();
  verb->add_option("TEST", arguments->file, "test file (TOML), e.g. inputs/point_sand.toml")->required();
  verb->add_option("--out", arguments->out, "folder for the results (default: out/NAME)");
  verb->add_option("--set", arguments->settings, "override a key of the test, e.g. point.step=1e-5")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  verb->callback([arguments, &action] { action = [arguments] { return point(*arguments); }; });
}

}  // namespace tuft::app

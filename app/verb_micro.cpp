#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <optional>

#include "app/number_format.h"
#include "app/report_data.h"
#include "app/text_table.h"
#include "app/verbs.h"
#include "core/error.h"
#include "coupler/micro_reader.h"
#include "micro_scale/field_comparison.h"
#include "micro_scale/network_statistics.h"

namespace tuft::app {
namespace {

struct MicroArguments {
  std::string folder, csv;
  int frame = -1;
};

/// One run at one of its frames.
struct Look {
  std::string name;
  h5::Group root;
  std::size_t frame = 0;
  std::optional<ContactNetwork> network;
  std::optional<coupler::RecordedFields> fields;
};

Look look_at(const std::filesystem::path& folder, int frame) {
  if (!std::filesystem::exists(folder / "run.h5"))
    throw_input_error("{}: not the folder of a run: it holds no run.h5; give a folder that `tuft run` wrote",
                      folder.string());
  const h5::Group root = h5::File::open(folder / "run.h5").root();
  const std::size_t frames = coupler::micro_frames(root);
  if (frames == 0)
    throw_input_error(
        "{}: this run recorded neither contacts nor fields; run its scene with --set "
        "output.micro.contacts=true, "
        "or with --set output.micro.fields=true",
        folder.string());
  if (frame >= static_cast<int>(frames))
    throw_input_error("{}: there is no frame {}; the last is {}", folder.string(), frame, frames - 1);
  Look look{
      root.attribute("approach"), root, frame < 0 ? frames - 1 : static_cast<std::size_t>(frame), {}, {}};
  if (coupler::has_contacts(root)) look.network = coupler::read_contacts(root, look.frame);
  if (coupler::has_fields(root)) look.fields = coupler::read_fields(root, look.frame);
  return look;
}

std::string number(double value) {
  return fmt::format("{:.4g}", value);
}

/// Of SPH, whose particles have no contacts with each other, the numbers of contacts alone.
void print_statistics(const Look& look) {
  TextTable table;
  const auto& kinds = look.network->kind;
  const bool between_particles = std::find(kinds.begin(), kinds.end(), ContactKind::grain) != kinds.end();
  for (const micro::NamedValue& value :
       micro::named_values(micro::describe_network(*look.network, coupler::particle_count(look.root))))
    if (between_particles || value.name.starts_with("contacts_"))
      table.add({value.name, number(value.value), value.unit == "1" ? "" : value.unit});
  fmt::print("\ncontacts\n{}", table.text());
  if (!between_particles) return;
  constexpr double width = 0.5;
  const std::vector<double> density = micro::force_distribution(*look.network, 12, width);
  TextTable distribution({"normal force over mean", "probability density"});
  for (std::size_t bin = 0; bin < density.size(); ++bin)
    distribution.add({fmt::format("{:.1f} to {:.1f}", width * static_cast<double>(bin),
                                  width * static_cast<double>(bin + 1)),
                      number(density[bin])});
  fmt::print("\nforces between particles\n{}", distribution.text());
}

void print_profile(const Look& look) {
  const auto& [grid, width, values] = *look.fields;
  const auto column = [&](const char* field, std::size_t components, std::size_t component) {
    return micro::profile(grid, values.at(field), components, component);
  };
  const std::vector<double> density = column("density", 1, 0), speed = column("velocity", 3, 2),
                            vertical = column("stress", 9, 8), along = column("stress", 9, 0);
  const bool knows_porosity = values.contains("porosity");
  const std::vector<double> porosity = knows_porosity ? column("porosity", 1, 0) : std::vector<double>{};
  TextTable table(
      {"height mm", "density kg/m^3", "porosity", "velocity z m/s", "stress zz Pa", "stress xx Pa"});
  for (std::size_t k = density.size(); k-- > 0;)
    table.add({fmt::format("{:.1f}", 1e3 * grid.centre(0, 0, static_cast<int>(k)).z()), number(density[k]),
               knows_porosity ? number(porosity[k]) : "-", number(speed[k]), number(vertical[k]),
               number(along[k])});
  fmt::print("\nfields by height, means over the patch (coarse-graining width {:.1f} mm)\n{}", 1e3 * width,
             table.text());
}

/// Cell by cell, where both have infill.
void print_comparison(const Look& a, const Look& b) {
  const auto &one = *a.fields, &two = *b.fields;
  if (one.grid.cells != two.grid.cells || one.grid.low != two.grid.low ||
      one.grid.spacing != two.grid.spacing)
    throw_input_error("the two runs have different grids and cannot be compared cell by cell");
  constexpr double least_filled = 0.1;
  const std::vector<char> taken =
      micro::filled_in_both(one.values.at("density"), two.values.at("density"), least_filled);
  struct Row {
    const char *title, *field;
    std::size_t components, component;
  };
  constexpr Row rows[] = {{"density kg/m^3", "density", 1, 0},  {"porosity", "porosity", 1, 0},
                          {"velocity z m/s", "velocity", 3, 2}, {"stress xx Pa", "stress", 9, 0},
                          {"stress yy Pa", "stress", 9, 4},     {"stress zz Pa", "stress", 9, 8},
                          {"stress xz Pa", "stress", 9, 2}};
  TextTable table({"field", "mean " + a.name, "mean " + b.name, "rms difference", "relative", "correlation"});
  std::size_t cells = 0;
  for (const Row& row : rows) {
    if (!one.values.contains(row.field) || !two.values.contains(row.field)) continue;
    const auto pick = [&](const coupler::RecordedFields& fields) {
      const std::vector<double>& all = fields.values.at(row.field);
      std::vector<double> picked;
      for (std::size_t c = row.component; c < all.size(); c += row.components) picked.push_back(all[c]);
      return picked;
    };
    const micro::FieldComparison result = micro::compare_fields(pick(one), pick(two), taken);
    cells = result.cells;
    table.add({row.title, number(result.mean_a), number(result.mean_b), number(result.difference),
               number(result.relative), number(result.correlation)});
  }
  fmt::print("\ncell by cell, over the {} cells in which both have infill\n{}", cells, table.text());
}

void write_csv(const std::string& path, const ContactNetwork& network) {
  std::ofstream file(path, std::ios::trunc);
  file << "kind,particle,other,branch_x_m,branch_y_m,branch_z_m,normal_x_N,normal_y_N,normal_z_N,tangential_"
          "x_N,"
          "tangential_y_N,tangential_z_N,overlap_m\n";
  constexpr const char* kinds[] = {"grain", "backing", "fibre", "body"};
  for (std::size_t c = 0; c < network.size(); ++c) {
    const Vec3 b = network.branch[c], n = network.normal_force[c], t = network.tangential_force[c];
    file << fmt::format("{},{},{},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g}\n",
                        kinds[static_cast<std::size_t>(network.kind[c])], network.particle[c],
                        network.other[c], b.x(), b.y(), b.z(), n.x(), n.y(), n.z(), t.x(), t.y(), t.z(),
                        network.overlap[c]);
  }
  file.close();
  if (!file) throw_run_error("{}: cannot be written", path);
}

int micro_scale(const MicroArguments& arguments) {
  std::vector<Look> looks;
  for (const std::filesystem::path& folder : expand_run_folders({arguments.folder}))
    looks.push_back(look_at(folder, arguments.frame));
  if (!arguments.csv.empty()) {
    if (looks.size() != 1 || !looks[0].network)
      throw_input_error("--csv wants the folder of one run that recorded its contacts");
    write_csv(arguments.csv, *looks[0].network);
  }
  for (const Look& look : looks) {
    fmt::print("{}, frame {} at {:.3f} ms\n", look.name, look.frame,
               1e3 * coupler::frame_time(look.root, look.frame));
    if (look.network) print_statistics(look);
    if (look.fields) print_profile(look);
    fmt::print("\n");
  }
  if (looks.size() == 2 && looks[0].fields && looks[1].fields) print_comparison(looks[0], looks[1]);
  return 0;
}

}  // namespace

void register_micro(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand(
      "micro", "Contacts and coarse-grained fields of a run, or of both of a comparison");
  auto arguments = std::make_shared<MicroArguments>();
  verb->add_option("DIR", arguments->folder, "folder of a run, or of a comparison")->required();
  verb->add_option("--frame", arguments->frame, "which frame, from 0; the last if left out")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--csv", arguments->csv, "also write the frame's contacts to this file, one a row");
  verb->callback([arguments, &action] { action = [arguments] { return micro_scale(*arguments); }; });
}

}  // namespace tuft::app

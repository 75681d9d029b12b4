#include "app/micro_tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/number_format.h"
#include "app/text_table.h"
#include "core/error.h"
#include "micro_scale/field_comparison.h"
#include "micro_scale/network_statistics.h"

namespace tuft::app {
namespace {

std::string number(double value) {
  return fmt::format("{:.4g}", value);
}

/// Of SPH, whose particles have no contacts with each other, the numbers of contacts alone.
void print_statistics(const MicroMoment& moment) {
  TextTable table;
  const auto& kinds = moment.network->kind;
  const bool between_particles = std::find(kinds.begin(), kinds.end(), ContactKind::grain) != kinds.end();
  for (const micro::NamedValue& value :
       micro::named_values(micro::describe_network(*moment.network, coupler::particle_count(moment.root))))
    if (between_particles || value.name.starts_with("contacts_"))
      table.add({value.name, number(value.value), value.unit == "1" ? "" : value.unit});
  if (between_particles)
    table.add({"spin_rms", number(coupler::spin_rms(moment.root, moment.frame)), "rad/s"});
  fmt::print("\ncontacts\n{}", table.text());
  if (!between_particles) return;
  const micro::ForceBins bins;
  const std::vector<double> density = micro::force_distribution(*moment.network, bins);
  TextTable distribution({"normal force over mean", "probability density"});
  for (std::size_t bin = 0; bin < density.size(); ++bin)
    distribution.add({fmt::format("{:.1f} to {:.1f}", bins.width * static_cast<double>(bin),
                                  bins.width * static_cast<double>(bin + 1)),
                      number(density[bin])});
  fmt::print("\nforces between particles\n{}", distribution.text());
}

void print_profile(const MicroMoment& moment) {
  const auto& [grid, width, mass_outside, values] = *moment.fields;
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
  double mass = 0;
  for (const double of_cell : values.at("density")) mass += of_cell * grid.cell_volume();
  fmt::print(
      "\nfields by height, means over the patch (coarse-graining width {:.1f} mm)\n{}"
      "  {} x {} x {} cells hold {:.5g} kg of infill; {:.5g} kg lie beyond them\n",
      1e3 * width, table.text(), grid.cells[0], grid.cells[1], grid.cells[2], mass, mass_outside);
}

}  // namespace

void print_moment(const MicroMoment& moment) {
  fmt::print("{}, {} at {:.3f} ms\n", moment.name, moment.source,
             1e3 * coupler::frame_time(moment.root, moment.frame));
  if (moment.network) print_statistics(moment);
  if (moment.fields) print_profile(moment);
  fmt::print("\n");
}

void print_field_comparison(const MicroMoment& a, const MicroMoment& b) {
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

}  // namespace tuft::app

#include "app/summary_table.h"

#include <functional>
#include <set>

#include "app/number_format.h"
#include "app/text_table.h"

namespace tuft::app {
namespace {

using Summaries = std::vector<rigs::RunSummary>;

void add_row(TextTable& table, const Summaries& summaries, const std::string& name,
             const std::function<std::string(const rigs::RunSummary&)>& text) {
  std::vector<std::string> row{name};
  for (const rigs::RunSummary& summary : summaries) row.push_back(text(summary));
  table.add(std::move(row));
}

void add_results(TextTable& table, const Summaries& summaries) {
  for (const std::string& name : result_names(summaries)) {
    add_row(table, summaries, readable_name(name), [&](const rigs::RunSummary& summary) -> std::string {
      const auto found = summary.results.find(name);
      return found == summary.results.end() ? not_available
                                            : format_quantity(found->second.value, found->second.unit);
    });
  }
}

void add_phases(TextTable& table, const Summaries& summaries) {
  std::set<std::string> phases;
  for (const rigs::RunSummary& summary : summaries)
    for (const auto& [phase, seconds] : summary.cost)
      if (seconds > 0) phases.insert(phase);
  for (const std::string& phase : phases) {
    add_row(table, summaries, "  " + phase, [&](const rigs::RunSummary& summary) {
      const auto found = summary.cost.find(phase);
      return format_duration(found == summary.cost.end() ? 0 : found->second);
    });
  }
}

}  // namespace

std::vector<std::string> result_names(const Summaries& summaries) {
  std::vector<std::string> order{"peak_g", "time_of_peak", "rebound_velocity", "max_penetration"};
  std::set<std::string> present;
  for (const rigs::RunSummary& summary : summaries)
    for (const auto& [name, quantity] : summary.results) present.insert(name);
  std::erase_if(order, [&](const std::string& name) { return present.erase(name) == 0; });
  order.insert(order.end(), present.begin(), present.end());
  return order;
}

std::string summary_table(const Summaries& summaries) {
  using Summary = rigs::RunSummary;
  std::vector<std::string> header{""};
  for (const Summary& summary : summaries) header.push_back(upper_case(summary.approach));
  TextTable table(header);
  add_row(table, summaries, "Status", [](const Summary& s) { return s.status; });
  add_row(table, summaries, "Simulated",
          [](const Summary& s) { return format_quantity(s.simulated_time, "s"); });
  add_results(table, summaries);
  add_row(table, summaries, "Energy error", [](const Summary& s) { return format_percent(s.energy_error); });
  add_row(table, summaries, "Momentum error",
          [](const Summary& s) { return format_significant(s.momentum_error, 2); });
  add_row(table, summaries, "Particles", [](const Summary& s) { return format_count(s.particles); });
  add_row(table, summaries, "Shell elements", [](const Summary& s) { return format_count(s.shells); });
  add_row(table, summaries, "Particle-steps",
          [](const Summary& s) { return format_rate(s.particle_steps_per_s); });
  add_row(table, summaries, "Element-steps",
          [](const Summary& s) { return format_rate(s.element_steps_per_s); });
  add_row(table, summaries, "Peak memory",
          [](const Summary& s) { return format_bytes(s.peak_memory_bytes); });
  add_row(table, summaries, "Wall time", [](const Summary& s) { return format_duration(s.wall_s); });
  add_phases(table, summaries);
  return table.text();
}

}  // namespace tuft::app

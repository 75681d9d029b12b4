#include "bench/benchmark_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace tuft::bench {
namespace {

/// Noise only ever slows a loop down, so the largest rate is the truest. A share is a difference of two
/// timings, which noise moves either way: there the median is.
enum class Pick { largest, median };

struct Definition {
  std::string_view name, unit, counter;
  Pick pick;
};

constexpr std::array definitions{
    Definition{"shell_one_point_elastic", "element-steps/s", "element_steps", Pick::largest},
    Definition{"shell_one_point_3pt", "element-steps/s", "element_steps", Pick::largest},
    Definition{"shell_full_elastic", "element-steps/s", "element_steps", Pick::largest},
    Definition{"shell_full_prony_3pt", "element-steps/s", "element_steps", Pick::largest},
    Definition{"shell_full_prony_3pt_erosion", "element-steps/s", "element_steps", Pick::largest},
    Definition{"machine_memory", "bytes/s", "bytes", Pick::largest},
    Definition{"machine_memory_32mb", "bytes/s", "bytes", Pick::largest},
    Definition{"machine_arithmetic", "operations/s", "flops", Pick::largest},
    Definition{"sph_paper", "particle-steps/s", "particle_steps", Pick::largest},
    Definition{"sph_paper_20k", "particle-steps/s", "particle_steps", Pick::largest},
    Definition{"sph_paper_2m", "particle-steps/s", "particle_steps", Pick::largest},
    Definition{"sph_accurate", "particle-steps/s", "particle_steps", Pick::largest},
    Definition{"sph_accurate_20k", "particle-steps/s", "particle_steps", Pick::largest},
    Definition{"sph_accurate_2m", "particle-steps/s", "particle_steps", Pick::largest},
    Definition{"soil_law", "point-updates/s", "point_updates", Pick::largest},
    Definition{"soil_density_hardening", "point-updates/s", "point_updates", Pick::largest},
    Definition{"soil_strength_softening", "point-updates/s", "point_updates", Pick::largest},
    Definition{"soil_strength_recovery", "point-updates/s", "point_updates", Pick::largest},
    Definition{"soil_strength_rate", "point-updates/s", "point_updates", Pick::largest},
    Definition{"soil_inertial_friction", "point-updates/s", "point_updates", Pick::largest},
    Definition{"soil_dilation", "point-updates/s", "point_updates", Pick::largest},
    Definition{"soil_shear_energy", "point-updates/s", "point_updates", Pick::largest},
    Definition{"soil_all_effects", "point-updates/s", "point_updates", Pick::largest},
    Definition{"bridge_overhead_20k", "share of the DEM step", "share", Pick::median},
    Definition{"bridge_tcp_20k", "times the step with shared memory", "ratio", Pick::median},
    Definition{"bridge_overhead_100k", "share of the DEM step", "share", Pick::median},
};

const Definition* find_definition(std::string_view name) {
  for (const Definition& definition : definitions) {
    if (definition.name == name) return &definition;
  }
  return nullptr;
}

struct Name {
  std::string figure;
  int threads = 0;
};

/// "sph_paper/2/iterations:20/real_time" -> {"sph_paper", 2}; nothing where no thread count follows the name.
std::optional<Name> parse_name(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  Name name{std::string(text.substr(0, slash))};
  const std::string_view rest = text.substr(slash + 1);
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), name.threads);
  const bool whole = end == rest.data() + rest.size() || *end == '/';
  if (error != std::errc() || !whole || name.threads < 1) return std::nullopt;
  return name;
}

double value_of(const nlohmann::json& entry, const Definition& definition) {
  const std::string name = entry.at("name");
  if (entry.value("error_occurred", false)) {
    throw std::runtime_error(fmt::format("{}: {}", name, entry.value("error_message", "failed")));
  }
  const auto found = entry.find(definition.counter);
  if (found == entry.end() || !found->is_number() || !std::isfinite(found->get<double>())) {
    throw std::runtime_error(fmt::format("{} reports no {}", name, definition.counter));
  }
  return found->get<double>();
}

/// values: at least one.
double pick(Pick which, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  if (which == Pick::largest) return values.back();
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace

Figures figures_of_benchmark(const nlohmann::json& report) {
  struct Measured {
    const Definition* definition;
    int threads;
    std::vector<double> values;
  };
  std::map<std::string, Measured> measured;
  for (const nlohmann::json& entry : report.at("benchmarks")) {
    if (entry.value("run_type", "iteration") != "iteration") continue;  // means and medians of repetitions
    const std::optional<Name> name = parse_name(entry.at("name").get<std::string>());
    const Definition* definition = name ? find_definition(name->figure) : nullptr;
    if (definition == nullptr) continue;
    const std::string key = fmt::format("{}/{}", name->figure, name->threads);
    const auto place = measured.try_emplace(key, Measured{definition, name->threads, {}}).first;
    place->second.values.push_back(value_of(entry, *definition));
  }
  Figures figures;
  for (auto& [key, m] : measured)
    figures[key] = {pick(m.definition->pick, std::move(m.values)), std::string(m.definition->unit),
                    m.threads};
  return figures;
}

std::vector<std::string> benchmark_figure_names() {
  std::vector<std::string> names;
  for (const Definition& definition : definitions) {
    for (const int threads : {1, 2}) names.push_back(fmt::format("{}/{}", definition.name, threads));
  }
  return names;
}

}  // namespace tuft::bench

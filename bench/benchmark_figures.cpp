#include "bench/benchmark_figures.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace tuft::bench {
namespace {

enum class Best { largest, smallest };

struct Definition {
  std::string_view name, unit, counter;
  Best best;
};

constexpr std::array definitions{
    Definition{"shell_one_point_elastic", "element-steps/s", "element_steps", Best::largest},
    Definition{"shell_one_point_3pt", "element-steps/s", "element_steps", Best::largest},
    Definition{"sph_paper", "particle-steps/s", "particle_steps", Best::largest},
    Definition{"sph_accurate", "particle-steps/s", "particle_steps", Best::largest},
    Definition{"bridge_overhead_20k", "share of the DEM step", "share", Best::smallest},
    Definition{"bridge_overhead_100k", "share of the DEM step", "share", Best::smallest},
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

}  // namespace

Figures figures_of_benchmark(const nlohmann::json& report) {
  Figures figures;
  for (const nlohmann::json& entry : report.at("benchmarks")) {
    if (entry.value("run_type", "iteration") != "iteration") continue;  // means and medians of repetitions
    const std::optional<Name> name = parse_name(entry.at("name").get<std::string>());
    const Definition* definition = name ? find_definition(name->figure) : nullptr;
    if (definition == nullptr) continue;

    const double value = value_of(entry, *definition);
    const std::string key = fmt::format("{}/{}", name->figure, name->threads);
    const auto [place, is_new] =
        figures.try_emplace(key, Figure{value, std::string(definition->unit), name->threads});
    const bool better =
        definition->best == Best::largest ? value > place->second.value : value < place->second.value;
    if (!is_new && better) place->second.value = value;
  }
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

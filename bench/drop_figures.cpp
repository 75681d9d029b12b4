#include "bench/drop_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>

#include "bench/child_program.h"

namespace tuft::bench {
namespace {

double sum_of(const nlohmann::json& cost, std::initializer_list<const char*> phases) {
  double sum = 0;
  for (const char* phase : phases) sum += cost.value(phase, 0.0);
  return sum;
}

nlohmann::json run_drop(const DropRequest& request, const std::string& infill, int threads) {
  const std::filesystem::path folder = request.folder / fmt::format("{}_{}", infill, threads);
  const std::filesystem::path log = request.folder / fmt::format("{}_{}.log", infill, threads);
  std::filesystem::remove_all(folder);
  const int code = run_program({request.program, "run", request.scene, "--infill", infill, "--threads",
                                std::to_string(threads), "--out", folder},
                               log);
  if (code != 0) {
    std::ifstream text(log);
    const std::string words((std::istreambuf_iterator<char>(text)), std::istreambuf_iterator<char>());
    throw std::runtime_error(fmt::format("the {} drop on {} thread(s) ended with code {}:\n{}", infill,
                                         threads, code,
                                         words.substr(words.size() > 2000 ? words.size() - 2000 : 0)));
  }
  std::ifstream file(folder / "summary.json");
  nlohmann::json summary = nlohmann::json::parse(file);
  if (summary.at("status") != "completed")
    throw std::runtime_error(folder.string() + ": the drop did not complete");
  return summary;
}

nlohmann::json fastest_drop(const DropRequest& request, const std::string& infill, int threads) {
  nlohmann::json best;
  for (int i = 0; i < request.repetitions; ++i) {
    nlohmann::json summary = run_drop(request, infill, threads);
    if (best.is_null() || summary.at("wall_s") < best.at("wall_s")) best = std::move(summary);
  }
  return best;
}

}  // namespace

double coupling_share(const nlohmann::json& cost) {
  const double coupling = sum_of(cost, {"search", "contact", "exchange", "waiting"});
  const double steps = coupling + sum_of(cost, {"carpet", "infill", "rig", "ledger", "record"});
  if (!(steps > 0)) throw std::runtime_error("summary.json holds no cost of the steps");
  return coupling / steps;
}

Figures figures_of_drops(const DropRequest& request) {
  Figures figures;
  for (const int threads : {1, 2}) {
    std::array<double, 2> shares{};
    const std::array<std::string, 2> infills{"sph", "dem"};
    for (std::size_t i = 0; i < infills.size(); ++i) {
      const nlohmann::json summary = fastest_drop(request, infills[i], threads);
      shares[i] = coupling_share(summary.at("cost"));
      const std::string drop = fmt::format("clegg_small_{}", infills[i]);
      figures[fmt::format("{}_wall/{}", drop, threads)] = {summary.at("wall_s"), "s", threads};
      figures[fmt::format("coupled_contact_share_{}/{}", infills[i], threads)] = {
          shares[i], "share of the step", threads};
    }
    figures[fmt::format("coupled_contact_share/{}", threads)] = {
        std::max(shares[0], shares[1]), "share of the step, the larger of SPH and DEM", threads};
  }
  return figures;
}

}  // namespace tuft::bench

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "rigs/run.h"

namespace tuft::rigs {
namespace {

using Json = nlohmann::ordered_json;

/// JSON knows no NaN or infinity. They are written as null, and null is read back as NaN, so that a value
/// that was never measured cannot turn into a plausible number on the way.
Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

double number_of(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Json json_quantities(const std::map<std::string, Quantity>& quantities) {
  Json object = Json::object();
  for (const auto& [name, quantity] : quantities)
    object[name] = {{"value", json_number(quantity.value)}, {"unit", quantity.unit}};
  return object;
}

std::map<std::string, Quantity> quantities_of(const Json& object) {
  std::map<std::string, Quantity> quantities;
  for (const auto& [name, entry] : object.items())
    quantities[name] = {number_of(entry.at("value")), entry.at("unit").get<std::string>()};
  return quantities;
}

RunSummary summary_of(const Json& json) {
  RunSummary summary;
  summary.status = json.at("status").get<std::string>();
  summary.error = json.at("error").get<std::string>();
  summary.scene_name = json.at("scene_name").get<std::string>();
  summary.rig = json.at("rig").get<std::string>();
  summary.approach = json.at("approach").get<std::string>();
  summary.version = json.at("version").get<std::string>();
  summary.results = quantities_of(json.at("results"));
  summary.energy_error = number_of(json.at("energy_error"));
  summary.momentum_error = number_of(json.at("momentum_error"));
  summary.simulated_time = number_of(json.at("simulated_time"));
  summary.steps = json.at("steps").get<std::uint64_t>();
  summary.wall_s = number_of(json.at("wall_s"));
  for (const auto& [phase, seconds] : json.at("cost").items()) summary.cost[phase] = number_of(seconds);
  summary.particles = json.at("particles").get<std::uint64_t>();
  summary.shells = json.at("shells").get<std::uint64_t>();
  summary.particle_steps_per_s = number_of(json.at("particle_steps_per_s"));
  summary.element_steps_per_s = number_of(json.at("element_steps_per_s"));
  summary.peak_memory_bytes = json.at("peak_memory_bytes").get<std::uint64_t>();
  for (const auto& [name, effect] : json.at("effects").items())
    summary.effects.push_back({name, effect.at("on").get<bool>(), effect.at("why").get<std::string>()});
  summary.notes = quantities_of(json.at("notes"));
  if (json.contains("remarks")) summary.remarks = json.at("remarks").get<std::vector<std::string>>();
  return summary;
}

/// The whole text reaches the disk before the name does: a kill at any moment leaves the old summary or the
/// new one.
void write_atomically(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::path temporary = path;
  temporary += ".part";
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) throw_run_error("{}: cannot be written: {}", path.string(), std::strerror(errno));
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = ::write(file, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    written += static_cast<std::size_t>(count);
  }
  const bool whole = written == text.size() && ::fsync(file) == 0;
  const int reason = errno;
  ::close(file);
  if (!whole) {
    ::unlink(temporary.c_str());
    throw_run_error("{}: cannot be written: {}", path.string(), std::strerror(reason));
  }
  std::error_code failure;
  std::filesystem::rename(temporary, path, failure);
  if (failure) throw_run_error("{}: cannot be written: {}", path.string(), failure.message());
}

}  // namespace

std::string summary_json(const RunSummary& summary) {
  Json json;
  json["status"] = summary.status;
  json["error"] = summary.error;
  json["scene_name"] = summary.scene_name;
  json["rig"] = summary.rig;
  json["approach"] = summary.approach;
  json["results"] = json_quantities(summary.results);
  json["energy_error"] = json_number(summary.energy_error);
  json["momentum_error"] = json_number(summary.momentum_error);
  json["simulated_time"] = json_number(summary.simulated_time);
  json["steps"] = summary.steps;
  json["wall_s"] = json_number(summary.wall_s);
  json["cost"] = Json::object();
  for (const auto& [phase, seconds] : summary.cost) json["cost"][phase] = json_number(seconds);
  json["particles"] = summary.particles;
  json["shells"] = summary.shells;
  json["particle_steps_per_s"] = json_number(summary.particle_steps_per_s);
  json["element_steps_per_s"] = json_number(summary.element_steps_per_s);
  json["peak_memory_bytes"] = summary.peak_memory_bytes;
  json["effects"] = Json::object();
  for (const EffectDecision& effect : summary.effects)
    json["effects"][effect.name] = {{"on", effect.on}, {"why", effect.why}};
  json["notes"] = json_quantities(summary.notes);
  json["remarks"] = summary.remarks;
  json["version"] = summary.version;
  // Error texts of other programs may hold bytes that are not UTF-8; they are replaced, never thrown on.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_summary(const std::filesystem::path& folder, const RunSummary& summary) {
  write_atomically(folder / "summary.json", summary_json(summary));
}

RunSummary read_summary(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "summary.json";
  std::ifstream file(path);
  if (!file) {
    throw_input_error(
        "{}: not the folder of a run: it holds no summary.json; give a folder that `tuft run` wrote",
        folder.string());
  }
  std::ostringstream text;
  text << file.rdbuf();
  try {
    return summary_of(Json::parse(text.str()));
  } catch (const nlohmann::json::exception& failure) {
    throw_input_error("{}: not a run's summary: {}; run the scene again", path.string(), failure.what());
  }
}

}  // namespace tuft::rigs

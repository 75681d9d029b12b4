#include "coupler/packing_cache.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/scene_reader.h"

namespace tuft::coupler {
namespace {

constexpr const char* packing_version = "packing 9";  // raise when packing or settling changes its results

/// Only what the packing depends on: a change of rig or output must not repeat it.
std::string packing_key(const Scene& scene, const std::vector<EffectDecision>& effects,
                        std::string_view surroundings) {
  Scene bare = scene;
  bare.file.clear();
  bare.info = {"packing", 1};
  bare.rig = {};
  bare.effects = {};
  bare.conditioning = {};
  bare.output = {};
  bare.infill.sph = {};
  bare.infill.sph.smoothing_length = 1;
  bare.infill.approach = Approach::dem;
  bare.infill.dem.host.clear();
  bare.infill.dem.ranks = DemOptions{}.ranks;
  bare.infill.dem.overlap_limit = DemOptions{}.overlap_limit;
  bare.infill.dem.use_cache = true;
  bare.infill.dem.answer_timeout = DemOptions{}.answer_timeout;
  const Numerics defaults;
  bare.numerics = defaults;
  bare.numerics.seed = scene.numerics.seed;
  bare.numerics.step_safety = scene.numerics.step_safety;
  std::string text = std::string(packing_version) + "\n" + write_scene(bare);
  for (const char* name : {"fibres", "backing", "friction_rate", "rolling_resistance", "grain_cohesion",
                           "clumps", "contact_damping"})
    text += std::string(name) + (effect_on(effects, name) ? " on\n" : " off\n");
  text += surroundings;
  return content_hash(text);
}

/// $TUFT_CACHE, else $XDG_CACHE_HOME/tuft, else ~/.cache/tuft; empty when there is no home.
std::filesystem::path cache_folder() {
  if (const char* own = std::getenv("TUFT_CACHE"); own != nullptr && *own != '\0') return own;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg != '\0')
    return std::filesystem::path(xdg) / "tuft";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache" / "tuft";
  return {};
}

template <class Value>
void append_bytes(std::string& bytes, const std::vector<Value>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

}  // namespace

std::string fingerprint(const fe::ShellMesh& mesh) {
  std::string bytes;
  append_bytes(bytes, mesh.nodes.x);
  append_bytes(bytes, mesh.nodes.y);
  append_bytes(bytes, mesh.nodes.z);
  append_bytes(bytes, mesh.quads);
  append_bytes(bytes, mesh.thickness);
  append_bytes(bytes, mesh.material);
  append_bytes(bytes, mesh.surface);
  append_bytes(bytes, mesh.clamped);
  append_bytes(bytes, mesh.constraints);
  return content_hash(bytes);
}

PackingCache::PackingCache(const Scene& scene, const std::vector<EffectDecision>& effects,
                           std::string_view surroundings)
    : layers_(scene.turf.layers.size()) {
  for (const Material& material : scene.materials) grain_kinds_.push_back(material.grain.has_value());
  const std::filesystem::path folder = cache_folder();
  if (scene.infill.dem.use_cache && !folder.empty())
    path_ = folder / ("packing-" + packing_key(scene, effects, surroundings) + ".h5");
}

Packing PackingCache::read() const {
  const h5::File file = h5::File::open(path_);
  const h5::Group root = file.root();
  const auto numbers = [&](const char* name, std::size_t count, double least) {
    std::vector<double> values = root.read_doubles(name);
    if (values.size() != count)
      throw_run_error("{} holds {} values instead of {}", name, values.size(), count);
    for (const double value : values)
      if (!std::isfinite(value) || value < least) throw_run_error("{} holds {:g}", name, value);
    return values;
  };
  const auto indices = [&](const char* name, std::size_t count, std::int32_t least, std::size_t end) {
    const std::vector<double> values = numbers(name, count, least);
    for (const double value : values)
      if (!(value < static_cast<double>(end)) || value != std::floor(value))
        throw_run_error("{} holds {:g}", name, value);
    return std::vector<std::int32_t>(values.begin(), values.end());
  };
  constexpr double positive = std::numeric_limits<double>::min(), any = std::numeric_limits<double>::lowest();
  Packing packing;
  dem::Grains& grains = packing.grains;
  const std::size_t count = root.read_doubles("radius").size();
  if (count == 0) throw_run_error("it holds not a single grain");
  grains.position = {numbers("x", count, any), numbers("y", count, any), numbers("z", count, any)};
  grains.radius = numbers("radius", count, positive);
  grains.density = numbers("density", count, positive);
  grains.layer = indices("layer", count, 0, std::max<std::size_t>(1, layers_));
  grains.material = indices("material", count, 0, grain_kinds_.size());
  for (const std::int32_t material : grains.material)
    if (grain_kinds_[static_cast<std::size_t>(material)] == 0)
      throw_run_error("material holds {}, which is no grain's", material);
  if (root.has("body")) grains.body = indices("body", count, -1, count);
  fe::CarpetShape& carpet = packing.carpet;
  const std::size_t nodes = root.read_doubles("carpet_x").size();
  carpet.position = {numbers("carpet_x", nodes, any), numbers("carpet_y", nodes, any),
                     numbers("carpet_z", nodes, any)};
  carpet.element_state = numbers("carpet_elements", root.read_doubles("carpet_elements").size(), any);
  carpet.strain = numbers("carpet_strain", 1, any).front();
  carpet.hourglass = numbers("carpet_hourglass", 1, any).front();
  packing.report = packing_report_of(numbers("report", numbers_of(PackingReport{}).size(), any));
  return packing;
}

bool PackingCache::load(Packing& packing, const std::function<void(const Packing&)>& check) const {
  std::error_code ignored;
  if (path_.empty() || !std::filesystem::exists(path_, ignored)) return false;
  try {
    Packing kept = read();
    check(kept);
    packing = std::move(kept);
    return true;
  } catch (const std::exception& error) {  // whatever a damaged file brings about: it is packed anew
    const std::string file = path_.string(), why = error.what();
    packing.report.cache_trouble = fmt::format(
        "{}{}: the packing kept there is damaged or of another carpet, and grains were packed anew",
        why.starts_with(file) ? "" : file + ": ", why);
    return false;
  }
}

void PackingCache::store(const Packing& packing) const {
  if (path_.empty()) return;
  try {
    std::filesystem::create_directories(path_.parent_path());
    h5::File file = h5::File::create_atomically(path_);
    h5::Group root = file.root();
    const dem::Grains& grains = packing.grains;
    root.write("x", std::span<const double>(grains.position.x));
    root.write("y", std::span<const double>(grains.position.y));
    root.write("z", std::span<const double>(grains.position.z));
    root.write("radius", std::span<const double>(grains.radius));
    root.write("density", std::span<const double>(grains.density));
    root.write("layer", std::span<const std::int32_t>(grains.layer));
    root.write("material", std::span<const std::int32_t>(grains.material));
    if (!grains.body.empty()) root.write("body", std::span<const std::int32_t>(grains.body));
    const fe::CarpetShape& carpet = packing.carpet;
    root.write("carpet_x", std::span<const double>(carpet.position.x));
    root.write("carpet_y", std::span<const double>(carpet.position.y));
    root.write("carpet_z", std::span<const double>(carpet.position.z));
    root.write("carpet_elements", std::span<const double>(carpet.element_state));
    root.write_scalar("carpet_strain", carpet.strain);
    root.write_scalar("carpet_hourglass", carpet.hourglass);
    root.write("report", std::span<const double>(numbers_of(packing.report)));
    file.commit();
  } catch (const std::exception&) {
    // The run does not need the cache: a full or read-only home must not stop it.
  }
}

Scene packing_scene(const Scene& scene) {
  Scene still = scene;
  still.numerics = Numerics{};
  still.numerics.seed = scene.numerics.seed;
  still.numerics.step_safety = scene.numerics.step_safety;
  still.numerics.energy_error_limit = std::numeric_limits<double>::infinity();
  still.infill.dem.overlap_limit = 0;
  still.conditioning = {};
  return still;
}

Vec3Array positions(const Infill& infill) {
  const ParticleView particles = infill.particles();
  return {{particles.x.begin(), particles.x.end()},
          {particles.y.begin(), particles.y.end()},
          {particles.z.begin(), particles.z.end()}};
}

}  // namespace tuft::coupler

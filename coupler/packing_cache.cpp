#include "coupler/packing_cache.h"

#include <cstdlib>
#include <string>

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

/// Arrays of one length each; what the carpet needs is seen when it takes the shape.
bool is_whole(const Packing& packing) {
  const dem::Grains& grains = packing.grains;
  const std::size_t count = grains.radius.size(), nodes = packing.carpet.position.x.size();
  const auto of_all = [&](std::size_t length) { return length == count; };
  return count > 0 && of_all(grains.position.x.size()) && of_all(grains.position.y.size()) &&
         of_all(grains.position.z.size()) && of_all(grains.density.size()) && of_all(grains.layer.size()) &&
         of_all(grains.material.size()) && (grains.body.empty() || of_all(grains.body.size())) &&
         packing.carpet.position.y.size() == nodes && packing.carpet.position.z.size() == nodes;
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
                           std::string_view surroundings) {
  const std::filesystem::path folder = cache_folder();
  if (scene.infill.dem.use_cache && !folder.empty())
    path_ = folder / ("packing-" + packing_key(scene, effects, surroundings) + ".h5");
}

bool PackingCache::load(Packing& packing) const {
  if (path_.empty() || !std::filesystem::exists(path_)) return false;
  try {
    const h5::File file = h5::File::open(path_);
    const h5::Group root = file.root();
    dem::Grains& grains = packing.grains;
    grains.position = {root.read_doubles("x"), root.read_doubles("y"), root.read_doubles("z")};
    grains.radius = root.read_doubles("radius");
    grains.density = root.read_doubles("density");
    grains.layer = root.read_ints("layer");
    grains.material = root.read_ints("material");
    if (root.has("body")) grains.body = root.read_ints("body");
    fe::CarpetShape& carpet = packing.carpet;
    carpet.position = {root.read_doubles("carpet_x"), root.read_doubles("carpet_y"),
                       root.read_doubles("carpet_z")};
    carpet.element_state = root.read_doubles("carpet_elements");
    carpet.strain = root.read_double("carpet_strain");
    carpet.hourglass = root.read_double("carpet_hourglass");
    const std::vector<double> report = root.read_doubles("report");
    if (report.size() != numbers_of(PackingReport{}).size()) return false;
    packing.report = packing_report_of(report);
    return is_whole(packing);
  } catch (const RunError&) {
    return false;  // a cache that cannot be read is a cache that is not there
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

Vec3Array positions(const Infill& infill) {
  const ParticleView particles = infill.particles();
  return {{particles.x.begin(), particles.x.end()},
          {particles.y.begin(), particles.y.end()},
          {particles.z.begin(), particles.z.end()}};
}

}  // namespace tuft::coupler

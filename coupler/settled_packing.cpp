#include "coupler/settled_packing.h"

#include <cstdlib>
#include <filesystem>
#include <limits>

#include "core/error.h"
#include "core/scene_reader.h"
#include "coupler/build_simulation.h"

namespace tuft::coupler {
namespace {

constexpr const char* packing_version = "packing 3";  // raise when packing or settling changes its results

/// $TUFT_CACHE, else $XDG_CACHE_HOME/tuft, else ~/.cache/tuft; empty when there is no home.
std::filesystem::path cache_folder() {
  if (const char* own = std::getenv("TUFT_CACHE"); own != nullptr && *own != '\0') return own;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg != '\0')
    return std::filesystem::path(xdg) / "tuft";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache" / "tuft";
  return {};
}

/// Only what the packing depends on: a change of rig or output must not repeat it.
std::string packing_key(const Scene& scene, const std::vector<EffectDecision>& effects) {
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
  bare.infill.dem.use_cache = true;
  bare.infill.dem.answer_timeout = DemOptions{}.answer_timeout;
  const Numerics defaults;
  bare.numerics = defaults;
  bare.numerics.seed = scene.numerics.seed;
  bare.numerics.step_safety = scene.numerics.step_safety;
  std::string text = std::string(packing_version) + "\n" + write_scene(bare);
  for (const char* name :
       {"fibres", "friction_rate", "rolling_resistance", "grain_cohesion", "contact_damping"})
    text += std::string(name) + (effect_on(effects, name) ? " on\n" : " off\n");
  return content_hash(text);
}

bool load_cached(const std::filesystem::path& path, dem::Grains& grains) {
  if (!std::filesystem::exists(path)) return false;
  try {
    const h5::File file = h5::File::open(path);
    const h5::Group root = file.root();
    grains.position = {root.read_doubles("x"), root.read_doubles("y"), root.read_doubles("z")};
    grains.radius = root.read_doubles("radius");
    grains.density = root.read_doubles("density");
    grains.layer = root.read_ints("layer");
    grains.material = root.read_ints("material");
    return grains.position.x.size() == grains.radius.size() && grains.material.size() == grains.radius.size();
  } catch (const RunError&) {
    return false;  // a cache that cannot be read is a cache that is not there
  }
}

void store(const std::filesystem::path& path, const dem::Grains& grains) {
  try {
    std::filesystem::create_directories(path.parent_path());
    h5::File file = h5::File::create_atomically(path);
    h5::Group root = file.root();
    root.write("x", std::span<const double>(grains.position.x));
    root.write("y", std::span<const double>(grains.position.y));
    root.write("z", std::span<const double>(grains.position.z));
    root.write("radius", std::span<const double>(grains.radius));
    root.write("density", std::span<const double>(grains.density));
    root.write("layer", std::span<const std::int32_t>(grains.layer));
    root.write("material", std::span<const std::int32_t>(grains.material));
    file.commit();
  } catch (const std::exception&) {
    // The run does not need the cache: a full or read-only home must not stop it.
  }
}

std::vector<dem::ThinQuad> obstacles(const fe::ShellMesh& mesh) {
  std::vector<dem::ThinQuad> quads;
  quads.reserve(mesh.quads.size());
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    dem::ThinQuad quad;
    for (int c = 0; c < 4; ++c) quad.corner[c] = mesh.nodes[mesh.quads[e][c]];
    quad.half_thickness = 0.5 * mesh.thickness[e];
    quads.push_back(quad);
  }
  return quads;
}

struct SettleStage {
  double share;         ///< of the settle time
  double damping;       ///< 1/s
  double acceleration;  ///< downwards, in g
};
constexpr SettleStage settle_stages[] = {{1.5 / 10.5, 4000, 1}, {6.0 / 10.5, 300, 5}, {3.0 / 10.5, 300, 1}};

}  // namespace

dem::Grains settle_grains(const Scene& scene, const std::vector<EffectDecision>& effects,
                          const fe::ShellMesh& mesh, bool& from_cache,
                          const std::function<void(const std::string&, double)>& on_progress) {
  const std::filesystem::path folder = cache_folder();
  const bool cached = scene.infill.dem.use_cache && !folder.empty();
  const std::filesystem::path path =
      cached ? folder / ("packing-" + packing_key(scene, effects) + ".h5") : folder;
  dem::Grains grains;
  from_cache = cached && load_cached(path, grains);
  if (from_cache) return grains;

  const auto report = [&](double done) {
    if (on_progress) on_progress("packing", done);
  };
  report(0);
  const std::vector<dem::ThinQuad> quads = obstacles(mesh);
  dem::PackingRequest packing;
  packing.size = scene.turf.size;
  packing.floor = scene.turf.carpet.backing_thickness;
  packing.turf = &scene.turf;
  packing.materials = &scene.materials;
  packing.options = &scene.infill.dem;
  packing.seed = scene.numerics.seed;
  packing.obstacles = quads;
  grains = dem::pack_grains(packing);
  report(0.1);

  Scene still = scene;
  // Settling is a means to get grains at rest, damped and at several g: its energy balance is not a result.
  // Non-finite values and lost grains still stop it.
  still.numerics.energy_error_limit = std::numeric_limits<double>::infinity();
  still.numerics.settle_time = 0;
  still.conditioning = {};
  BuildRequest request;
  request.scene = &still;
  request.effects = effects;
  request.grains = &grains;
  BuiltSimulation built = build_simulation(request);
  Simulation& simulation = *built.simulation;
  simulation.freeze_carpet(true);
  constexpr double interval = 1e-4;
  double done = 0;
  for (const SettleStage& stage : settle_stages) {
    simulation.set_damping(0, stage.damping);
    simulation.set_infill_acceleration(Vec3(0, 0, -9.81 * (stage.acceleration - 1)));
    const int intervals =
        std::max(1, static_cast<int>(std::lround(stage.share * scene.infill.dem.settle_time / interval)));
    for (int i = 0; i < intervals; ++i) {
      simulation.advance_interval(interval);
      report(0.1 + 0.9 * (done + stage.share * i / intervals));
    }
    done += stage.share;
  }
  const ParticleView particles = simulation.infill().particles();
  for (std::size_t i = 0; i < grains.size(); ++i) grains.position.set(i, particles.position(i));
  if (cached) store(path, grains);
  return grains;
}

}  // namespace tuft::coupler

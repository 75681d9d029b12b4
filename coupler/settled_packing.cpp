#include "coupler/settled_packing.h"

#include <limits>

#include "core/error.h"
#include "coupler/build_simulation.h"
#include "coupler/packing_cache.h"
#include "dem_bridge/host_process.h"

namespace tuft::coupler {

std::vector<dem::ThinQuad> thin_quads(const fe::ShellMesh& mesh) {
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

int packing_ranks(const Scene& scene, const dem::Grains& grains) {
  constexpr std::size_t many = 20'000;
  const DemOptions& options = scene.infill.dem;
  const bool elsewhere = options.host.starts_with("tcp://");
  if (options.ranks > 1 || elsewhere || !grains.body.empty() || grains.size() < many) return options.ranks;
  try {
    static_cast<void>(dem::find_mpirun());
    return 2;
  } catch (const RunError&) {
    return 1;
  }
}

SettledGrains settle_grains(const Scene& scene, const std::vector<EffectDecision>& effects,
                            const fe::ShellMesh& mesh,
                            const std::function<void(const std::string&, double)>& on_progress) {
  const PackingCache cache(scene, effects, {});
  SettledGrains settled;
  settled.from_cache = cache.load(settled.grains, settled.report);
  if (settled.from_cache) return settled;

  const auto report = [&](double done) {
    if (on_progress) on_progress("packing", done);
  };
  report(0);
  const std::vector<dem::ThinQuad> quads = thin_quads(mesh);
  dem::PackingRequest packing;
  packing.size = scene.turf.size;
  packing.floor = scene.turf.carpet.backing_thickness;
  packing.turf = &scene.turf;
  packing.materials = &scene.materials;
  packing.options = &scene.infill.dem;
  packing.seed = scene.numerics.seed;
  packing.clumps = effect_on(effects, "clumps");
  packing.obstacles = quads;
  settled.grains = dem::pack_grains(packing);
  report(0.1);

  Scene still = scene;
  // Settling is a means to get grains at rest, damped and at several g: its energy balance is not a result.
  // Non-finite values and lost grains still stop it.
  still.numerics.energy_error_limit = std::numeric_limits<double>::infinity();
  still.infill.dem.overlap_limit = 0;
  still.conditioning = {};
  still.infill.dem.ranks = packing_ranks(scene, settled.grains);
  BuildRequest request;
  request.scene = &still;
  request.effects = effects;
  request.grains = &settled.grains;
  BuiltSimulation built = build_simulation(request);
  built.simulation->freeze_carpet(true);
  settled.report =
      come_to_rest(*built.simulation, scene.infill.dem, [&](double done) { report(0.1 + 0.9 * done); });
  settled.report.moved = static_cast<double>(settled.grains.moved);
  settled.grains.position = positions(built.simulation->infill());
  cache.store(settled.grains, settled.report);
  return settled;
}

}  // namespace tuft::coupler

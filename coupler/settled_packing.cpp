#include "coupler/settled_packing.h"

#include <algorithm>
#include <limits>

#include "core/error.h"
#include "coupler/build_simulation.h"
#include "coupler/laying.h"
#include "coupler/packing_cache.h"
#include "dem_bridge/host_process.h"
#include "dem_bridge/packing_relaxation.h"

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

namespace {

/// Overlap as placed is no result of anything: it is let go whatever the run does.
std::vector<EffectDecision> packing_effects(std::vector<EffectDecision> effects) {
  for (EffectDecision& effect : effects)
    if (effect.name == "overlap_release") effect.on = true;
  return effects;
}

/// `make` says what fails in it as of this stage: its clock starts anew, and could be taken for the run's.
template <class Make>
auto in_stage(const char* stage, const Make& make) {
  try {
    return make();
  } catch (const RunError& error) {
    throw_run_error(
        "packing grains, {} (times are of this stage): {}; a lower numerics.step_safety or another "
        "numerics.seed may help",
        stage, error.what());
  }
}

/// Soft grains at rest overlap as much as stiff ones under ten times the weight; made stiff they would push
/// each other with that, and friction would keep some of it in the bed. Clumps are left: they part as bodies.
void part_overlaps(dem::Grains& grains, const Scene& scene, fe::ShellMesh mesh,
                   const fe::CarpetShape& carpet) {
  constexpr int sweeps = 200;
  if (!grains.body.empty() || grains.size() == 0) return;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) mesh.nodes.set(n, carpet.position[n]);
  const double floor = scene.turf.carpet.backing_thickness;
  double lid = floor;
  for (std::size_t i = 0; i < grains.size(); ++i)
    lid = std::max(lid, grains.position.z[i] + 2 * grains.radius[i]);
  dem::LooseSpheres spheres;
  spheres.position = std::move(grains.position);
  spheres.radius = grains.radius;
  spheres.low.assign(grains.size(), floor);
  spheres.high.assign(grains.size(), lid);
  const dem::PackingBox box{{0.5 * scene.turf.size[0], 0.5 * scene.turf.size[1]}, floor, lid, false};
  const std::vector<dem::ThinQuad> quads = thin_quads(mesh);
  dem::push_apart(spheres, box, quads, sweeps);
  grains.position = std::move(spheres.position);
}

}  // namespace

SettledGrains settle_grains(const Scene& scene, const std::vector<EffectDecision>& effects,
                            const fe::ShellMesh& mesh,
                            const std::function<void(const std::string&, double)>& on_progress) {
  const PackingCache cache(scene, effects, fingerprint(mesh));
  SettledGrains settled;
  settled.from_cache = cache.load(settled, [&](const Packing& kept) {
    // Of a carpet made otherwise, by another version of the program: its shape is refused here.
    build_carpet(scene, effects, mesh)->take_shape(kept.carpet);
  });
  if (settled.from_cache) return settled;
  const std::string cache_trouble = std::move(settled.report.cache_trouble);

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

  Scene still = packing_scene(scene);
  still.infill.dem.ranks = packing_ranks(scene, settled.grains);
  const std::vector<EffectDecision> still_effects = packing_effects(effects);
  LaidBed laid = in_stage("laying them among fibres", [&] {
    return lay(still, still_effects, settled.grains, [&](double done) { report(0.1 + 0.6 * done); });
  });
  settled.grains.position = std::move(laid.position);
  part_overlaps(settled.grains, still, mesh, laid.carpet);
  BuildRequest request;
  request.scene = &still;
  request.effects = still_effects;
  request.grains = &settled.grains;
  request.carpet = &laid.carpet;
  const BuiltSimulation built = build_simulation(request);
  // Strands that swing keep grains awake: they are let go in the run, where the bed settles again.
  built.simulation->freeze_carpet(true);
  settled.report = in_stage("coming to rest", [&] {
    return come_to_rest(*built.simulation, scene.infill.dem, Bed::laid,
                        [&](double done) { report(0.7 + 0.3 * done); });
  });
  settled.report.time += laid.time;
  settled.report.laid = laid.lies;
  settled.report.moved = static_cast<double>(settled.grains.moved);
  settled.report.cache_trouble = cache_trouble;
  settled.grains.position = positions(built.simulation->infill());
  settled.carpet = built.simulation->carpet().shape();
  cache.store(settled);
  return settled;
}

}  // namespace tuft::coupler

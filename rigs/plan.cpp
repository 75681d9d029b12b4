// What can be known about a run before running it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"
#include "dem_bridge/clump_shape.h"
#include "dem_bridge/dem_infill.h"
#include "dem_bridge/grain_contact.h"
#include "dem_bridge/grain_sizes.h"
#include "dem_bridge/hertz.h"
#include "dem_bridge/host_process.h"
#include "fe_carpet/leg_shape.h"
#include "rigs/component_run.h"
#include "rigs/process_memory.h"
#include "rigs/run.h"
#include "rigs/run_remarks.h"
#include "rigs/run_state.h"
#include "rigs/specimen_run.h"
#include "rigs/window_remarks.h"

namespace tuft::rigs {
namespace {

struct GrainEstimate {
  double count = 0;
  double own_step = std::numeric_limits<double>::infinity();  ///< s, that contacts of grains bear
  double contact_step = 1;  ///< s, 2 / omega of the stiffest contact with shells and bodies
  double largest = 0;       ///< m, diameter
};

/// The kinds of grains of all layers, each once.
std::vector<Index> kinds_of_grains(const Scene& scene) {
  std::vector<Index> kinds;
  for (const Layer& layer : scene.turf.layers)
    for (const GrainShare& share : scene.materials.at(layer.material).grain_shares)
      if (std::ranges::count(kinds, share.material) == 0) kinds.push_back(share.material);
  return kinds;
}

GrainEstimate estimate_grains(const Scene& scene, bool clumps) {
  GrainEstimate estimate;
  const std::vector<Index> kinds = kinds_of_grains(scene);
  /// Spheres of radius r and a density that gives them the mass that each has to itself.
  const auto take_steps = [&](Index m, double r, double density, double mass_ratio) {
    const Material& kind = scene.materials.at(m);
    estimate.own_step = std::min(
        estimate.own_step,
        dem::stable_step_of_grain(r, density, m, kinds, scene.materials, scene.infill.dem, mass_ratio));
    const double grain_mass = density * 4.0 / 3 * std::numbers::pi * r * r * r;
    estimate.contact_step =
        std::min(estimate.contact_step, 2 * std::sqrt(grain_mass / coupler::dem_contact_stiffness(kind, r)));
  };
  for (const Layer& layer : scene.turf.layers) {
    const Material& material = scene.materials.at(layer.material);
    const double mass = material.bulk_density * scene.turf.size[0] * scene.turf.size[1] * layer.depth;
    for (const GrainShare& share : material.grain_shares) {
      const Material& kind = scene.materials.at(share.material);
      const double density = kind.grain->density;
      const dem::GrainSizeDistribution sizes(*kind.grain,
                                             dem::coarse_graining_of(scene.infill.dem, kind.name));
      const double count = mass * share.mass_fraction / (density * std::numbers::pi / 6 * sizes.mean_cube());
      const double r = 0.5 * sizes.smallest();
      estimate.largest = std::max(estimate.largest, sizes.largest());
      if (!clumps || !kind.grain->clump) {
        estimate.count += count;
        take_steps(share.material, r, density, 1);
        continue;
      }
      const dem::ClumpBody body = dem::make_clump_body(*kind.grain->clump, kind.name);
      estimate.count += count * static_cast<double>(body.size());
      for (std::size_t k = 0; k < body.size(); ++k) {
        const dem::SphereOfClump sphere = dem::sphere_of_clump(body, k, density);
        take_steps(share.material, 2 * r * body.radius[k], sphere.density, sphere.mass_ratio);
      }
    }
  }
  return estimate;
}

void add_remark(RunPlan& plan, const std::string& remark) {
  if (!remark.empty()) plan.remarks.push_back(remark);
}

/// intervals: how many are stepped so.
void take_steps(RunPlan& plan, const coupler::StableSteps& stable, const Scene& scene, double interval,
                std::uint64_t intervals) {
  const coupler::StepPlan steps =
      coupler::plan_steps(stable, scene.numerics.step_safety, scene.numerics.coupling_window, interval);
  plan.window = steps.window;
  plan.carpet_substeps = steps.carpet_substeps;
  plan.infill_substeps = steps.infill_substeps;
  plan.carpet_step = steps.window / steps.carpet_substeps;
  plan.infill_step = steps.window / steps.infill_substeps;
  plan.windows += static_cast<std::uint64_t>(steps.windows) * intervals;
  plan.carpet_subcycle = steps.carpet_subcycle;
}

void take_group_steps(RunPlan& plan, const fe::Carpet& carpet, double safety) {
  const std::vector<double> steps = carpet.stable_steps_of_materials();
  const auto share = [&](double step) { return std::isfinite(step) ? safety * step : 0; };
  plan.backing_step = share(steps[0]);
  plan.fibre_step = share(steps[1]);
}

void remark_on_mass_scaling(RunPlan& plan, const fe::MassScaling& scaling) {
  if (scaling.limit == 0) return;
  plan.remarks.push_back(
      fmt::format("mass scaling adds {:.3g} g, {:.3g} % of the carpet's mass (limit {:.3g} %), to {} shells; "
                  "the carpet's "
                  "stable step rises from {:.3g} to {:.3g} us",
                  1e3 * scaling.added_mass, 100 * scaling.share(), 100 * scaling.limit, scaling.elements,
                  1e6 * scaling.step_before, 1e6 * scaling.step_after));
}

/// Wall time of an interval, s, from the real loops over the first ones.
double time_intervals(const Scene& scene, RunState& state) {
  coupler::Simulation& simulation = state.simulation();
  simulation.set_damping(scene.numerics.settle_damping, scene.numerics.settle_damping);
  simulation.advance_interval(state.schedule.interval);  // caches warm, lists built
  const auto start = std::chrono::steady_clock::now();
  constexpr int timed = 3;
  for (int i = 0; i < timed; ++i) simulation.advance_interval(state.schedule.interval);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / timed;
}

/// What conditioning adds in a continuum: its rigid spheres have steps and a speed of their own.
void plan_conditioning(RunPlan& plan, const Scene& scene) {
  RunState state = make_run_state(scene, nullptr, 0, {});
  const std::uint64_t intervals = state.schedule.conditioned();
  const double wall = time_intervals(scene, state) * static_cast<double>(intervals);
  take_steps(plan, state.simulation().stable_steps(state.schedule.interval), scene, state.schedule.interval,
             intervals);
  const std::uint64_t windows = plan.windows;
  plan.predicted_wall_s += wall;
  plan.remarks.push_back(fmt::format(
      "conditioning: {:.3g} ms on rigid spheres under a plate, {} windows with {} steps of the spheres in "
      "each, about {:.3g} s (conditioning.press_time sets most of it)",
      1e3 * static_cast<double>(intervals) * state.schedule.interval, windows, plan.infill_substeps, wall));
}

/// Builds the run and times its real loops over the first intervals.
void plan_by_running(RunPlan& plan, const Scene& scene) {
  if (scene.conditioning.on()) plan_conditioning(plan, scene);
  const Schedule schedule = make_schedule(scene);
  RunState state = make_run_state(scene, nullptr, schedule.conditioned() + 1, {});
  const coupler::Simulation& simulation = state.simulation();
  const fe::Carpet& carpet = simulation.carpet();
  plan.particles = simulation.infill().particles().size();
  plan.shells = carpet.mesh().quads.size();
  plan.nodes = carpet.nodes().x.size();
  remark_on_mass_scaling(plan, carpet.mass_scaling());
  take_group_steps(plan, carpet, scene.numerics.step_safety);
  const std::uint64_t intervals = schedule.end - schedule.conditioned();
  plan.predicted_wall_s += time_intervals(scene, state) * static_cast<double>(intervals);
  // After the first intervals: which contacts bound the step is not known before.
  const coupler::StableSteps stable = simulation.stable_steps(schedule.interval);
  take_steps(plan, stable, scene, schedule.interval, intervals);
  add_remark(plan, remark_on_windows(stable, scene.numerics, schedule.interval, "output.histories"));
  plan.predicted_memory_bytes = peak_memory_bytes(0);
  const auto& shell = simulation.particle_shell();
  if (shell.initial_overlap().pairs > 0)
    plan.remarks.push_back(fmt::format(
        "{} particles overlap fibres or backing by up to {:.3g} mm at the start; the overlap is let "
        "go over {:.3g} ms of settling",
        shell.initial_overlap().pairs, 1e3 * shell.initial_overlap().largest,
        1e3 * scene.numerics.contact_release_time));
  if (shell.softening() > 1)
    plan.remarks.push_back(fmt::format(
        "contact of infill with shells is {:.3g} times softer than the infill's own penalty: a light "
        "fibre bears no stiffer spring (docs/theory/contact.md)",
        shell.softening()));
}

double clearance(const CarpetDesign& carpet) {
  const fe::RootLayout layout = fe::root_layout(carpet);
  if (layout.shared_edge) return std::min(carpet.gauge, carpet.stitch_spacing) - carpet.strand_width;
  return std::min(carpet.gauge - layout.width(), carpet.stitch_spacing - layout.spacing - layout.depth);
}

/// How many of the largest grains lie across what they must not be large beside.
void remark_on_grains(RunPlan& plan, const Scene& scene, double largest) {
  const double ratio = clearance(scene.turf.carpet) / largest;
  // Of an imported carpet the design's spacings say nothing.
  if (effect_on(plan.effects, "fibres") && scene.turf.carpet.mesh.file.empty() && ratio < 5)
    plan.remarks.push_back(fmt::format(
        "clearance between tufts is {:.2g} of the largest grain's diameter (under 5): grains may jam; "
        "reduce infill.dem.coarse_graining",
        ratio));
  // ASTM D3080 asks this of specimens: ten of the largest grains across, six high.
  const double across = scene.rig.clegg.diameter / largest, high = scene.infill_depth() / largest;
  if (across < 10)
    plan.remarks.push_back(fmt::format(
        "the missile is {:.2g} of the largest grains wide (under 10): results depend on where single grains "
        "lie; run several numerics.seed, or reduce infill.dem.coarse_graining",
        across));
  if (high < 6)
    plan.remarks.push_back(
        fmt::format("the infill is {:.2g} of the largest grains deep (under 6): reduce "
                    "infill.dem.coarse_graining",
                    high));
  const std::vector<Index> kinds = kinds_of_grains(scene);
  const bool cohesion = effect_on(plan.effects, "grain_cohesion");
  if (cohesion) dem::check_cohesion(kinds, scene.materials, scene.infill.dem);
  const auto remarks = dem::contact_remarks(kinds, cohesion, scene.materials, scene.infill.dem);
  plan.remarks.insert(plan.remarks.end(), remarks.begin(), remarks.end());
}

/// What of a run on grains is conditioning, as far as it can be known: it ends when the bed stays.
void remark_on_conditioning(RunPlan& plan, const Scene& scene, const Schedule& schedule) {
  const bool rolls = scene.conditioning.method == "roller";
  const double intervals = static_cast<double>(schedule.conditioned()),
               share =
                   intervals / static_cast<double>(schedule.end - schedule.settle + schedule.settle_expected);
  plan.remarks.push_back(fmt::format(
      "conditioning: {}{:.3g} ms under a {}, {:.0f} % of the windows and of the time ({} sets most of it)",
      schedule.presses > 1 && !rolls ? "at most " : "", 1e3 * intervals * schedule.interval,
      rolls ? "roller" : "plate", 100 * share,
      rolls ? "conditioning.roller.speed" : "conditioning.press_time"));
}

/// DEM without packing: counts from masses, speeds from what the bridge measured (docs/benchmarks.md).
void plan_by_counting(RunPlan& plan, const Scene& scene) {
  const fe::ShellMesh mesh = coupler::build_carpet_mesh(scene, plan.effects);
  plan.shells = mesh.quads.size();
  plan.nodes = mesh.nodes.size();
  const fe::Carpet carpet(mesh, {scene.turf.carpet.backing, scene.turf.carpet.fibre},
                          coupler::carpet_options(scene));
  remark_on_mass_scaling(plan, carpet.mass_scaling());
  take_group_steps(plan, carpet, scene.numerics.step_safety);
  const GrainEstimate grains = estimate_grains(scene, effect_on(plan.effects, "clumps"));
  plan.particles = static_cast<std::uint64_t>(grains.count);
  const Schedule schedule = make_schedule(scene);
  // As Simulation::stable_steps has it.
  const double window =
      plan.shells > 0 ? carpet.stable_step() : 1 / std::hypot(1 / grains.own_step, 1 / grains.contact_step);
  const coupler::StableSteps stable{window, grains.own_step, grains.contact_step, carpet.subcycle_ratio()};
  take_steps(plan, stable, scene, schedule.interval,
             schedule.end - schedule.settle + schedule.settle_expected);
  add_remark(plan, remark_on_windows(stable, scene.numerics, schedule.interval, "output.histories"));
  constexpr double particle_steps_per_s = 1.5e6,
                   element_steps_per_s = 2e6;  // low end of measured speeds, settled bed
  const double windows = static_cast<double>(plan.windows);
  plan.predicted_wall_s =
      windows * (static_cast<double>(plan.infill_substeps) * grains.count / particle_steps_per_s +
                 plan.carpet_substeps * static_cast<double>(plan.shells) / element_steps_per_s);
  constexpr std::uint64_t bytes_per_grain = 4000, bytes_per_shell = 2000, programs = 60u << 20;
  plan.predicted_memory_bytes = programs + bytes_per_grain * plan.particles + bytes_per_shell * plan.shells;
  plan.remarks.push_back(
      "grains are counted from layer masses, and time and memory estimated from usual speeds: nothing was "
      "packed");
  if (schedule.settle > schedule.settle_least)
    plan.remarks.push_back(
        fmt::format("grains settle until they are at rest: {:.3g} to {:.3g} ms (numerics.settle_time, "
                    "settle_time_limit), estimated as {:.3g} ms",
                    1e3 * static_cast<double>(schedule.settle_least) * schedule.interval,
                    1e3 * static_cast<double>(schedule.settle) * schedule.interval,
                    1e3 * static_cast<double>(schedule.settle_expected) * schedule.interval));
  if (scene.conditioning.on()) remark_on_conditioning(plan, scene, schedule);
  remark_on_grains(plan, scene, grains.largest);
}

}  // namespace

std::vector<std::string> remarks_on_setup(const Scene& scene, const RunState& state) {
  RunPlan plan;
  plan.effects = state.effects;
  plan.remarks = coupler::carpet_mesh_notes(scene);
  remark_on_mass_scaling(plan, state.simulation().carpet().mass_scaling());
  if (scene.infill.approach == Approach::dem) {
    const GrainEstimate grains = estimate_grains(scene, effect_on(plan.effects, "clumps"));
    remark_on_grains(plan, scene, grains.largest);
  }
  return plan.remarks;
}

void check_host(const Scene& scene) {
  const DemOptions& dem = scene.infill.dem;
  if (scene.rig.is_component() || scene.infill.approach != Approach::dem || dem.host.starts_with("tcp://"))
    return;
  static_cast<void>(dem::find_host(dem.host));
}

RunPlan plan(const Scene& scene) {
  if (scene.rig.is_component()) return plan_component(scene);
  if (scene.rig.is_specimen()) return plan_specimen(scene);
  RunPlan plan;
  plan.effects = decide_effects(scene);
  plan.remarks = coupler::carpet_mesh_notes(scene);
  if (scene.numerics.threads > 0) set_threads(scene.numerics.threads);
  if (scene.infill.approach == Approach::sph) {
    plan_by_running(plan, scene);
    return plan;
  }
  plan_by_counting(plan, scene);
  return plan;
}

}  // namespace tuft::rigs

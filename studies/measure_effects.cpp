// From a scene to turns of all its variants.
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/error.h"
#include "core/parallel.h"
#include "rigs/process_memory.h"
#include "rigs/schedule.h"
#include "studies/effect_cost.h"
#include "studies/effect_variants.h"
#include "studies/stepped_scene.h"

namespace tuft::studies {
namespace {

void check_names(const std::vector<std::string>& names, const std::vector<EffectVariant>& variants) {
  for (const std::string& name : names)
    if (std::ranges::none_of(variants, [&](const EffectVariant& v) { return v.effect == name; })) {
      std::string known;
      for (const EffectVariant& v : variants) known += (known.empty() ? "" : ", ") + v.effect;
      throw_input_error("no effect of this scene is named '{}'; one of: {}", name, known);
    }
}

void check_memory(std::uint64_t each, std::size_t scenes) {
  const std::uint64_t free = rigs::available_memory_bytes(), needed = each * scenes;
  constexpr double gigabyte = 1e9;
  if (free > 0 && needed > free)
    throw_input_error(
        "{} scenes at once, each with an effect the other way, would take about {:.2g} GB of memory, and "
        "{:.2g} GB are free: look at fewer effects (--only), or at a smaller patch",
        scenes, static_cast<double>(needed) / gigabyte, static_cast<double>(free) / gigabyte);
}

/// Everything but the scene itself is a variant of it; grains are packed for the first, and for those that
/// have other grains or lie among other shells.
class Field {
 public:
  Field(const CostRequest& request, Scene scene) : request_(request), scene_(std::move(scene)) {}

  Entrant entrant(const std::string& name, bool adopts, const Scene& scene) {
    return {name, adopts, [this, scene](bool adopting) {
              Scene built = scene;
              // The state of another law is none that this one's balance can be judged from.
              if (adopting) built.numerics.energy_error_limit = std::numeric_limits<double>::max();
              return build(built);
            }};
  }

 private:
  std::unique_ptr<SteppedScene> build(const Scene& scene) {
    const std::vector<EffectDecision> effects = decide_effects(scene), of_scene = decide_effects(scene_);
    constexpr std::array of_bed{"clumps", "fibres", "backing"};
    const bool same_bed = std::ranges::all_of(
        of_bed, [&](const char* name) { return effect_on(effects, name) == effect_on(of_scene, name); });
    std::unique_ptr<RunningScene> running =
        step_scene(scene, bed_ && same_bed ? &*bed_ : nullptr, request_.on_packing);
    if (!bed_ && same_bed) bed_ = bed_of(*running, scene);
    return running;
  }

  const CostRequest& request_;
  Scene scene_;
  std::optional<coupler::Packing> bed_;
};

/// Whether a scene with an effect the other way may go on from the state of the scene as it is: where shells,
/// grains and what separates particles are the same. What else does not fit is seen when it is read. Grains'
/// contacts hold what their models need, and no more.
bool may_adopt(const Scene& scene, const EffectVariant& variant) {
  constexpr std::array apart{"fibres", "backing", "fibre_separation"};
  return scene.infill.approach == Approach::sph && std::ranges::count(apart, variant.effect) == 0;
}

/// Removes the file that it names when it goes.
class StateFile {
 public:
  StateFile() {
    std::string name = (std::filesystem::temp_directory_path() / "tuft_effects_XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) throw_run_error("no file for the state of the scene can be made in {}", name);
    close(file);
    path_ = name;
  }
  ~StateFile() {
    std::error_code gone;
    std::filesystem::remove(path_, gone);
  }
  StateFile(const StateFile&) = delete;
  StateFile& operator=(const StateFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void set_course(TurnRequest& turns, const Scene& scene) {
  if (scene.rig.is_specimen()) {
    turns.settle_least = turns.settle_most = 1;                    // lists are built, caches warm
    turns.moving = std::numeric_limits<std::uint64_t>::max() / 2;  // the test says when it is done
    return;
  }
  const rigs::Schedule schedule = rigs::make_schedule(scene);
  turns.settle_most = schedule.settle;
  // Until overlap at the start is let go contact is not what it is later.
  turns.settle_least = std::min(
      schedule.settle,
      static_cast<std::uint64_t>(std::ceil(scene.numerics.contact_release_time / schedule.interval)));
  turns.moving = schedule.end - schedule.release();
}

void add_remarks(EffectCosts& costs, const Scene& asked, const TurnRequest& turns, double interval) {
  if (asked.conditioning.on())
    costs.remarks.push_back(
        "conditioning is left out: the bed is as placed, looser, and so its stable steps may be longer");
  const auto settled = static_cast<std::uint64_t>(std::llround(costs.settled_s / interval));
  if (costs.turns > 0 && settled < turns.settle_most)
    costs.remarks.push_back(fmt::format("the infill settled for {:.3g} of {:.3g} ms, for the time there was",
                                        1e3 * costs.settled_s,
                                        1e3 * interval * static_cast<double>(turns.settle_most)));
}

}  // namespace

EffectCosts measure_effect_costs(const CostRequest& request) {
  if (request.scene.rig.is_component())
    throw_input_error("the cost of effects is measured where there is infill; rig {} has none",
                      request.scene.rig.type);
  Scene scene = request.scene;
  scene.conditioning.method = "none";
  if (scene.numerics.threads > 0) set_threads(scene.numerics.threads);
  const std::vector<EffectVariant> variants = effect_variants(scene);
  check_names(request.only, variants);

  Field field(request, scene);
  TurnRequest turns;
  turns.entrants = {field.entrant("the scene", true, scene), field.entrant("the scene again", true, scene)};
  std::vector<EffectCost> effects;
  for (const EffectVariant& v : variants) {
    if (!request.only.empty() && std::ranges::count(request.only, v.effect) == 0) continue;
    effects.push_back({v.effect, v.on, v.along, std::nullopt, v.why_not});
    if (v.scene)
      turns.entrants.push_back(
          field.entrant((v.on ? "without " : "with ") + v.effect, may_adopt(scene, v), *v.scene));
  }
  check_memory(request.memory_bytes, turns.entrants.size());
  set_course(turns, scene);
  const StateFile state;
  turns.state = state.path();
  turns.seconds = request.seconds;
  turns.clock = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  turns.stop = request.stop;
  turns.on_progress = request.on_progress;
  const double interval = interval_of(scene);
  EffectCosts costs = evaluate_turns(take_turns(turns), std::move(effects), interval);
  add_remarks(costs, request.scene, turns, interval);
  return costs;
}

}  // namespace tuft::studies

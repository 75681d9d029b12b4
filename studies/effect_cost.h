#pragma once
/// What each effect costs in the coupled step of a scene: the same windows with and without it.
#include <optional>
#include <string>
#include <vector>

#include "core/scene.h"
#include "studies/median_estimate.h"
#include "studies/turns.h"

namespace tuft::studies {

/// All of it is what comes with an effect: of the scene with it, over the scene without it, less 1.
struct MeasuredCost {
  MedianEstimate step;        ///< of processor time a particle-step, with all of the coupled step in it
  MedianEstimate step_s;      ///< s a particle-step, with it less without it
  MedianEstimate total;       ///< of processor time for the same simulated time
  double windows = 0;         ///< of their number for that: counted, and so without scatter
  double particle_steps = 0;  ///< the same
};

struct EffectCost {
  std::string effect;
  bool on = false;                 ///< in the scene as it is
  std::vector<std::string> along;  ///< effects switched with it
  std::optional<MeasuredCost> measured;
  std::string why_not;  ///< why nothing was measured: what the scene lacks, or how the variant failed
};

/// The scene as it is, measured twice in each turn.
struct BaseCost {
  double step_s = 0;           ///< s of processor time a particle-step, median
  double windows = 0;          ///< per s of simulated time
  double particle_steps = 0;   ///< the same
  MedianEstimate step, total;  ///< its second copy over its first, less 1: what is noise
};

struct EffectCosts {
  BaseCost base;
  std::vector<EffectCost> effects;
  std::size_t turns = 0;    ///< that count: in which the rig pressed
  double turn_s = 0;        ///< s of simulated time, of one
  double from = 0, to = 0;  ///< s after the release, of those that count
  bool struck = false;      ///< the rig pressed in enough of them
  double settled_s = 0;     ///< s of simulated time before the release
  TurnRecord::End end = TurnRecord::End::whole;
  std::vector<std::string> remarks;  ///< what of the scene was left out or cut
};

/// A difference that is told from the scatter: 0 lies outside of its bounds, and it is larger than the
/// largest that the scene shows against itself.
[[nodiscard]] bool is_told(const MedianEstimate& cost, const MedianEstimate& noise);
/// The most that a difference which is not told may be.
[[nodiscard]] double largest_of(const MedianEstimate& cost, const MedianEstimate& noise);

/// What the turns of a record say, whose entrants were the scene, the scene again, and then those of
/// `effects` whose `why_not` is empty, in order. `interval`: s of one. Turns count in which the rig pressed
/// at least a tenth as much as in the one in which it pressed most; where those are fewer than six, all do.
[[nodiscard]] EffectCosts evaluate_turns(const TurnRecord& record, std::vector<EffectCost> effects,
                                         double interval);

struct CostRequest {
  Scene scene;
  double seconds = 60;             ///< of wall time, once the scene is built
  std::vector<std::string> only;   ///< effects to look at; empty: all
  std::uint64_t memory_bytes = 0;  ///< that one such scene takes; 0: not looked at
  const std::atomic<bool>* stop = nullptr;
  std::function<void(const TurnProgress&)> on_progress;
  std::function<void(double done)> on_packing;  ///< done in [0, 1]
};

/// Builds all variants of the scene and measures. They go on from the state in which the rig of the scene as
/// it is begins to press, where it fits them. Conditioning is left out, and settling is cut where time is
/// short. Throws InputError for a rig that tests the carpet alone, for an effect that is not there, for
/// grains on another machine and where memory is short; RunError where the scene itself fails.
[[nodiscard]] EffectCosts measure_effect_costs(const CostRequest& request);

}  // namespace tuft::studies

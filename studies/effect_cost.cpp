#include "studies/effect_cost.h"

#include <algorithm>
#include <cmath>

namespace tuft::studies {
namespace {

constexpr double pressed_share = 0.1;   // of the greatest push: where a pulse begins and ends
constexpr std::size_t least_turns = 6;  // fewer do not bound a median

double step_of(const Stretch& s) {
  return s.processor_s / static_cast<double>(s.particle_steps);
}
bool is_whole(const Stretch& s) {
  return s.particle_steps > 0 && s.processor_s > 0;
}

double farthest(const MedianEstimate& e) {
  return std::max(std::abs(e.low), std::abs(e.high));
}

/// Turns in which the rig pressed.
std::vector<std::size_t> pressed_turns(const std::vector<Stretch>& base) {
  double most = 0;
  for (const Stretch& s : base) most = std::max(most, s.push);
  std::vector<std::size_t> turns;
  for (std::size_t t = 0; t < base.size(); ++t)
    if (most > 0 && base[t].push >= pressed_share * most) turns.push_back(t);
  return turns;
}

/// Sums over turns of the scene with an effect and without it.
struct Counted {
  double windows = 0, particle_steps = 0;
  void add(const Stretch& s) {
    windows += static_cast<double>(s.windows);
    particle_steps += static_cast<double>(s.particle_steps);
  }
};

/// The scene in one turn: the mean of its two copies.
Stretch mean_of(const Stretch& a, const Stretch& b) {
  Stretch mean = a;
  mean.processor_s = 0.5 * (a.processor_s + b.processor_s);
  return mean;
}

std::optional<MeasuredCost> compare(const TurnRecord& record, const std::vector<std::size_t>& turns,
                                    std::size_t entrant, bool on) {
  std::vector<double> step, step_s, total;
  Counted with_it, without;
  for (const std::size_t t : turns) {
    const Stretch base = mean_of(record.stretches[0][t], record.stretches[1][t]),
                  other = record.stretches[entrant][t];
    if (!is_whole(base) || !is_whole(other) || base.intervals != other.intervals) continue;
    const Stretch &with = on ? base : other, &bare = on ? other : base;
    step.push_back(step_of(with) / step_of(bare) - 1);
    step_s.push_back(step_of(with) - step_of(bare));
    total.push_back(with.processor_s / bare.processor_s - 1);
    with_it.add(with);
    without.add(bare);
  }
  if (step.empty()) return std::nullopt;
  return MeasuredCost{estimate_median(step), estimate_median(step_s), estimate_median(total),
                      with_it.windows / without.windows - 1,
                      with_it.particle_steps / without.particle_steps - 1};
}

BaseCost cost_of_base(const TurnRecord& record, const std::vector<std::size_t>& turns, double turn_s) {
  BaseCost base;
  std::vector<double> seconds, step, total;
  Counted counted;
  for (const std::size_t t : turns) {
    const Stretch &a = record.stretches[0][t], &b = record.stretches[1][t];
    if (!is_whole(a) || !is_whole(b)) continue;
    seconds.push_back(step_of(mean_of(a, b)));
    step.push_back(step_of(b) / step_of(a) - 1);
    total.push_back(b.processor_s / a.processor_s - 1);
    counted.add(a);
  }
  if (seconds.empty()) return base;
  const double time = turn_s * static_cast<double>(seconds.size());
  base.step_s = estimate_median(seconds).median;
  base.windows = counted.windows / time;
  base.particle_steps = counted.particle_steps / time;
  base.step = estimate_median(step);
  base.total = estimate_median(total);
  return base;
}

}  // namespace

bool is_told(const MedianEstimate& cost, const MedianEstimate& noise) {
  return cost.bounded && (cost.low > 0 || cost.high < 0) && std::abs(cost.median) > farthest(noise);
}

double largest_of(const MedianEstimate& cost, const MedianEstimate& noise) {
  return std::max(farthest(cost), farthest(noise));
}

EffectCosts evaluate_turns(const TurnRecord& record, std::vector<EffectCost> effects, double interval) {
  EffectCosts costs;
  costs.end = record.end;
  costs.turn_s = interval * static_cast<double>(record.turn);
  costs.settled_s = interval * static_cast<double>(record.settled);
  // A copy of the scene that failed has told nothing of noise; turns before it did count.
  std::size_t common = record.turns();
  if (record.stretches.size() > 1) common = std::min(common, record.stretches[1].size());
  std::vector<std::size_t> turns;
  if (common > 0)
    turns = pressed_turns(
        {record.stretches[0].begin(), record.stretches[0].begin() + static_cast<std::ptrdiff_t>(common)});
  costs.struck = turns.size() >= least_turns;
  if (!costs.struck) {
    turns.clear();
    for (std::size_t t = 0; t < common; ++t) turns.push_back(t);
  }
  costs.turns = turns.size();
  if (!turns.empty()) {
    const double start = interval * static_cast<double>(record.start);
    costs.from = start + costs.turn_s * static_cast<double>(turns.front());
    costs.to = start + costs.turn_s * static_cast<double>(turns.back() + 1);
  }
  if (record.cut)
    costs.remarks.push_back(
        "time for the run-up was over before the rig had been stopped: where infill yields effects may cost "
        "more; "
        "give more with --cost-seconds");
  costs.base = cost_of_base(record, turns, costs.turn_s);
  std::size_t entrant = 2;
  for (EffectCost& effect : effects) {
    if (!effect.why_not.empty()) continue;
    effect.why_not = record.failures.at(entrant);
    if (effect.why_not.empty()) effect.measured = compare(record, turns, entrant, effect.on);
    if (!effect.measured && effect.why_not.empty()) effect.why_not = "no turn was finished";
    ++entrant;
  }
  costs.effects = std::move(effects);
  return costs;
}

}  // namespace tuft::studies

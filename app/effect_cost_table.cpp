#include "app/effect_cost_table.h"

#include <fmt/format.h>

#include <cmath>

#include "app/number_format.h"
#include "app/text_table.h"

namespace tuft::app {
namespace {

using studies::EffectCost;
using studies::EffectCosts;
using studies::MedianEstimate;
using studies::TurnRecord;

constexpr double nanoseconds = 1e9, milliseconds = 1e3;

/// "+5.3", "-0.26", "+120"; "0" for what rounds to nothing.
std::string with_sign(double value) {
  if (std::abs(value) < 0.005) return "0";
  const std::string digits = format_significant(std::abs(value), std::abs(value) < 100 ? 2 : 3);
  return (value < 0 ? "-" : "+") + digits;
}

std::string percent(double fraction) {
  return with_sign(100 * fraction) + " %";
}

/// Of what is counted and has no scatter.
std::string count_words(double fraction) {
  return fraction == 0 ? "same" : percent(fraction);
}

std::string name_of(const EffectCost& effect) {
  std::string name = effect.effect;
  for (std::size_t k = 0; k < effect.along.size(); ++k) name += (k == 0 ? " and " : ", ") + effect.along[k];
  return name;
}

std::string measured_table(const EffectCosts& costs) {
  TextTable table({"effect", "now", "ns a particle-step", "of it", "particle-steps", "windows", "in all"});
  for (const EffectCost& effect : costs.effects) {
    if (!effect.measured) continue;
    const studies::MeasuredCost& cost = *effect.measured;
    const bool told = studies::is_told(cost.step, costs.base.step);
    table.add({name_of(effect), effect.on ? "on" : "off",
               told ? with_sign(nanoseconds * cost.step_s.median) : "-",
               cost_words(cost.step, costs.base.step), count_words(cost.particle_steps),
               count_words(cost.windows), cost_words(cost.total, costs.base.total)});
  }
  table.add({"the scene against itself", "", "", cost_words(costs.base.step, {}), "same", "same",
             cost_words(costs.base.total, {})});
  return table.text();
}

std::string missing_table(const EffectCosts& costs) {
  TextTable table;
  table.set_prose(2);
  bool any = false;
  for (const EffectCost& effect : costs.effects) {
    if (effect.measured) continue;
    table.add({effect.effect, effect.on ? "on" : "off", effect.why_not});
    any = true;
  }
  return any ? "\nNot measured\n" + table.text() : "";
}

std::string method(const EffectCosts& costs) {
  return fmt::format(
      "  processor time over {} turns of {}, {:.3g} to {:.3g} ms after the release{}\n"
      "  all from the state that the scene as it is had reached, where it fits them\n"
      "  as it is: {} ns a particle-step with all of the coupled step in it, {} particle-steps and {} "
      "windows a ms\n",
      costs.turns, format_quantity(costs.turn_s, "s"), milliseconds * costs.from, milliseconds * costs.to,
      costs.struck ? ", in which the rig presses" : "",
      format_significant(nanoseconds * costs.base.step_s, 3),
      format_count(static_cast<std::uint64_t>(std::llround(costs.base.particle_steps / milliseconds))),
      format_significant(costs.base.windows / milliseconds, 3));
}

std::string remarks(const EffectCosts& costs) {
  std::string text;
  const auto add = [&](const std::string& remark) { text += "  " + remark + "\n"; };
  if (costs.end == TurnRecord::End::stopped) add("stopped before the end");
  if (!costs.struck)
    add(costs.turns == 0
            ? "time was over before a turn was: nothing was measured; give more with --cost-seconds"
            : "the rig pressed in fewer than six turns, so all count: what costs where infill yields may "
              "cost more; "
              "give more with --cost-seconds");
  for (const std::string& remark : costs.remarks) add(remark);
  return text.empty() ? text : "\nRemarks on costs\n" + text;
}

}  // namespace

std::string cost_words(const MedianEstimate& cost, const MedianEstimate& noise) {
  if (!studies::is_told(cost, noise))
    return fmt::format("not told from 0: within {} %",
                       format_significant(100 * studies::largest_of(cost, noise), 2));
  return fmt::format("{} ({} to {})", percent(cost.median), with_sign(100 * cost.low),
                     with_sign(100 * cost.high));
}

std::string effect_cost_text(const EffectCosts& costs) {
  std::string text = "Cost of effects: of the scene with each, over the scene without it\n";
  if (costs.turns > 0) text += method(costs) + "\n" + measured_table(costs);
  return text + missing_table(costs) + remarks(costs);
}

std::string effect_cost_progress(const studies::TurnProgress& progress, double interval) {
  using Stage = studies::TurnProgress::Stage;
  const double time = milliseconds * interval * static_cast<double>(progress.intervals);
  switch (progress.stage) {
    case Stage::building:
      return fmt::format("building  {} of {} scenes: {}", progress.done + 1, progress.scenes, progress.name);
    case Stage::settling:
      return fmt::format("settling  {:6.2f} ms  {}, {} to go at most", time, format_duration(progress.wall),
                         format_duration(progress.left));
    case Stage::run_up:
      return fmt::format("run-up    {}{}  {}, {} to go at most", progress.name,
                         time > 0 ? fmt::format(", {:.2f} ms after the release", time) : "",
                         format_duration(progress.wall), format_duration(progress.left));
    case Stage::turns:
      break;
  }
  return fmt::format("turn {:<4} {:6.2f} ms after the release  {}, {} to go at most", progress.done, time,
                     format_duration(progress.wall), format_duration(progress.left));
}

}  // namespace tuft::app

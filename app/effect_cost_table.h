#pragma once
/// What effects cost, as words and a table.
#include <string>

#include "studies/effect_cost.h"

namespace tuft::app {

/// "+5.3 % (4.8 to 5.8)" where it is told from noise, else "not told from 0: within 1.2 %".
[[nodiscard]] std::string cost_words(const studies::MedianEstimate& cost,
                                     const studies::MedianEstimate& noise);

/// The table, what was measured how, and what was not.
[[nodiscard]] std::string effect_cost_text(const studies::EffectCosts& costs);

/// One line for the progress of a measurement.
[[nodiscard]] std::string effect_cost_progress(const studies::TurnProgress& progress, double interval);

}  // namespace tuft::app

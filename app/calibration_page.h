#pragma once
/// The page of a calibration: targets against start and fit, the search, what the targets determine, cost.
#include <string>

#include "studies/calibrate.h"

namespace tuft::app {

/// One self-contained HTML page.
[[nodiscard]] std::string calibration_page(const studies::Problem& problem,
                                           const studies::CalibrationResult& result);

/// All targets that are numbers or ranges, a row each: the range as a bar, start and fit as marks on it.
/// Inline SVG; marks that would lie far outside are drawn at the edge as arrows.
[[nodiscard]] std::string target_chart(const studies::Problem& problem,
                                       const studies::CalibrationResult& result);

}  // namespace tuft::app

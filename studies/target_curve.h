#pragma once
/// Curves that are targets: read from the calibration or from a file of columns.
#include <string>
#include <vector>

#include "core/calibration_file.h"
#include "studies/calibration_target.h"

namespace tuft::studies {

/// Fills in the curve of a target: which curve of the model, points in its units. `path` is the target's
/// place in the calibration. Throws InputError with place for unknown names, units and unreadable numbers.
void resolve_curve(const CalibrationFile& calibration, const TargetCurve& given, const std::string& path,
                   const std::vector<ModelCurve>& curves, Target& target);

}  // namespace tuft::studies

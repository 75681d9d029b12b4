#pragma once
/// A calibration in words and numbers: calibration.json, tables for the terminal, phrases of the page.
#include <string>

#include "studies/calibrate.h"

namespace tuft::app {

/// calibration.json of a calibration that ended or was stopped.
[[nodiscard]] std::string calibration_json(const studies::Problem& problem,
                                           const studies::CalibrationResult& result);
/// The same of one that has begun: what a later run into the folder compares itself with.
[[nodiscard]] std::string calibration_mark(const studies::Problem& problem);

/// Parameters and targets for the terminal.
[[nodiscard]] std::string calibration_tables(const studies::Problem& problem,
                                             const studies::CalibrationResult& result);

/// "all 7 targets are met", or which are not.
[[nodiscard]] std::string verdict(const studies::Problem& problem, const studies::CalibrationResult& result);

/// "20 to 35 %", "2 MPa ± 0.1 MPa", "curve of 12 points, ± 5 %" (of its largest value).
[[nodiscard]] std::string wanted(const studies::Target& target);
/// A target's value in an evaluation; "not reached" where it was not measured.
[[nodiscard]] std::string measured(const studies::Target& target, const studies::TargetOutcome& outcome);
/// A parameter's value with its unit.
[[nodiscard]] std::string parameter_text(const studies::Parameter& parameter, double value, int digits = 4);
/// "0.1 to 1.6 MPa, log".
[[nodiscard]] std::string bounds_text(const studies::Parameter& parameter);
/// Names of the parameters, as short as tells them apart: the last part of their keys, or all of it.
[[nodiscard]] std::vector<std::string> short_names(const studies::Problem& problem);
/// "at its lower bound", or nothing.
[[nodiscard]] std::string bound_text(const studies::CalibrationResult& result, std::size_t parameter);

}  // namespace tuft::app

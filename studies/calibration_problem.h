#pragma once
/// A calibration made ready: parameters with their units, models, targets; and its evaluation.
#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/calibration_file.h"
#include "core/material_file.h"
#include "studies/calibration_target.h"

namespace tuft::studies {

/// One fitted number, mapped to [0, 1] between its bounds.
struct Parameter {
  std::size_t material = 0;  ///< index into Problem::materials
  std::string material_name, key;
  std::string unit;  ///< SI; "1" for a plain number
  double lower = 0, upper = 0, start = 0;
  ParameterScale scale = ParameterScale::linear;

  [[nodiscard]] std::string name() const { return material_name + "." + key; }
  /// Value of scaled x in [0, 1]; exactly lower and upper at the ends.
  [[nodiscard]] double value(double x) const;
  [[nodiscard]] double scaled(double value) const;
};

struct Problem {
  CalibrationFile file;
  std::vector<MaterialFile> materials;
  std::vector<Parameter> parameters;
  std::vector<std::unique_ptr<CalibrationModel>> models;
  std::vector<std::string> model_names;
  std::vector<Target> targets;
  std::string fingerprint;  ///< changes with all that an evaluation's outcome depends on

  [[nodiscard]] std::vector<double> start() const;  ///< scaled
  /// The materials' texts with these values of the parameters; changed lines with `remark` where not empty.
  [[nodiscard]] std::vector<std::string> texts(std::span<const double> values,
                                               const std::string& remark = "") const;
  [[nodiscard]] bool has_curves() const;
};

/// Reads materials and models and resolves every name. Throws InputError: file:line, key, value, what to do.
[[nodiscard]] Problem make_problem(CalibrationFile file);

/// The models run with one set of parameters.
struct Evaluation {
  std::vector<double> values;  ///< of the parameters, SI
  std::vector<TargetOutcome> targets;
  double target_misfit = 0;  ///< sum over the targets
  double misfit = 0;         ///< with the distance from the start
  bool failed = false;       ///< a target could not be measured
  std::string error;         ///< why; several joined by "; "
  double seconds = 0;
  std::vector<ModelOutcome> outcomes;  ///< by model; empty where it was taken from a log
};

/// misfit = sum over the targets + regularisation x sum over the parameters of (x - x_start)^2, scaled.
[[nodiscard]] double total_misfit(const Problem& problem, double target_misfit,
                                  std::span<const double> values);

/// Evaluates several sets of parameters (SI values). Jobs that use one thread run beside each other, others
/// one after the other; the bits do not depend on it. Empty when `stop` was set meanwhile. InputError of a
/// material that cannot be is a failed evaluation; with `strict` it is thrown.
[[nodiscard]] std::vector<Evaluation> evaluate(const Problem& problem,
                                               const std::vector<std::vector<double>>& points,
                                               const std::atomic<bool>* stop, bool strict = false);

}  // namespace tuft::studies

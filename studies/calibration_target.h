#pragma once
/// Targets of a calibration, and how far a model's results are from them: pure functions.
///
/// Misfit of a target: weight x r^2, with r the distance in tolerances:
/// - number: (value - number)/tolerance;
/// - range: what the value lies outside of [low + m w, high - m w], over w/2; w = high - low, m the margin.
/// No
///   misfit inside, and smooth at the ends once squared;
/// - curve: root of the mean over its points of ((y - y_t)/(tolerance x max|y_t|))^2. Points that lie beyond
/// the
///   ends of the model's curve are compared with its straight continuation: a test that ends at a stress
///   ends at another strain with every set of parameters, and a misfit that jumped there would guide no
///   search. A fit that needs it does not count as met.
#include <span>
#include <string>
#include <vector>

#include "studies/calibration_model.h"

namespace tuft::studies {

enum class TargetForm { number, range, curve };

struct Target {
  std::size_t model = 0;  ///< index
  std::string model_name, quantity;
  std::string unit;  ///< of the quantity; of a curve that of y
  TargetForm form = TargetForm::number;
  double number = 0, tolerance = 0;      ///< number; of a curve tolerance is a share of its largest |y|
  double low = 0, high = 0, margin = 0;  ///< range
  std::vector<double> x, y;              ///< curve
  std::string x_unit;
  double weight = 1;
  std::string provenance;

  [[nodiscard]] std::string name() const { return model_name + "." + quantity; }
};

/// One target in one evaluation.
struct TargetOutcome {
  bool measured = false;  ///< the model gave what is needed
  double value = 0;       ///< in the target's unit; of a curve its largest deviation over the largest |y|
  double misfit = 0;      ///< weight x r^2
  bool beyond =
      false;  ///< of a curve: a point lies beyond the model's curve by over a hundredth of its width
  std::vector<double> residuals;  ///< whose squares add up to the misfit
};

[[nodiscard]] double number_residual(double value, double number, double tolerance);
[[nodiscard]] double range_residual(double value, double low, double high, double margin);

struct CurveValue {
  double y = 0;
  double beyond = 0;  ///< how far x lies beyond the curve's ends, over its width
};

/// y of a curve at x, straight between points, where the curve first passes x. Beyond an end it goes on
/// straight as over the twentieth of its points there. Empty farther out than its own width, or without two
/// points.
[[nodiscard]] std::optional<CurveValue> value_at(const ModelCurve& curve, double x);

/// How far the outcome of the target's model is from it. Without what is needed: not measured, `failure`.
[[nodiscard]] TargetOutcome judge(const Target& target, const ModelOutcome& outcome, double failure_misfit);

/// Whether a value is where it should be: within the tolerance, or in [low, high], the margin not counted.
[[nodiscard]] bool is_inside(const Target& target, const TargetOutcome& outcome);

/// The change of a value that is one tolerance: of a range half its width.
[[nodiscard]] double scale_of(const Target& target);

}  // namespace tuft::studies

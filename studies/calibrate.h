#pragma once
/// A calibration from its start to its fit: search, the fit as written, what the targets say of it.
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "studies/calibration_problem.h"
#include "studies/evaluation_log.h"
#include "studies/identifiability.h"

namespace tuft::studies {

/// One evaluation of the search, in order.
struct SearchPoint {
  double misfit = 0;
  double least = 0;  ///< up to here, of those that did not fail
  bool failed = false;
};

struct CalibrationResult {
  std::string status;      ///< "completed", "stopped"
  std::string end_reason;  ///< why the search ended
  Evaluation start, fitted;
  std::vector<bool> at_lower,
      at_upper;  ///< by parameter: the fit lies at its bound, to the search's tolerance
  std::vector<SearchPoint> search;
  std::size_t evaluations = 0;  ///< of all stages, each set of parameters once
  std::size_t reused = 0;       ///< of these, in the table before
  std::size_t failed = 0;
  std::vector<std::string> errors;        ///< of failed evaluations, each once
  std::vector<double> seconds_per_model;  ///< mean of those run now
  std::optional<Identifiability>
      identifiability;         ///< empty when stopped before, or where it cannot be measured
  std::string not_identified;  ///< why there is none
  double wall_seconds = 0;
};

struct CalibrationRequest {
  const Problem* problem = nullptr;
  EvaluationLog* log = nullptr;
  const std::atomic<bool>* stop = nullptr;
  /// After each evaluation of the search: how many, and the least misfit so far. May be empty.
  std::function<void(std::size_t, double)> on_progress;
};

/// Throws InputError for a start whose materials cannot be, RunError when the table cannot be written. Failed
/// models count as `failure_misfit`. Fitted numbers have 6 significant digits; the fit is evaluated with
/// them.
[[nodiscard]] CalibrationResult calibrate(const CalibrationRequest& request);

/// Scaled step of the central differences: small against any curvature of interest, large against the
/// interpolation of results. One-sided at bounds.
inline constexpr double difference_step = 0.01;

}  // namespace tuft::studies

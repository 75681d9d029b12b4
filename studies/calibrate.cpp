#include "studies/calibrate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.h"
#include "studies/optimiser.h"

namespace tuft::studies {
namespace {

using Clock = std::chrono::steady_clock;
using Point = std::vector<double>;

/// To six digits, as it is written, unless that would leave the bounds.
double rounded(const Parameter& parameter, double value) {
  const double six = std::stod(fmt::format("{:.6g}", value));
  return six < parameter.lower || six > parameter.upper ? value : six;
}

class Calibration {
 public:
  explicit Calibration(const CalibrationRequest& request)
      : request_(request), problem_(*request.problem), model_seconds_(problem_.models.size()) {}

  CalibrationResult run() {
    const auto start = Clock::now();
    attempt();
    result_.evaluations = request_.log->rows();
    result_.reused = request_.log->found_before();
    for (const double sum : model_seconds_)
      result_.seconds_per_model.push_back(runs_ > 0 ? sum / static_cast<double>(runs_) : 0);
    result_.wall_seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return result_;
  }

 private:
  void attempt() {
    result_.status = "stopped";
    result_.end_reason = "stopped";
    const auto first = take("start", {values_of(problem_.start())}, true, true);
    if (first.empty()) throw_run_error("stopped before the start was evaluated; nothing is written");
    best_ = result_.start = result_.fitted = first.front();
    const SearchEnd end =
        minimise(problem_.file.optimiser, problem_.start(), [this](const Point& x) { return misfit_at(x); });
    result_.end_reason = end.reason;
    finish_fit();
    if (end.stopped || stopped_) return;
    measure_identifiability();
    if (!stopped_) result_.status = "completed";
  }

  [[nodiscard]] Point values_of(const Point& scaled) const {
    Point values;
    for (std::size_t i = 0; i < scaled.size(); ++i) values.push_back(problem_.parameters[i].value(scaled[i]));
    return values;
  }

  /// Evaluates points, or takes them from the table unless their curves are needed. Empty: stopped.
  std::vector<Evaluation> take(const std::string& stage, const std::vector<Point>& points,
                               bool with_outcomes = false, bool strict = false) {
    std::vector<Evaluation> found(points.size());
    std::vector<Point> missing;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Evaluation* known = request_.log->find(points[i]);
      if (known != nullptr && !with_outcomes)
        found[i] = *known;
      else
        missing.push_back(points[i]);
    }
    std::vector<Evaluation> fresh;
    if (!missing.empty()) {
      fresh = evaluate(problem_, missing, request_.stop, strict);
      if (fresh.empty()) {
        stopped_ = true;
        return {};
      }
    }
    std::size_t next = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const bool in_table = request_.log->find(points[i]) != nullptr;
      if (found[i].values.empty()) {
        found[i] = std::move(fresh[next++]);
        count_run(found[i]);
        if (!in_table) request_.log->add(stage, found[i]);
      }
      count_failure(found[i]);
    }
    return found;
  }

  void count_run(const Evaluation& evaluation) {
    ++runs_;
    for (std::size_t m = 0; m < evaluation.outcomes.size(); ++m)
      model_seconds_[m] += evaluation.outcomes[m].seconds;
  }

  void count_failure(const Evaluation& evaluation) {
    if (!evaluation.failed || !failed_.insert(evaluation.values).second) return;
    ++result_.failed;
    if (std::ranges::find(result_.errors, evaluation.error) == result_.errors.end())
      result_.errors.push_back(evaluation.error);
  }

  void note_search(const Evaluation& evaluation) {
    const double before =
        result_.search.empty() ? std::numeric_limits<double>::infinity() : result_.search.back().least;
    result_.search.push_back({evaluation.misfit, std::min(before, evaluation.misfit), evaluation.failed});
  }

  std::optional<double> misfit_at(const Point& scaled) {
    const auto taken = take("search", {values_of(scaled)});
    if (taken.empty()) return std::nullopt;
    const Evaluation& evaluation = taken.front();
    note_search(evaluation);
    if (evaluation.misfit < best_.misfit) best_ = evaluation;
    if (request_.on_progress) request_.on_progress(result_.search.size(), result_.search.back().least);
    return evaluation.misfit;
  }

  /// The best point with its numbers as they are written. A stop that was asked for does not keep it from
  /// being evaluated where models are quick; otherwise the search's own values stand.
  void finish_fit() {
    Point values = best_.values;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = rounded(problem_.parameters[i], values[i]);
    const bool was_stopped = stopped_;
    const auto taken = take("fitted", {values}, true);
    result_.fitted = taken.empty() ? best_ : taken.front();
    stopped_ = stopped_ || was_stopped;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double x = problem_.parameters[i].scaled(result_.fitted.values[i]);
      const double near = 2 * problem_.file.optimiser.tolerance;
      result_.at_lower.push_back(x <= near);
      result_.at_upper.push_back(x >= 1 - near);
    }
  }

  /// Central differences of all targets' values, in tolerances.
  void measure_identifiability() {
    const std::size_t n = problem_.parameters.size();
    Point x;
    for (std::size_t i = 0; i < n; ++i) x.push_back(problem_.parameters[i].scaled(result_.fitted.values[i]));
    std::vector<Point> points;
    std::vector<double> widths;
    for (std::size_t i = 0; i < n; ++i) {
      Point low = x, high = x;
      low[i] = std::max(0.0, x[i] - difference_step);
      high[i] = std::min(1.0, x[i] + difference_step);
      widths.push_back(high[i] - low[i]);
      points.push_back(values_of(low));
      points.push_back(values_of(high));
    }
    const auto taken = take("sensitivity", points, problem_.has_curves());
    if (taken.empty()) return;
    for (const Evaluation& evaluation : taken)
      if (evaluation.failed) {
        result_.not_identified = "a model fails near the fit: " + evaluation.error;
        return;
      }
    Eigen::MatrixXd sensitivity;
    for (std::size_t i = 0; i < n; ++i) {
      const std::vector<double> low = in_tolerances(taken[2 * i]), high = in_tolerances(taken[2 * i + 1]);
      sensitivity.conservativeResize(static_cast<Eigen::Index>(low.size()), static_cast<Eigen::Index>(n));
      for (std::size_t k = 0; k < low.size(); ++k)
        sensitivity(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) =
            (high[k] - low[k]) / widths[i];
    }
    result_.identifiability = identify(sensitivity, problem_.file.regularisation);
  }

  /// Values of all targets in tolerances times the root of their weights; of a curve each of its residuals.
  [[nodiscard]] std::vector<double> in_tolerances(const Evaluation& evaluation) const {
    std::vector<double> values;
    for (std::size_t t = 0; t < problem_.targets.size(); ++t) {
      const Target& target = problem_.targets[t];
      const TargetOutcome& outcome = evaluation.targets[t];
      if (target.form == TargetForm::curve)
        values.insert(values.end(), outcome.residuals.begin(), outcome.residuals.end());
      else
        values.push_back(std::sqrt(target.weight) * outcome.value / scale_of(target));
    }
    return values;
  }

  const CalibrationRequest& request_;
  const Problem& problem_;
  CalibrationResult result_;
  Evaluation best_;
  std::vector<double> model_seconds_;
  std::set<Point> failed_;
  std::size_t runs_ = 0;
  bool stopped_ = false;
};

}  // namespace

CalibrationResult calibrate(const CalibrationRequest& request) {
  return Calibration(request).run();
}

}  // namespace tuft::studies

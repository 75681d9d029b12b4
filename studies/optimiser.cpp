#include "studies/optimiser.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>

#include "core/error.h"

namespace tuft::studies {
namespace {

constexpr double worth_going_on = 1e-3;  // of the misfit, that a local search must gain to be begun anew

nlopt::algorithm algorithm_of(OptimiserAlgorithm algorithm) {
  switch (algorithm) {
    case OptimiserAlgorithm::sbplx:
      return nlopt::LN_SBPLX;
    case OptimiserAlgorithm::cobyla:
      return nlopt::LN_COBYLA;
    case OptimiserAlgorithm::crs2:
      return nlopt::GN_CRS2_LM;
    case OptimiserAlgorithm::direct_l:
      return nlopt::GN_DIRECT_L;
    default:
      return nlopt::LN_BOBYQA;
  }
}

bool is_global(OptimiserAlgorithm algorithm) {
  return algorithm == OptimiserAlgorithm::crs2 || algorithm == OptimiserAlgorithm::direct_l;
}

/// Counts evaluations, keeps the best and knows when to end.
class Search {
 public:
  Search(const OptimiserChoice& choice, const std::vector<double>& start, const Objective& objective)
      : choice_(choice), objective_(objective), best_(start) {}

  SearchEnd run() {
    int left = choice_.max_evaluations;
    if (is_global(choice_.algorithm)) {
      const auto share = static_cast<int>(std::lround(choice_.global_share * choice_.max_evaluations));
      search(choice_.algorithm, std::max(1, share), choice_.initial_step);
      left = choice_.max_evaluations - count_;
    }
    const OptimiserAlgorithm local =
        is_global(choice_.algorithm) ? OptimiserAlgorithm::bobyqa : choice_.algorithm;
    double before = std::numeric_limits<double>::infinity();
    while (!stopped_ && left > 0 && (count_ == 0 || before - least_ > worth_going_on * least_)) {
      before = least_;
      search(local, left, choice_.initial_step);
      left = choice_.max_evaluations - count_;
    }
    if (left <= 0) reason_ = fmt::format("{} evaluations", choice_.max_evaluations);
    return {stopped_, stopped_ ? "stopped" : reason_};
  }

 private:
  void search(OptimiserAlgorithm algorithm, int evaluations, double step) {
    const auto n = static_cast<unsigned>(best_.size());
    nlopt::srand(static_cast<unsigned long>(choice_.seed));
    nlopt::opt opt(algorithm_of(algorithm), n);
    opt.set_lower_bounds(0.0);
    opt.set_upper_bounds(1.0);
    opt.set_maxeval(evaluations);
    opt.set_xtol_abs(choice_.tolerance);
    opt.set_initial_step(step);
    opt.set_min_objective(&Search::call, this);
    std::vector<double> x = best_;
    double value = 0;
    reason_ = fmt::format("parameters change by less than {:g} of their range", choice_.tolerance);
    try {
      const nlopt::result result = opt.optimize(x, value);
      if (result == nlopt::MAXEVAL_REACHED) reason_ = fmt::format("{} evaluations", evaluations);
    } catch (const nlopt::forced_stop&) {
      stopped_ = true;
    } catch (const nlopt::roundoff_limited&) {
      reason_ = "rounding hides any further gain";
    } catch (const std::exception& error) {
      // The best point so far stands: what NLopt gave up on says nothing against it.
      reason_ = fmt::format("NLopt gave up ({})", error.what());
    }
  }

  static double call(const std::vector<double>& x, std::vector<double>&, void* data) {
    return static_cast<Search*>(data)->value(x);
  }

  double value(std::vector<double> x) {
    // BOBYQA may leave the box by rounding.
    for (double& each : x) each = std::clamp(each, 0.0, 1.0);
    // Some algorithms ask on for a while after they were told to stop.
    const std::optional<double> value = stopped_ ? std::nullopt : objective_(x);
    stopped_ = !value.has_value();
    if (stopped_) throw nlopt::forced_stop();
    ++count_;
    if (*value < least_) {
      least_ = *value;
      best_ = x;
    }
    return *value;
  }

  const OptimiserChoice& choice_;
  const Objective& objective_;
  std::vector<double> best_;
  double least_ = std::numeric_limits<double>::infinity();
  int count_ = 0;
  bool stopped_ = false;
  std::string reason_;
};

}  // namespace

SearchEnd minimise(const OptimiserChoice& choice, const std::vector<double>& start,
                   const Objective& objective) {
  return Search(choice, start, objective).run();
}

}  // namespace tuft::studies

#include "studies/calibration_target.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tuft::studies {
namespace {

constexpr double little_beyond = 0.01, too_far_beyond = 1;  // of a curve's width in x
constexpr std::size_t end_share = 20;  // 1 / share of the points that give an end's slope

double largest_size(std::span<const double> values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

void judge_curve(const Target& target, const ModelCurve& curve, TargetOutcome& outcome) {
  const double size = largest_size(target.y);
  const double share = std::sqrt(target.weight / static_cast<double>(target.x.size()));
  for (std::size_t i = 0; i < target.x.size(); ++i) {
    const auto y = value_at(curve, target.x[i]);
    if (!y) return;
    const double deviation = (y->y - target.y[i]) / size;
    outcome.beyond = outcome.beyond || y->beyond > little_beyond;
    outcome.value = std::max(outcome.value, std::abs(deviation));
    outcome.residuals.push_back(share * deviation / target.tolerance);
  }
  outcome.measured = true;
}

}  // namespace

double number_residual(double value, double number, double tolerance) {
  return (value - number) / tolerance;
}

double range_residual(double value, double low, double high, double margin) {
  const double width = high - low, inner_low = low + margin * width, inner_high = high - margin * width;
  if (value < inner_low) return (value - inner_low) / (0.5 * width);
  if (value > inner_high) return (value - inner_high) / (0.5 * width);
  return 0;
}

std::optional<CurveValue> value_at(const ModelCurve& curve, double x) {
  const std::size_t count = curve.x.size();
  if (count < 2) return std::nullopt;
  for (std::size_t i = 1; i < count; ++i) {
    const double a = curve.x[i - 1], b = curve.x[i];
    if (a == b || x < std::min(a, b) || x > std::max(a, b)) continue;
    return CurveValue{curve.y[i - 1] + (curve.y[i] - curve.y[i - 1]) * (x - a) / (b - a), 0};
  }
  const auto [low, high] = std::ranges::minmax(curve.x);
  const double width = high - low, beyond = std::max(low - x, x - high) / width;
  if (!(beyond <= too_far_beyond)) return std::nullopt;
  // From the end of the list that is nearer, over some of its points.
  const bool at_front = std::abs(x - curve.x.front()) < std::abs(x - curve.x.back());
  const std::size_t reach = std::max<std::size_t>(1, count / end_share), end = at_front ? 0 : count - 1,
                    inner = at_front ? reach : count - 1 - reach;
  if (curve.x[end] == curve.x[inner]) return std::nullopt;
  const double slope = (curve.y[end] - curve.y[inner]) / (curve.x[end] - curve.x[inner]);
  return CurveValue{curve.y[end] + slope * (x - curve.x[end]), beyond};
}

TargetOutcome judge(const Target& target, const ModelOutcome& outcome, double failure_misfit) {
  TargetOutcome judged;
  if (target.form == TargetForm::curve) {
    const auto curve = std::ranges::find(outcome.curves, target.quantity, &ModelCurve::name);
    if (outcome.error.empty() && curve != outcome.curves.end()) judge_curve(target, *curve, judged);
  } else if (const auto found = outcome.results.find(target.quantity); found != outcome.results.end()) {
    judged.measured = true;
    judged.value = found->second;
    const double residual = target.form == TargetForm::number
                                ? number_residual(judged.value, target.number, target.tolerance)
                                : range_residual(judged.value, target.low, target.high, target.margin);
    judged.residuals = {std::sqrt(target.weight) * residual};
  }
  if (!judged.measured) {
    judged.value = 0;
    judged.residuals.clear();
    judged.misfit = target.weight * failure_misfit;
  }
  for (const double residual : judged.residuals) judged.misfit += residual * residual;
  return judged;
}

bool is_inside(const Target& target, const TargetOutcome& outcome) {
  if (!outcome.measured) return false;
  switch (target.form) {
    case TargetForm::number:
      return std::abs(outcome.value - target.number) <= target.tolerance;
    case TargetForm::range:
      return outcome.value >= target.low && outcome.value <= target.high;
    default:
      return outcome.value <= target.tolerance && !outcome.beyond;
  }
}

double scale_of(const Target& target) {
  switch (target.form) {
    case TargetForm::number:
      return target.tolerance;
    case TargetForm::range:
      return 0.5 * (target.high - target.low);
    default:
      return target.tolerance * largest_size(target.y);
  }
}

}  // namespace tuft::studies

#include "app/calibration_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/number_format.h"
#include "app/text_table.h"

namespace tuft::app {
namespace {

using studies::CalibrationResult;
using studies::Evaluation;
using studies::Parameter;
using studies::Problem;
using studies::Target;
using studies::TargetForm;
using studies::TargetOutcome;

constexpr const char* form_names[] = {"number", "range", "curve"};

/// A number that JSON has, or null.
nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json parameters_of(const Problem& problem, const CalibrationResult& result) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    const Parameter& p = problem.parameters[i];
    nlohmann::json entry{{"material", p.material_name},
                         {"key", p.key},
                         {"unit", p.unit},
                         {"lower", p.lower},
                         {"upper", p.upper},
                         {"scale", p.scale == ParameterScale::log ? "log" : "linear"},
                         {"start", result.start.values[i]},
                         {"fitted", result.fitted.values[i]},
                         {"at_lower_bound", bool{result.at_lower[i]}},
                         {"at_upper_bound", bool{result.at_upper[i]}}};
    if (result.identifiability) {
      entry["change_for_one_tolerance_alone"] = number(result.identifiability->alone[i]);
      entry["change_for_one_tolerance_together"] = number(result.identifiability->together[i]);
    }
    list.push_back(std::move(entry));
  }
  return list;
}

nlohmann::json outcome_of(const Target& target, const TargetOutcome& outcome) {
  return {{"value", outcome.measured ? number(outcome.value) : nlohmann::json(nullptr)},
          {"inside", studies::is_inside(target, outcome)},
          {"misfit", outcome.misfit}};
}

nlohmann::json targets_of(const Problem& problem, const CalibrationResult& result) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    const Target& target = problem.targets[t];
    nlohmann::json entry{{"model", target.model_name},
                         {"quantity", target.quantity},
                         {"form", form_names[static_cast<std::size_t>(target.form)]},
                         {"unit", target.form == TargetForm::curve ? "1" : target.unit},
                         {"weight", target.weight},
                         {"provenance", target.provenance},
                         {"start", outcome_of(target, result.start.targets[t])},
                         {"fitted", outcome_of(target, result.fitted.targets[t])}};
    if (target.form == TargetForm::number) entry["number"] = target.number;
    if (target.form == TargetForm::range) {
      entry["range"] = {target.low, target.high};
      entry["margin"] = target.margin;
    } else {
      entry["tolerance"] = target.tolerance;
    }
    list.push_back(std::move(entry));
  }
  return list;
}

nlohmann::json identifiability_of(const studies::Identifiability& found) {
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index i = 0; i < found.correlation.rows(); ++i) {
    nlohmann::json row = nlohmann::json::array();
    for (Eigen::Index j = 0; j < found.correlation.cols(); ++j)
      row.push_back(number(found.correlation(i, j)));
    rows.push_back(std::move(row));
  }
  return {{"determined_by_targets", found.determined}, {"correlation", std::move(rows)}};
}

/// Both ends in the unit of the larger: "0.5 to 4 MPa".
std::string range_text(double low, double high, const std::string& unit) {
  if (unit == "1") return fmt::format("{} to {}", format_input(low), format_input(high));
  const DisplayUnit shown = display_unit(unit, std::max(std::abs(low), std::abs(high)));
  return fmt::format("{} to {} {}", format_input(low * shown.factor), format_input(high * shown.factor),
                     shown.unit);
}

}  // namespace

std::string wanted(const Target& target) {
  switch (target.form) {
    case TargetForm::number:
      return fmt::format("{} ± {}", format_quantity(target.number, target.unit),
                         format_quantity(target.tolerance, target.unit));
    case TargetForm::range:
      return range_text(target.low, target.high, target.unit);
    default:
      return fmt::format("curve of {} points, ± {}", target.x.size(),
                         format_input(100 * target.tolerance) + " %");
  }
}

std::string measured(const Target& target, const TargetOutcome& outcome) {
  if (!outcome.measured) return "not reached";
  if (target.form == TargetForm::curve)
    return fmt::format("{} off{}", format_percent(outcome.value, 2),
                       outcome.beyond ? ", beyond its end" : "");
  return format_quantity(outcome.value, target.unit);
}

std::string parameter_text(const Parameter& parameter, double value, int digits) {
  return parameter.unit == "1" ? format_significant(value, digits)
                               : format_quantity(value, parameter.unit, digits);
}

std::string bounds_text(const Parameter& parameter) {
  return range_text(parameter.lower, parameter.upper, parameter.unit) +
         (parameter.scale == ParameterScale::log ? ", log" : "");
}

std::vector<std::string> short_names(const Problem& problem) {
  std::vector<std::string> names;
  for (const Parameter& p : problem.parameters) names.push_back(p.key.substr(p.key.rfind('.') + 1));
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::count(names.begin(), names.end(), names[i]) > 1) {
      for (std::size_t k = 0; k < names.size(); ++k) names[k] = problem.parameters[k].name();
      break;
    }
  return names;
}

std::string bound_text(const CalibrationResult& result, std::size_t parameter) {
  if (result.at_lower[parameter]) return "at its lower bound";
  return result.at_upper[parameter] ? "at its upper bound" : "";
}

std::string verdict(const Problem& problem, const CalibrationResult& result) {
  std::string missed;
  std::size_t count = 0;
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    if (studies::is_inside(problem.targets[t], result.fitted.targets[t])) continue;
    ++count;
    missed += fmt::format("{}{} ({}, wanted {})", missed.empty() ? "" : "; ", problem.targets[t].name(),
                          measured(problem.targets[t], result.fitted.targets[t]), wanted(problem.targets[t]));
  }
  const std::size_t all = problem.targets.size();
  if (count == 0) return all == 1 ? "the target is met" : fmt::format("all {} targets are met", all);
  return fmt::format("{} of {} targets not met: {}", count, all, missed);
}

std::string calibration_json(const Problem& problem, const CalibrationResult& result) {
  nlohmann::json cost = nlohmann::json::object();
  for (std::size_t m = 0; m < problem.models.size(); ++m)
    cost[problem.model_names[m]] = {{"kind", problem.models[m]->kind()},
                                    {"seconds", result.seconds_per_model[m]}};
  nlohmann::json json{{"status", result.status},
                      {"end", result.end_reason},
                      {"calibration", problem.file.file},
                      {"name", problem.file.name},
                      {"problem", problem.fingerprint},
                      {"verdict", verdict(problem, result)},
                      {"parameters", parameters_of(problem, result)},
                      {"targets", targets_of(problem, result)},
                      {"misfit",
                       {{"start", result.start.misfit},
                        {"fitted", result.fitted.misfit},
                        {"start_of_targets", result.start.target_misfit},
                        {"fitted_of_targets", result.fitted.target_misfit},
                        {"regularisation", problem.file.regularisation}}},
                      {"evaluations", result.evaluations},
                      {"evaluations_reused", result.reused},
                      {"evaluations_failed", result.failed},
                      {"errors", result.errors},
                      {"seconds_per_model", cost},
                      {"wall_s", result.wall_seconds},
                      {"version", TUFT_VERSION}};
  if (result.identifiability) json["identifiability"] = identifiability_of(*result.identifiability);
  return json.dump(2) + "\n";
}

std::string calibration_mark(const Problem& problem) {
  const nlohmann::json json{{"status", "running"},
                            {"calibration", problem.file.file},
                            {"name", problem.file.name},
                            {"problem", problem.fingerprint}};
  return json.dump(2) + "\n";
}

std::string calibration_tables(const Problem& problem, const CalibrationResult& result) {
  TextTable parameters({"parameter", "start", "fitted", "bounds", ""});
  for (std::size_t i = 0; i < problem.parameters.size(); ++i) {
    const Parameter& p = problem.parameters[i];
    parameters.add({p.name(), parameter_text(p, result.start.values[i]),
                    parameter_text(p, result.fitted.values[i]), bounds_text(p), bound_text(result, i)});
  }
  TextTable targets({"target", "wanted", "start", "fitted", ""});
  for (std::size_t t = 0; t < problem.targets.size(); ++t) {
    const Target& target = problem.targets[t];
    targets.add({target.name(), wanted(target), measured(target, result.start.targets[t]),
                 measured(target, result.fitted.targets[t]),
                 studies::is_inside(target, result.fitted.targets[t]) ? "met" : "not met"});
  }
  return parameters.text() + "\n" + targets.text();
}

}  // namespace tuft::app

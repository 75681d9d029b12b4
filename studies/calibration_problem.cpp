#include "studies/calibration_problem.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <set>

#include "core/error.h"
#include "core/nearest_name.h"
#include "core/scene_reader.h"
#include "core/units.h"
#include "studies/target_curve.h"

namespace tuft::studies {
namespace {

/// "did you mean" or what there is.
std::string choices(const std::string& given, const std::vector<std::string>& known) {
  const auto nearest = nearest_name(given, known);
  return nearest ? fmt::format("; did you mean \"{}\"?", *nearest)
                 : fmt::format("; there are {}", fmt::join(known, ", "));
}

std::size_t find_material(Problem& problem, const CalibrationParameter& given, const std::string& path) {
  for (std::size_t i = 0; i < problem.materials.size(); ++i)
    if (problem.materials[i].name == given.material) return i;
  const InputFolders folders(std::filesystem::path(problem.file.file).parent_path());
  const auto file = folders.find("materials", given.material);
  if (!file)
    problem.file.places.fail(path + ".material", "no such file in materials/" +
                                                     choices(given.material, folders.names("materials")));
  problem.materials.push_back(read_material_file(*file, given.material));
  return problem.materials.size() - 1;
}

/// The number that a parameter names.
const MaterialNumber& find_number(const Problem& problem, const MaterialFile& material,
                                  const std::string& key, const std::string& path) {
  const auto found = std::ranges::find(material.numbers, key, &MaterialNumber::key);
  if (found != material.numbers.end()) return *found;
  std::vector<std::string> known;
  for (const MaterialNumber& number : material.numbers) known.push_back(number.key);
  problem.file.places.fail(
      path, fmt::format("is no single number written in {}{}", material.path.string(), choices(key, known)));
}

void add_parameter(Problem& problem, std::size_t index) {
  const CalibrationParameter& given = problem.file.parameters[index];
  const std::string path = fmt::format("parameters.{}", index);
  Parameter parameter;
  parameter.material_name = given.material;
  parameter.key = given.key;
  parameter.scale = given.scale;
  parameter.material = find_material(problem, given, path);
  const MaterialFile& material = problem.materials[parameter.material];
  const MaterialNumber& number = find_number(problem, material, given.key, path + ".key");
  const Places& places = problem.file.places;
  parameter.unit = number.unit;
  parameter.lower = given_in(given.lower, number.unit);
  parameter.upper = given_in(given.upper, number.unit);
  parameter.start = given.start.is_given() ? given_in(given.start, number.unit) : number.value;
  for (const auto& [value, name] :
       {std::pair{parameter.lower, ".lower"}, std::pair{parameter.upper, ".upper"}})
    if (!number.allows(value)) places.fail(path + name, fmt::format("is out of the range of {}", given.key));
  if (!(parameter.lower < parameter.upper)) places.fail(path + ".upper", "must be above lower");
  if (parameter.scale == ParameterScale::log && !(parameter.lower > 0))
    places.fail(path + ".scale", "a logarithmic scale needs a lower bound above 0");
  if (parameter.start < parameter.lower || parameter.start > parameter.upper)
    places.fail(path + ".start",
                given.start.is_given()
                    ? "must lie between lower and upper"
                    : fmt::format("left out, and the file's {:g} {} does not lie between lower and upper",
                                  parameter.start, parameter.unit));
  problem.parameters.push_back(parameter);
}

MaterialTexts texts_by_name(const Problem& problem, const std::vector<std::string>& texts) {
  MaterialTexts by_name;
  for (std::size_t i = 0; i < texts.size(); ++i)
    by_name[problem.materials[i].name] = {problem.materials[i].path.string(), texts[i]};
  return by_name;
}

std::vector<double> start_values(const Problem& problem) {
  std::vector<double> values;
  for (const Parameter& parameter : problem.parameters) values.push_back(parameter.start);
  return values;
}

void add_models(Problem& problem) {
  const MaterialTexts texts = texts_by_name(problem, problem.texts(start_values(problem)));
  std::set<std::string> used;
  for (std::size_t i = 0; i < problem.file.models.size(); ++i) {
    const CalibrationModelEntry& entry = problem.file.models[i];
    Overrides settings;
    for (const Given& given : entry.settings) {
      const std::string text = given_text(given);
      const std::size_t equals = text.find('=');
      if (equals == std::string::npos || equals == 0)
        throw_bad_key(given.place.where, given.place.key, given.place.value,
                      "not of the form key=value, for example \"point.step=1e-3\"");
      settings.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    }
    const auto file = file_beside(problem.file, entry.file, fmt::format("models.{}.file", i));
    problem.models.push_back(make_calibration_model(file, settings, texts));
    problem.model_names.push_back(entry.name);
    for (const std::string& name : problem.models.back()->materials()) used.insert(name);
  }
  for (std::size_t i = 0; i < problem.parameters.size(); ++i)
    if (!used.contains(problem.parameters[i].material_name))
      problem.file.places.fail(fmt::format("parameters.{}.material", i),
                               fmt::format("no model uses it; they use {}", fmt::join(used, ", ")));
}

void add_target(Problem& problem, std::size_t index) {
  const CalibrationTarget& given = problem.file.targets[index];
  const Places& places = problem.file.places;
  const std::string path = fmt::format("targets.{}", index);
  Target target;
  const auto model = std::ranges::find(problem.model_names, given.model);
  if (model == problem.model_names.end())
    places.fail(path + ".model", "no such model" + choices(given.model, problem.model_names));
  target.model = static_cast<std::size_t>(model - problem.model_names.begin());
  target.model_name = given.model;
  target.quantity = given.quantity;
  target.weight = given.weight;
  target.provenance = given.provenance;
  const CalibrationModel& of = *problem.models[target.model];
  if (given.curve) {
    resolve_curve(problem.file, *given.curve, path, of.curve_names(), target);
  } else {
    const auto units = of.result_units();
    std::vector<std::string> known;
    for (const auto& [name, unit] : units) known.push_back(name);
    const auto unit = units.find(given.quantity);
    if (unit == units.end())
      places.fail(path + ".quantity", "no such result of this model" + choices(given.quantity, known));
    target.unit = unit->second;
    target.form = given.range.empty() ? TargetForm::number : TargetForm::range;
  }
  if (target.form == TargetForm::number) {
    target.number = given_in(given.number, target.unit);
    target.tolerance = given_in(given.tolerance, target.unit);
    if (!(target.tolerance > 0)) places.fail(path + ".tolerance", "must be above 0");
  } else if (target.form == TargetForm::range) {
    target.low = given_in(given.range[0], target.unit);
    target.high = given_in(given.range[1], target.unit);
    target.margin = given.margin;
    if (!(target.low < target.high)) places.fail(path + ".range", "the smaller value comes first");
  }
  problem.targets.push_back(std::move(target));
}

std::string fingerprint_of(const Problem& problem) {
  std::string text = fmt::format("failure {}\n", problem.file.optimiser.failure_misfit);
  for (const Parameter& p : problem.parameters) text += fmt::format("{}\n", p.name());
  const MaterialTexts texts = texts_by_name(problem, problem.texts(start_values(problem)));
  for (const auto& model : problem.models) text += model->resolved(texts);
  for (const Target& t : problem.targets)
    text +=
        fmt::format("{} {} {} {} {} {} {} {} {} {}\n", t.name(), static_cast<int>(t.form), t.number,
                    t.tolerance, t.low, t.high, t.margin, t.weight, fmt::join(t.x, " "), fmt::join(t.y, " "));
  return content_hash(text);
}

/// Jobs of one point; empty, with the reason, where its materials cannot be.
struct Prepared {
  std::vector<CalibrationModel::Job> jobs;
  std::string error;
};

Prepared prepare(const Problem& problem, const std::vector<double>& values, bool strict) {
  Prepared prepared;
  try {
    const MaterialTexts texts = texts_by_name(problem, problem.texts(values));
    for (const auto& model : problem.models) prepared.jobs.push_back(model->prepare(texts));
  } catch (const InputError& error) {
    if (strict) throw;
    prepared.jobs.clear();
    prepared.error = error.what();
  }
  return prepared;
}

/// Several models often fail for one reason.
void add_error(std::string& errors, const std::string& error) {
  if (error.empty() || errors.find(error) != std::string::npos) return;
  errors += (errors.empty() ? "" : "; ") + error;
}

Evaluation judge_all(const Problem& problem, std::vector<double> values, std::vector<ModelOutcome> outcomes) {
  Evaluation evaluation;
  evaluation.values = std::move(values);
  for (const Target& target : problem.targets) {
    const ModelOutcome& outcome = outcomes[target.model];
    evaluation.targets.push_back(judge(target, outcome, problem.file.optimiser.failure_misfit));
    const TargetOutcome& judged = evaluation.targets.back();
    evaluation.target_misfit += judged.misfit;
    if (judged.measured) continue;
    evaluation.failed = true;
    add_error(evaluation.error, outcome.error.empty() ? target.name() + " was not reached" : outcome.error);
  }
  for (const ModelOutcome& outcome : outcomes) evaluation.seconds += outcome.seconds;
  evaluation.misfit = total_misfit(problem, evaluation.target_misfit, evaluation.values);
  evaluation.outcomes = std::move(outcomes);
  return evaluation;
}

}  // namespace

double Parameter::value(double x) const {
  if (x <= 0) return lower;
  if (x >= 1) return upper;
  const double between =
      scale == ParameterScale::log ? lower * std::pow(upper / lower, x) : lower + x * (upper - lower);
  return std::clamp(between, lower, upper);
}

double Parameter::scaled(double value) const {
  const double x = scale == ParameterScale::log ? std::log(value / lower) / std::log(upper / lower)
                                                : (value - lower) / (upper - lower);
  return std::clamp(x, 0.0, 1.0);
}

std::vector<double> Problem::start() const {
  std::vector<double> x;
  for (const Parameter& parameter : parameters) x.push_back(parameter.scaled(parameter.start));
  return x;
}

std::vector<std::string> Problem::texts(std::span<const double> values, const std::string& remark) const {
  std::vector<std::string> texts;
  for (std::size_t m = 0; m < materials.size(); ++m) {
    std::map<std::string, double> changed;
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (parameters[i].material == m) changed[parameters[i].key] = values[i];
    texts.push_back(with_numbers(materials[m], changed, remark));
  }
  return texts;
}

bool Problem::has_curves() const {
  return std::ranges::any_of(targets, [](const Target& t) { return t.form == TargetForm::curve; });
}

Problem make_problem(CalibrationFile file) {
  Problem problem;
  problem.file = std::move(file);
  for (std::size_t i = 0; i < problem.file.parameters.size(); ++i) add_parameter(problem, i);
  add_models(problem);
  for (std::size_t i = 0; i < problem.file.targets.size(); ++i) add_target(problem, i);
  problem.fingerprint = fingerprint_of(problem);
  return problem;
}

double total_misfit(const Problem& problem, double target_misfit, std::span<const double> values) {
  double distance = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Parameter& p = problem.parameters[i];
    const double away = p.scaled(values[i]) - p.scaled(p.start);
    distance += away * away;
  }
  return target_misfit + problem.file.regularisation * distance;
}

std::vector<Evaluation> evaluate(const Problem& problem, const std::vector<std::vector<double>>& points,
                                 const std::atomic<bool>* stop, bool strict) {
  const std::size_t models = problem.models.size();
  std::vector<std::vector<ModelOutcome>> outcomes(points.size(), std::vector<ModelOutcome>(models));
  // Reading is for one thread; runs are not.
  std::vector<Prepared> prepared;
  for (const std::vector<double>& values : points) prepared.push_back(prepare(problem, values, strict));
  const auto run = [&](std::size_t point, std::size_t model) {
    if (!prepared[point].error.empty())
      outcomes[point][model].error = prepared[point].error;
    else
      outcomes[point][model] = prepared[point].jobs[model](stop);
  };
  const auto count = static_cast<std::ptrdiff_t>(points.size() * models);
  std::vector<std::exception_ptr> defects(points.size() * models);  // must not leave the parallel loop
#pragma omp parallel for schedule(dynamic)
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (problem.models[at % models]->parallel_inside()) continue;
    try {
      run(at / models, at % models);
    } catch (...) {
      defects[at] = std::current_exception();
    }
  }
  for (const std::exception_ptr& defect : defects)
    if (defect) std::rethrow_exception(defect);
  const auto stopped = [&] { return stop != nullptr && stop->load(); };
  for (std::size_t k = 0; k < points.size() * models && !stopped(); ++k)
    if (problem.models[k % models]->parallel_inside()) run(k / models, k % models);
  if (stopped()) return {};
  std::vector<Evaluation> evaluations;
  for (std::size_t p = 0; p < points.size(); ++p)
    evaluations.push_back(judge_all(problem, points[p], std::move(outcomes[p])));
  return evaluations;
}

}  // namespace tuft::studies

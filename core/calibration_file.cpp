#include "core/calibration_file.h"

#include <algorithm>

#include "core/error.h"
#include "core/scene_files.h"
#include "core/scene_schema.h"
#include "core/toml_reader.h"

namespace tuft {
namespace schema {
namespace {

constexpr std::string_view scales[] = {"linear", "log"};
constexpr std::string_view algorithms[] = {"bobyqa", "sbplx", "cobyla", "crs2", "direct_l"};
constexpr Range fraction{0, 1, true, true};

void describe_optimiser(KeyVisitor& keys, OptimiserChoice& optimiser) {
  keys.enumeration(
      {"algorithm",
       "without derivatives (NLopt): bobyqa, sbplx, cobyla from the start; crs2, direct_l over the "
       "whole box, then bobyqa"},
      optimiser.algorithm, algorithms);
  keys.integer({"max_evaluations", "at most so many"}, optimiser.max_evaluations, {1, 1e6, false, false});
  keys.number({"tolerance", "ends when parameters, scaled to [0, 1], change by less"}, optimiser.tolerance,
              fraction);
  keys.number({"initial_step", "first changes of parameters scaled to [0, 1]"}, optimiser.initial_step,
              {0, 0.5, true, false});
  keys.number({"global_share", "crs2, direct_l: share of the evaluations for them"}, optimiser.global_share,
              fraction);
  keys.integer({"seed", "crs2: of its random numbers"}, optimiser.seed, {1, 4294967295.0, false, false});
  keys.number({"failure_misfit", "of each target of a model that fails"}, optimiser.failure_misfit, positive);
}

void describe_parameter(KeyVisitor& keys, CalibrationParameter& parameter) {
  keys.text(required("material", "a file of materials/"), parameter.material);
  keys.text(required("key", "a number of that file, for example continuum.unloading_ratio"), parameter.key);
  keys.given(required("lower", "smallest value"), parameter.lower, "a value in a unit of the key");
  keys.given(required("upper", "largest value"), parameter.upper, "a value in a unit of the key");
  keys.given({"start", "where the search begins; left out: the file's number"}, parameter.start,
             "a value in a unit of the key");
  keys.enumeration({"scale", "in which [lower, upper] is mapped to [0, 1]"}, parameter.scale, scales);
}

void describe_model(KeyVisitor& keys, CalibrationModelEntry& model) {
  keys.text(required("name", "by which targets name it"), model.name);
  keys.text(
      required("file", "a test of a point, or a scene of rig oedometer or direct_shear; beside this file"),
      model.file);
  if (keys.wants({"set", ""}, !model.settings.empty()))
    keys.given_list({"set", "keys of that file to override, as given to --set"}, model.settings,
                    "a list of texts \"key=value\"");
}

void describe_curve(KeyVisitor& keys, TargetCurve& curve) {
  keys.text({"file", "comma-separated columns under their names; beside this file"}, curve.file);
  keys.text({"x_column", "left out: the first"}, curve.x_column);
  keys.text({"y_column", "left out: the second"}, curve.y_column);
  if (keys.wants({"x", ""}, !curve.x.empty()))
    keys.given_list({"x", "in place of file"}, curve.x, "a list of numbers");
  if (keys.wants({"y", ""}, !curve.y.empty()))
    keys.given_list({"y", "in place of file"}, curve.y, "a list of numbers");
  keys.text({"x_unit", "unit of x"}, curve.x_unit);
  keys.text({"y_unit", "unit of y"}, curve.y_unit);
  keys.number({"tolerance", "over the largest size of y"}, curve.tolerance, positive);
}

void describe_target(KeyVisitor& keys, CalibrationTarget& target) {
  keys.text(required("model", "the name of a model"), target.model);
  keys.text(required("quantity", "a result of that model, or one of its curves"), target.quantity);
  keys.given({"number", "a target that is a number"}, target.number, "a value in a unit of the quantity");
  keys.given({"tolerance", "of a number: misfit is ((value - number)/tolerance)^2"}, target.tolerance,
             "a value in a unit of the quantity");
  if (keys.wants({"range", ""}, !target.range.empty()))
    keys.given_list({"range", "a target that is a range: no misfit inside"}, target.range,
                    "two values in a unit of the quantity");
  keys.number({"margin", "of a range: the fit keeps this share of it from each end"}, target.margin,
              {0, 0.5, false, true});
  keys.number({"weight", "of the target's misfit"}, target.weight, positive);
  keys.text(required("provenance", "where the target comes from: \"literature: ...\""), target.provenance);
  keys.optional_table<TargetCurve>({"curve", "a target that is a curve"}, target.curve, describe_curve);
}

}  // namespace

void describe_calibration(KeyVisitor& keys, CalibrationFile& calibration) {
  keys.table({"calibration", "as a whole"}, [&](KeyVisitor& inside) {
    inside.text({"name", "a name for reports; left out: the file's"}, calibration.name);
    inside.number(
        {"regularisation",
         "weight of the squared distance from the start, parameters scaled to [0, 1]: decides where "
         "the targets do not"},
        calibration.regularisation, non_negative);
  });
  keys.table({"optimiser", "how the fit is searched"},
             [&](KeyVisitor& inside) { describe_optimiser(inside, calibration.optimiser); });
  keys.list<CalibrationParameter>(required("parameters", "what is fitted"), calibration.parameters,
                                  describe_parameter);
  keys.list<CalibrationModelEntry>(required("models", "what is run"), calibration.models, describe_model);
  keys.list<CalibrationTarget>(required("targets", "what is to come out"), calibration.targets,
                               describe_target);
}

}  // namespace schema

namespace {

/// A key that cannot stand without, or beside, another.
void check_form(const CalibrationTarget& target, const std::string& path, const Places& places) {
  const int forms =
      int{target.number.is_given()} + int{!target.range.empty()} + int{target.curve.has_value()};
  if (forms != 1)
    places.fail(path, "give one of number (with tolerance), range and curve: what is to come out");
  if (target.number.is_given() && !target.tolerance.is_given())
    places.fail(path + ".number", "needs a tolerance beside it, in the same dimension");
  if (!target.number.is_given() && target.tolerance.is_given())
    places.fail(path + ".tolerance", "is for a number; a curve has its own, a range has none");
  if (!target.range.empty() && target.range.size() != 2)
    places.fail(path + ".range", fmt::format("two values are needed, not {}", target.range.size()));
  if (target.range.empty() && places.has(path + ".margin")) places.fail(path + ".margin", "is for a range");
}

void check_curve(const TargetCurve& curve, const std::string& path, const Places& places) {
  const bool listed = !curve.x.empty() || !curve.y.empty();
  if (listed == !curve.file.empty()) places.fail(path, "give either file, or x and y");
  if (listed && curve.x.size() != curve.y.size())
    places.fail(path + ".y", fmt::format("{} numbers, but x has {}", curve.y.size(), curve.x.size()));
  if (listed && !(curve.x_column.empty() && curve.y_column.empty()))
    places.fail(path, "x_column and y_column are for a file");
}

void check_provenance(const std::string& provenance, const std::string& path, const Places& places) {
  const std::size_t colon = provenance.find(':');
  const std::string word = provenance.substr(0, colon);
  const bool known = std::ranges::find(provenance_words, word) != std::end(provenance_words);
  if (!known || colon == std::string::npos ||
      provenance.find_first_not_of(' ', colon + 1) == std::string::npos)
    places.fail(path, fmt::format("begin with one of {}, a colon, and then the source",
                                  fmt::join(provenance_words, ", ")));
}

void check_calibration(const CalibrationFile& c) {
  const Places& places = c.places;
  for (std::size_t i = 0; i < c.parameters.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (c.parameters[i].material == c.parameters[j].material && c.parameters[i].key == c.parameters[j].key)
        places.fail(fmt::format("parameters.{}.key", i), "named twice for this material; leave one out");
  for (std::size_t i = 0; i < c.models.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (c.models[i].name == c.models[j].name)
        places.fail(fmt::format("models.{}.name", i), "given twice; choose another");
  for (std::size_t i = 0; i < c.targets.size(); ++i) {
    const CalibrationTarget& target = c.targets[i];
    const std::string path = fmt::format("targets.{}", i);
    check_provenance(target.provenance, path + ".provenance", places);
    check_form(target, path, places);
    if (target.curve) check_curve(*target.curve, path + ".curve", places);
    for (std::size_t j = 0; j < i; ++j)
      if (c.targets[j].model == target.model && c.targets[j].quantity == target.quantity)
        places.fail(path + ".quantity", "is a target already; leave one out");
  }
}

}  // namespace

CalibrationFile read_calibration(const std::filesystem::path& file) {
  CalibrationFile calibration;
  calibration.file = file.string();
  const toml::table input = schema::parse_toml(read_text_file(file), calibration.file);
  schema::Document document;
  document.file = calibration.file;
  document.places = &calibration.places;
  document.of_scene = false;
  schema::TomlReader::read(document, input, "", "", true, [&](schema::KeyVisitor& keys) {
    schema::describe_calibration(keys, calibration);
  });
  if (calibration.name.empty()) calibration.name = file.stem().string();
  check_calibration(calibration);
  return calibration;
}

std::filesystem::path file_beside(const CalibrationFile& calibration, const std::string& name,
                                  const std::string& key) {
  const std::filesystem::path found = std::filesystem::path(calibration.file).parent_path() / name;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(found, ignored))
    calibration.places.fail(key, "no such file; it is looked for beside the calibration");
  return found;
}

}  // namespace tuft

#include "core/toml_reader.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/error.h"
#include "core/nearest_name.h"
#include "core/units.h"

namespace tuft::schema {
namespace {

std::string join(std::string_view prefix, std::string_view name) {
  return prefix.empty() ? std::string(name) : fmt::format("{}.{}", prefix, name);
}

std::string quoted_list(KeyVisitor::Names names) {
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    list += fmt::format("{}\"{}\"", i == 0 ? "" : (i + 1 == names.size() ? " or " : ", "), names[i]);
  return list;
}

std::string suggestion(std::string_view given, const std::vector<std::string>& known) {
  const auto nearest = nearest_name(given, known);
  return nearest ? fmt::format("; did you mean \"{}\"?", *nearest) : std::string();
}

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw_input_error("{}:{}: not readable as TOML: {}", file, error.source().begin.line,
                      error.description());
  }
}

std::string value_text(const toml::node& node) {
  std::string text;
  if (node.is_string()) {
    text = fmt::format("\"{}\"", *node.value<std::string>());
  } else {
    std::ostringstream stream;
    node.visit([&stream](const auto& value) { stream << value; });
    text = stream.str();
  }
  constexpr std::size_t longest = 60;
  return text.size() <= longest ? text : text.substr(0, longest - 3) + "...";
}

std::string Document::where(const toml::node* node, const std::string& key) const {
  for (const std::string& set : overridden) {
    const bool inside = key == set || key.starts_with(fmt::format("{}.", set));
    if (inside) return "--set";
    // A table that only --set made has no line.
    const bool around = set.starts_with(fmt::format("{}.", key));
    if (around && node != nullptr && node->source().begin.line == 0) return "--set";
  }
  if (node == nullptr || node->source().begin.line == 0) return file;
  return fmt::format("{}:{}", file, node->source().begin.line);
}

void TomlReader::read(Document& document, const toml::table& table, const std::string& shown,
                      const std::string& path, bool complete, const Visit& visit) {
  document.places->note(path, {document.where(&table, shown), shown, ""});
  TomlReader reader(document, &table, shown, path, complete);
  visit(reader);
  reader.refuse_unknown_keys();
  if (!document.missing.empty()) throw InputError(document.missing.front());
}

void TomlReader::refuse_unknown_keys() const {
  if (table_ == nullptr) return;
  for (const auto& [name, node] : *table_) {
    const std::string given(name.str());
    if (std::find(known_.begin(), known_.end(), given) != known_.end()) continue;
    const std::string key = shown(given);
    // A key of the language all the same, but of other rigs.
    const std::vector<std::string> of_scenes = document_.of_scene ? known_keys() : std::vector<std::string>{};
    for (const std::string& full : of_scenes)
      if (full == key || full.starts_with(key + ".") || full.starts_with(key + "[]."))
        throw_bad_key(document_.where(&node, key), key,
                      node.is_table() || node.is_array_of_tables() ? "" : value_text(node),
                      "is not for the rig of this scene; leave it out");
    std::string hint = suggestion(given, known_);
    if (hint.empty()) {
      // Right key, wrong table?
      for (const std::string& full : of_scenes)
        if (full.ends_with(fmt::format(".{}", given))) hint = fmt::format("; did you mean {}?", full);
    }
    if (hint.empty() && !known_.empty()) hint = fmt::format("; known here: {}", fmt::join(known_, ", "));
    throw_bad_key(document_.where(&node, key), key, node.is_table() ? "" : value_text(node),
                  fmt::format("unknown key{}", hint));
  }
}

std::string TomlReader::shown(std::string_view name) const {
  return join(shown_, name);
}
std::string TomlReader::path(std::string_view name) const {
  return join(path_, name);
}

void TomlReader::fail(std::string_view name, const toml::node& node, std::string_view problem) const {
  throw_bad_key(document_.where(&node, shown(name)), shown(name), value_text(node), problem);
}

void TomlReader::know(std::string_view name) {
  if (std::find(known_.begin(), known_.end(), name) == known_.end()) known_.emplace_back(name);
}

const toml::node* TomlReader::find(const Key& key, std::string_view wanted) {
  know(key.name);
  const toml::node* node = table_ == nullptr ? nullptr : table_->get(key.name);
  if (node != nullptr) {
    document_.places->note(path(key.name), {document_.where(node, shown(key.name)), shown(key.name),
                                            node->is_table() ? std::string() : value_text(*node)});
  } else if (key.required && complete_) {
    document_.missing.push_back(
        fmt::format("{}: {}: missing; add it: {}", document_.where(table_, shown_), shown(key.name), wanted));
  }
  return node;
}

double TomlReader::to_quantity(std::string_view name, const toml::node& node, std::string_view unit,
                               const Range& range) const {
  if (node.is_number()) {
    fail(name, node,
         fmt::format("a plain number; {} with its unit in quotes is needed, for example \"{}\"",
                     dimension_in_words(unit), example_quantity(unit)));
  }
  const auto text = node.value<std::string>();
  if (!text || !node.is_string())
    fail(name, node,
         fmt::format("{} in quotes is needed, for example \"{}\"", dimension_in_words(unit),
                     example_quantity(unit)));
  double value = 0;
  try {
    value = quantity_from_text(*text, unit);
  } catch (const InputError& error) {
    fail(name, node, error.what());
  }
  if (!range.holds(value)) fail(name, node, fmt::format("must be {} {}", range.in_words(), unit));
  return value;
}

double TomlReader::to_number(std::string_view name, const toml::node& node, const Range& range) const {
  if (!node.is_number()) fail(name, node, "a plain number without quotes is needed");
  const double value = *node.value<double>();
  if (!std::isfinite(value)) fail(name, node, "must be a finite number");
  if (!range.holds(value)) fail(name, node, fmt::format("must be {}", range.in_words()));
  return value;
}

std::string TomlReader::to_text(std::string_view name, const toml::node& node) const {
  if (!node.is_string()) fail(name, node, "text in quotes is needed");
  return *node.value<std::string>();
}

Index TomlReader::to_material(std::string_view name, const toml::node& node) const {
  const Place place{document_.where(&node, shown(name)), shown(name), value_text(node)};
  return document_.find_material(to_text(name, node), place);
}

const toml::array& TomlReader::to_pair(std::string_view name, const toml::node& node,
                                       std::string_view of) const {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != 2)
    fail(name, node,
         fmt::format("a list of two {} is needed{}", of,
                     array == nullptr ? std::string() : fmt::format(", not of {}", array->size())));
  return *array;
}

void TomlReader::quantity(const Key& key, double& value, std::string_view unit, const Range& range) {
  const toml::node* node =
      find(key, fmt::format("{}, for example \"{}\"", dimension_in_words(unit), example_quantity(unit)));
  if (node != nullptr) value = to_quantity(key.name, *node, unit, range);
}

void TomlReader::number(const Key& key, double& value, const Range& range) {
  const toml::node* node = find(key, "a plain number");
  if (node != nullptr) value = to_number(key.name, *node, range);
}

void TomlReader::whole(const Key& key, std::int64_t& value, const Range& range) {
  const toml::node* node = find(key, "a whole number");
  if (node == nullptr) return;
  if (!node->is_integer()) fail(key.name, *node, "a whole number without quotes is needed");
  value = *node->value<std::int64_t>();
  if (!range.holds(static_cast<double>(value)))
    fail(key.name, *node, fmt::format("must be {}", range.in_words()));
}

void TomlReader::flag(const Key& key, bool& value) {
  const toml::node* node = find(key, "true or false");
  if (node == nullptr) return;
  if (!node->is_boolean()) fail(key.name, *node, "true or false is needed, without quotes");
  value = *node->value<bool>();
}

void TomlReader::toggle(const Key& key, Switch& value) {
  const toml::node* node = find(key, "true, false or \"auto\"");
  if (node == nullptr) return;
  if (node->is_boolean())
    value = *node->value<bool>() ? Switch::on : Switch::off;
  else if (node->is_string() && *node->value<std::string>() == "auto")
    value = Switch::automatic;
  else
    fail(key.name, *node, "true, false or \"auto\" is needed");
}

void TomlReader::text(const Key& key, std::string& value) {
  const toml::node* node = find(key, "text in quotes");
  if (node != nullptr) value = to_text(key.name, *node);
}

void TomlReader::choice(const Key& key, std::string& value, Names names) {
  const toml::node* node = find(key, quoted_list(names));
  if (node == nullptr) return;
  value = to_text(key.name, *node);
  if (std::find(names.begin(), names.end(), value) != names.end()) return;
  const auto nearest = nearest_name(value, names);
  fail(key.name, *node,
       names.size() == 1 || !nearest
           ? fmt::format("unknown; {} is needed", quoted_list(names))
           : fmt::format("unknown; did you mean \"{}\"? {} is needed", *nearest, quoted_list(names)));
}

void TomlReader::quantities(const Key& key, std::array<double, 2>& values, std::string_view unit,
                            const Range& range) {
  const std::string example = fmt::format("[\"{0}\", \"{0}\"]", example_quantity(unit));
  const toml::node* node =
      find(key, fmt::format("two of {}, for example {}", dimension_in_words(unit), example));
  if (node == nullptr) return;
  const toml::array& array = to_pair(key.name, *node, fmt::format("quantities, for example {},", example));
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string name = fmt::format("{}.{}", key.name, i);
    values[i] = to_quantity(name, array[i], unit, range);
    document_.places->note(path(name),
                           {document_.where(&array[i], shown(name)), shown(name), value_text(array[i])});
  }
}

void TomlReader::quantity_list(const Key& key, std::vector<double>& values, std::string_view unit,
                               const Range& range) {
  const std::string example = fmt::format("[\"{}\"]", example_quantity(unit));
  const toml::node* node =
      find(key, fmt::format("a list of {}, for example {}", dimension_in_words(unit), example));
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty())
    fail(key.name, *node, fmt::format("a list of quantities is needed, for example {}", example));
  values.clear();
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string name = fmt::format("{}.{}", key.name, i);
    values.push_back(to_quantity(name, (*array)[i], unit, range));
    document_.places->note(
        path(name), {document_.where(&(*array)[i], shown(name)), shown(name), value_text((*array)[i])});
  }
}

void TomlReader::curve(const Key& key, Curve& curve, const CurveAxes& axes) {
  const std::string unit_like = axes.unit() == "m" ? "mm" : "kPa";
  const std::string wanted =
      fmt::format("{{ unit = \"{}\", {} = [...], {} = [...] }}", unit_like, axes.x_name, axes.y_name);
  const toml::node* node = find(key, wanted);
  if (node == nullptr) return;
  if (!node->is_table()) fail(key.name, *node, "a curve is needed: " + wanted);
  // A curve is given whole, even where other keys may be left out.
  TomlReader inside(document_, node->as_table(), shown(key.name), path(key.name), true);
  const toml::node* unit = inside.find(required("unit", ""), fmt::format("\"{}\"", unit_like));
  const toml::node* x = inside.find(required(axes.x_name, ""), "[0.0, ...]");
  const toml::node* y = inside.find(required(axes.y_name, ""), "[0.0, ...]");
  inside.refuse_unknown_keys();
  if (unit == nullptr || x == nullptr || y == nullptr) return;
  const std::string unit_name = inside.to_text("unit", *unit);
  const auto row = [&](std::string_view name, const toml::node& list, std::string_view si_unit,
                       const Range& range) {
    const toml::array* array = list.as_array();
    if (array == nullptr || array->empty()) inside.fail(name, list, "a list of numbers is needed");
    double factor = 1;
    try {
      if (!si_unit.empty()) factor = unit_factor(unit_name, si_unit);
    } catch (const InputError& error) {
      inside.fail("unit", *unit, error.what());
    }
    std::vector<double> values;
    for (std::size_t i = 0; i < array->size(); ++i)
      values.push_back(
          scale_by_unit(inside.to_number(fmt::format("{}.{}", name, i), (*array)[i], range), factor));
    return values;
  };
  curve.x = row(axes.x_name, *x, axes.x_unit, non_negative);
  curve.y = row(axes.y_name, *y, axes.y_unit, axes.y_range);
  if (curve.x.size() != curve.y.size())
    inside.fail(axes.y_name, *y,
                fmt::format("{} numbers, but {} has {}", curve.y.size(), axes.x_name, curve.x.size()));
  for (std::size_t i = 1; i < curve.x.size(); ++i)
    if (!(curve.x[i] > curve.x[i - 1]))
      inside.fail(fmt::format("{}.{}", axes.x_name, i), (*x->as_array())[i],
                  "must be above the number before it");
}

void TomlReader::numbers_by_name(const Key& key, std::map<std::string, double>& values, const Range& range) {
  const toml::node* node = find(key, "{ name = number }");
  if (node == nullptr) return;
  if (!node->is_table()) fail(key.name, *node, "a table is needed: { name = number }");
  values.clear();
  for (const auto& [name, value] : *node->as_table()) {
    const std::string full = fmt::format("{}.{}", key.name, name.str());
    values[std::string(name.str())] = to_number(full, value, range);
    document_.places->note(path(full),
                           {document_.where(&value, shown(full)), shown(full), value_text(value)});
  }
}

Given TomlReader::to_given(std::string_view name, const toml::node& node, std::string_view wanted) const {
  Given value;
  value.place = {document_.where(&node, shown(name)), shown(name), value_text(node)};
  if (node.is_string()) {
    value.quoted = true;
    value.text = *node.value<std::string>();
  } else if (node.is_number()) {
    value.number = *node.value<double>();
  } else {
    fail(name, node, fmt::format("{} is needed", wanted));
  }
  return value;
}

void TomlReader::given(const Key& key, Given& value, std::string_view wanted) {
  const toml::node* node = find(key, wanted);
  if (node != nullptr) value = to_given(key.name, *node, wanted);
}

void TomlReader::given_list(const Key& key, std::vector<Given>& values, std::string_view wanted) {
  const toml::node* node = find(key, wanted);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->empty()) fail(key.name, *node, fmt::format("{} is needed", wanted));
  values.clear();
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string name = fmt::format("{}.{}", key.name, i);
    values.push_back(to_given(name, (*array)[i], wanted));
    document_.places->note(path(name), values.back().place);
  }
}

void TomlReader::material(const Key& key, Index& index) {
  const toml::node* node = find(key, "the name of a material");
  if (node != nullptr) index = to_material(key.name, *node);
}

void TomlReader::materials(const Key& key, std::array<Index, 2>& indices) {
  const toml::node* node = find(key, "two names of materials");
  if (node == nullptr) return;
  const toml::array& array = to_pair(key.name, *node, "names of materials");
  for (std::size_t i = 0; i < 2; ++i) indices[i] = to_material(fmt::format("{}.{}", key.name, i), array[i]);
}

void TomlReader::table(const Key& key, const Visit& visit) {
  const toml::node* node = find(key, fmt::format("a table [{}]", shown(key.name)));
  if (node != nullptr && !node->is_table())
    fail(key.name, *node, fmt::format("a table is needed: [{}] and its keys", shown(key.name)));
  const bool complete = complete_ || std::exchange(fresh_, false);
  TomlReader inside(document_, node == nullptr ? nullptr : node->as_table(), shown(key.name), path(key.name),
                    complete);
  visit(inside);
  inside.refuse_unknown_keys();
}

void TomlReader::items(const Key& key, std::size_t /*count*/, const std::function<void(std::size_t)>& resize,
                       const VisitItem& visit) {
  const toml::node* node = find(key, fmt::format("tables [[{}]]", shown(key.name)));
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr)
    fail(key.name, *node, fmt::format("a list of tables is needed: [[{}]]", shown(key.name)));
  if (array->empty() && key.required)
    fail(key.name, *node, fmt::format("at least one [[{}]] is needed", shown(key.name)));
  resize(array->size());
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string name = fmt::format("{}.{}", key.name, i);
    const toml::table* item = (*array)[i].as_table();
    if (item == nullptr) fail(name, (*array)[i], fmt::format("a table is needed: [[{}]]", shown(key.name)));
    document_.places->note(path(name), {document_.where(item, shown(name)), shown(name), ""});
    TomlReader inside(document_, item, shown(name), path(name), true);
    visit(inside, i);
    inside.refuse_unknown_keys();
  }
}

bool TomlReader::wants(const Key& key, bool present) {
  know(key.name);
  fresh_ = !present;
  return table_ != nullptr && table_->contains(key.name);
}

}  // namespace tuft::schema

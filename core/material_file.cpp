#include "core/material_file.h"

#include <algorithm>
#include <iterator>

#include "core/error.h"
#include "core/scene_files.h"
#include "core/scene_schema.h"
#include "core/toml_reader.h"
#include "core/units.h"

namespace tuft {
namespace {

using schema::Key;
using schema::KeyVisitor;
using schema::Range;

/// Notes the single numbers that a struct's keys lead to.
class NumberVisitor final : public KeyVisitor {
 public:
  NumberVisitor(std::vector<MaterialNumber>& numbers, std::string path)
      : numbers_(numbers), path_(std::move(path)) {}

  void quantity(const Key& key, double& value, std::string_view unit, const Range& range) override {
    numbers_.push_back(
        {join(key), std::string(unit), value, range.low, range.high, range.low_open, range.high_open});
  }
  void number(const Key& key, double& value, const Range& range) override {
    quantity(key, value, "1", range);
  }
  void whole(const Key&, std::int64_t&, const Range&) override {}
  void flag(const Key&, bool&) override {}
  void toggle(const Key&, Switch&) override {}
  void text(const Key&, std::string&) override {}
  void choice(const Key&, std::string&, Names) override {}
  void quantities(const Key&, std::array<double, 2>&, std::string_view, const Range&) override {}
  void quantity_list(const Key&, std::vector<double>&, std::string_view, const Range&) override {}
  void curve(const Key&, Curve&, const schema::CurveAxes&) override {}
  void numbers_by_name(const Key&, std::map<std::string, double>&, const Range&) override {}
  void given(const Key&, Given&, std::string_view) override {}
  void given_list(const Key&, std::vector<Given>&, std::string_view) override {}
  void material(const Key&, Index&) override {}
  void materials(const Key&, std::array<Index, 2>&) override {}
  void table(const Key& key, const Visit& visit) override {
    NumberVisitor inside(numbers_, join(key));
    visit(inside);
  }
  void items(const Key&, std::size_t, const std::function<void(std::size_t)>&, const VisitItem&) override {}
  bool wants(const Key&, bool present) override { return present; }

 private:
  [[nodiscard]] std::string join(const Key& key) const {
    return path_.empty() ? std::string(key.name) : fmt::format("{}.{}", path_, key.name);
  }
  std::vector<MaterialNumber>& numbers_;
  std::string path_;
};

/// Where a value stands in a text: [begin, end).
struct Span {
  std::size_t begin = 0, end = 0;
};

/// From line and column (in characters, from 1) to a place in the text.
std::size_t offset_of(const std::string& text, const toml::source_position& at) {
  std::size_t place = 0;
  for (std::size_t line = 1; line < at.line; ++line) place = text.find('\n', place) + 1;
  for (std::size_t column = 1; column < at.column; ++column) {
    ++place;
    while (place < text.size() && (static_cast<unsigned char>(text[place]) & 0xC0) == 0x80) ++place;
  }
  return place;
}

Span span_of(const std::string& text, const toml::node& node) {
  Span span{offset_of(text, node.source().begin), 0};
  if (node.is_string())
    span.end = text.find(text[span.begin], span.begin + 1) + 1;  // to the other quote
  else
    span.end = std::min(text.find_first_of(" \t\r\n,}]#", span.begin), text.size());
  return span;
}

/// The value in the unit of the text that it replaces.
std::string value_like(const toml::node& old, const MaterialNumber& number, double value) {
  if (!old.is_string()) return fmt::format("{}", value);
  const std::string text = *old.value<std::string>();
  const std::size_t first = text.find_first_not_of("+-.0123456789eE ");
  const std::string unit = first == std::string::npos ? number.unit : text.substr(first);
  return fmt::format("\"{} {}\"", value / unit_factor(unit, number.unit), unit);
}

/// Puts a comment at the end of the line around `place`.
void set_remark(std::string& text, std::size_t place, const std::string& remark) {
  const std::string first_word = remark.substr(0, remark.find(' '));
  const std::size_t end = std::min(text.find('\n', place), text.size());
  const std::size_t earlier = text.find("  # " + first_word, place);
  if (earlier < end)
    text.replace(earlier, end - earlier, "  # " + remark);
  else
    text.insert(end, "  # " + remark);
}

}  // namespace

MaterialFile read_material_file(const std::filesystem::path& path, const std::string& name) {
  MaterialFile file{path, name, read_text_file(path), {}};
  const toml::table table = schema::parse_toml(file.text, path.string());
  Material material;
  Places places;
  schema::Document document;
  document.file = path.string();
  document.places = &places;
  document.find_material = [](const std::string&, const Place&) { return Index{0}; };
  schema::TomlReader::read(document, table, "", "", true,
                           [&](KeyVisitor& keys) { schema::describe_material(keys, material); });
  NumberVisitor visitor(file.numbers, "");
  schema::describe_material(visitor, material);
  // Only what stands in the text.
  std::erase_if(file.numbers, [&](const MaterialNumber& number) { return !table.at_path(number.key); });
  return file;
}

std::string with_numbers(const MaterialFile& file, const std::map<std::string, double>& values,
                         const std::string& remark) {
  const toml::table table = schema::parse_toml(file.text, file.path.string());
  struct Change {
    Span span;
    std::string text;
  };
  std::vector<Change> changes;
  for (const auto& [key, value] : values) {
    const auto number = std::ranges::find(file.numbers, key, &MaterialNumber::key);
    if (number == file.numbers.end())
      throw_input_error("{}: {}: is no number of this file", file.path.string(), key);
    const toml::node& node = *table.at_path(key).node();
    changes.push_back({span_of(file.text, node), value_like(node, *number, value)});
  }
  // From the end, so that places before stay.
  std::ranges::sort(changes, [](const Change& a, const Change& b) { return a.span.begin > b.span.begin; });
  std::string text = file.text;
  for (const Change& change : changes) {
    if (!remark.empty()) set_remark(text, change.span.end, remark);
    text.replace(change.span.begin, change.span.end - change.span.begin, change.text);
  }
  return text;
}

}  // namespace tuft

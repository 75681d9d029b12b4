/// The reference of the scene language, printed from the declarations that read it.
#include <array>
#include <iterator>

#include "core/error.h"
#include "core/scene_reader.h"
#include "core/scene_schema.h"

namespace tuft::schema {
namespace {

struct Row {
  std::string key, unit, standard, range, meaning;
};

/// Collects one row a key from structs with their default values.
class ReferenceVisitor final : public KeyVisitor {
 public:
  ReferenceVisitor(std::vector<Row>& rows, std::string path) : rows_(rows), path_(std::move(path)) {}

  void quantity(const Key& key, double& value, std::string_view unit, const Range& range) override {
    add(key, unit, fmt::format("{} {}", value, unit), range.in_words());
  }
  void number(const Key& key, double& value, const Range& range) override {
    add(key, "", fmt::format("{}", value), range.in_words());
  }
  void whole(const Key& key, std::int64_t& value, const Range& range) override {
    add(key, "", fmt::format("{}", value), range.in_words());
  }
  void flag(const Key& key, bool& value) override { add(key, "", value ? "true" : "false", "true, false"); }
  void toggle(const Key& key, Switch&) override { add(key, "", "auto", "true, false, auto"); }
  void text(const Key& key, std::string& value) override { add(key, "", fmt::format("\"{}\"", value), ""); }
  void choice(const Key& key, std::string& value, Names names) override {
    add(key, "", value, fmt::format("{}", fmt::join(names, ", ")));
  }
  void quantities(const Key& key, std::array<double, 2>& values, std::string_view unit,
                  const Range& range) override {
    add(key, unit, fmt::format("{} {}, {} {}", values[0], unit, values[1], unit), range.in_words());
  }
  void quantity_list(const Key& key, std::vector<double>& values, std::string_view unit,
                     const Range& range) override {
    std::string list;
    for (const double value : values) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", value, unit);
    add(key, unit, list, range.in_words().empty() ? "a list" : "a list, each " + range.in_words());
  }
  void curve(const Key& key, Curve&, const CurveAxes& axes) override {
    add(key, axes.unit(), "", fmt::format("{{ unit, {}, {} }}", axes.x_name, axes.y_name));
  }
  void numbers_by_name(const Key& key, std::map<std::string, double>&, const Range& range) override {
    add(key, "", "{ }", range.in_words());
  }
  void given(const Key& key, Given&, std::string_view wanted) override {
    add(key, "", "", std::string(wanted));
  }
  void given_list(const Key& key, std::vector<Given>&, std::string_view wanted) override {
    add(key, "", "", std::string(wanted));
  }
  void material(const Key& key, Index&) override { add(key, "", "", "a material"); }
  void materials(const Key& key, std::array<Index, 2>&) override { add(key, "", "", "two materials"); }
  void table(const Key& key, const Visit& visit) override {
    ReferenceVisitor inside(rows_, join(key.name));
    visit(inside);
  }
  void items(const Key& key, std::size_t, const std::function<void(std::size_t)>& resize,
             const VisitItem& visit) override {
    resize(1);
    ReferenceVisitor inside(rows_, join(key.name) + "[]");
    visit(inside, 0);
  }
  bool wants(const Key&, bool) override { return true; }
  [[nodiscard]] bool of_all_rigs() const override { return true; }

 private:
  [[nodiscard]] std::string join(std::string_view name) const {
    return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name);
  }
  void add(const Key& key, std::string_view unit, std::string standard, std::string range) {
    rows_.push_back({join(key.name), std::string(unit), key.required ? "required" : std::move(standard),
                     std::move(range), std::string(key.meaning)});
  }

  std::vector<Row>& rows_;
  std::string path_;
};

std::vector<Row> scene_rows() {
  std::vector<Row> rows;
  Scene scene;
  ReferenceVisitor visitor(rows, "");
  describe_scene(visitor, scene, describe_carpet);
  return rows;
}

std::vector<Row> material_rows() {
  std::vector<Row> rows;
  Material material;
  ReferenceVisitor visitor(rows, "");
  describe_material(visitor, material);
  return rows;
}

std::vector<Row> point_rows() {
  std::vector<Row> rows;
  PointTest test;
  ReferenceVisitor visitor(rows, "");
  describe_point_test(visitor, test);
  return rows;
}

std::vector<Row> calibration_rows() {
  std::vector<Row> rows;
  CalibrationFile calibration;
  ReferenceVisitor visitor(rows, "");
  describe_calibration(visitor, calibration);
  return rows;
}

std::string table_of(const std::vector<Row>& rows) {
  std::string text = "| key | unit | default | range | meaning |\n|---|---|---|---|---|\n";
  for (const Row& row : rows)
    fmt::format_to(std::back_inserter(text), "| `{}` | {} | {} | {} | {} |\n", row.key, row.unit,
                   row.standard, row.range, row.meaning);
  return text;
}

}  // namespace

std::string Range::in_words() const {
  std::string words;
  if (low != -unbounded) words = fmt::format("{} {}", low_open ? "above" : "at least", low);
  if (high != unbounded)
    words += fmt::format("{}{} {}", words.empty() ? "" : " and ", high_open ? "below" : "at most", high);
  return words;
}

std::vector<std::string> known_keys() {
  std::vector<std::string> keys;
  for (const Row& row : scene_rows()) keys.push_back(row.key);
  return keys;
}

}  // namespace tuft::schema

namespace tuft {

std::string scene_reference() {
  return "## Scene\n\n" + schema::table_of(schema::scene_rows()) +
         "\n## Turf design (`turfs/NAME.toml`)\n\nA table `[carpet]` with the keys of `turf.carpet` "
         "above.\n" +
         "\n## Material (`materials/NAME.toml`, or a table `[materials.NAME]` in the scene)\n\n" +
         schema::table_of(schema::material_rows()) +
         "\n## Test of a material point (`tuft point`)\n\nMaterials as in a scene.\n\n" +
         schema::table_of(schema::point_rows()) + "\n## Calibration (`tuft calibrate`)\n\n" +
         schema::table_of(schema::calibration_rows());
}

}  // namespace tuft

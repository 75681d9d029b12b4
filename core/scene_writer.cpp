/// Writing a scene as TOML: every key, everything inline, doubles with as many digits as bring back the same
/// bits.
#include <iterator>

#include "core/error.h"
#include "core/scene_layout.h"
#include "core/scene_reader.h"
#include "core/scene_schema.h"

namespace tuft {
namespace {

using schema::CurveAxes;
using schema::Key;
using schema::KeyVisitor;
using schema::Range;

std::string in_quotes(std::string_view text) {
  std::string result = "\"";
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\')
      result += {'\\', letter};
    else if (code < 0x20 || code == 0x7f)
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(code));
    else
      result += letter;
  }
  return result + "\"";
}

/// A key as TOML wants it: bare where it can be.
std::string key_text(std::string_view name) {
  const bool bare = !name.empty() && name.find_first_not_of(
                                         "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                         "0123456789_-") == std::string_view::npos;
  return bare ? std::string(name) : in_quotes(name);
}

std::string list_text(const std::vector<double>& values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

class TomlWriter final : public KeyVisitor {
 public:
  TomlWriter(std::string& text, std::string path, const std::vector<Material>& known)
      : text_(text), path_(std::move(path)), known_(known) {}

  void quantity(const Key& key, double& value, std::string_view unit, const Range&) override {
    line(key, fmt::format("\"{} {}\"", value, unit));
  }
  void number(const Key& key, double& value, const Range&) override { line(key, fmt::format("{}", value)); }
  void whole(const Key& key, std::int64_t& value, const Range&) override {
    line(key, fmt::format("{}", value));
  }
  void flag(const Key& key, bool& value) override { line(key, value ? "true" : "false"); }
  void toggle(const Key& key, Switch& value) override {
    line(key, value == Switch::automatic ? "\"auto\"" : (value == Switch::on ? "true" : "false"));
  }
  void text(const Key& key, std::string& value) override { line(key, in_quotes(value)); }
  void choice(const Key& key, std::string& value, Names) override { line(key, in_quotes(value)); }
  void quantities(const Key& key, std::array<double, 2>& values, std::string_view unit,
                  const Range&) override {
    line(key, fmt::format("[\"{} {}\", \"{} {}\"]", values[0], unit, values[1], unit));
  }
  void quantity_list(const Key& key, std::vector<double>& values, std::string_view unit,
                     const Range&) override {
    std::string list;
    for (const double value : values)
      list += fmt::format("{}\"{} {}\"", list.empty() ? "" : ", ", value, unit);
    line(key, fmt::format("[{}]", list));
  }
  void curve(const Key& key, Curve& curve, const CurveAxes& axes) override {
    if (curve.x.empty()) return;  // another key stands in its place
    const std::string_view unit = axes.unit();
    line(key, fmt::format("{{ unit = \"{}\", {} = {}, {} = {} }}", unit, axes.x_name, list_text(curve.x),
                          axes.y_name, list_text(curve.y)));
  }
  void numbers_by_name(const Key& key, std::map<std::string, double>& values, const Range&) override {
    std::string inside;
    for (const auto& [name, value] : values)
      inside += fmt::format("{} {} = {}", inside.empty() ? "" : ",", key_text(name), value);
    line(key, fmt::format("{{{} }}", inside));
  }
  void given(const Key& key, Given& value, std::string_view) override {
    if (value.is_given()) line(key, text_of(value));
  }
  void given_list(const Key& key, std::vector<Given>& values, std::string_view) override {
    std::string list;
    for (const Given& value : values) list += fmt::format("{}{}", list.empty() ? "" : ", ", text_of(value));
    if (!values.empty()) line(key, fmt::format("[{}]", list));
  }
  void material(const Key& key, Index& index) override { line(key, in_quotes(name_of(index))); }
  void materials(const Key& key, std::array<Index, 2>& indices) override {
    line(key, fmt::format("[{}, {}]", in_quotes(name_of(indices[0])), in_quotes(name_of(indices[1]))));
  }
  void table(const Key& key, const Visit& visit) override {
    const std::string path = join(key.name);
    fmt::format_to(std::back_inserter(text_), "\n[{}]\n", path);
    TomlWriter inside(text_, path, known_);
    visit(inside);
  }
  void items(const Key& key, std::size_t count, const std::function<void(std::size_t)>&,
             const VisitItem& visit) override {
    const std::string path = join(key.name);
    for (std::size_t i = 0; i < count; ++i) {
      fmt::format_to(std::back_inserter(text_), "\n[[{}]]\n", path);
      TomlWriter inside(text_, path, known_);
      visit(inside, i);
    }
  }
  bool wants(const Key&, bool present) override { return present; }

 private:
  static std::string text_of(const Given& value) {
    return value.quoted ? in_quotes(value.text) : fmt::format("{}", value.number);
  }
  /// Before the tables inside this one: after their headers a line would belong to them.
  void line(const Key& key, const std::string& value) {
    const std::string text = fmt::format("{} = {}\n", key_text(key.name), value);
    text_.insert(end_of_lines_, text);
    end_of_lines_ += text.size();
  }
  [[nodiscard]] std::string join(std::string_view name) const {
    return path_.empty() ? key_text(name) : fmt::format("{}.{}", path_, key_text(name));
  }
  [[nodiscard]] const std::string& name_of(Index index) const {
    return known_[static_cast<std::size_t>(index)].name;
  }

  std::string& text_;
  std::size_t end_of_lines_ = text_.size();
  std::string path_;
  const std::vector<Material>& known_;
};

/// All materials, each in a table of its own.
void write_materials(TomlWriter& writer, std::vector<Material>& materials) {
  writer.table({materials_key, ""}, [&materials](KeyVisitor& keys) {
    for (Material& material : materials) {
      keys.table({material.name, ""}, [&material](KeyVisitor& inside) {
        inside.text({origin_key, ""}, material.file);
        schema::describe_material(inside, material);
      });
    }
  });
}

}  // namespace

std::string write_scene(const Scene& scene) {
  Scene copy = scene;  // visitors take references that they may write to
  std::string text =
      "# A scene as resolved: every default written out, nothing read from other files. SI units.\n";
  TomlWriter writer(text, "", copy.materials);
  schema::describe_scene(writer, copy, [&copy](KeyVisitor& keys, CarpetDesign& carpet) {
    keys.text({origin_key, ""}, copy.turf.design);
    schema::describe_carpet(keys, carpet);
  });
  write_materials(writer, copy.materials);
  return text;
}

std::string write_point_test(const PointTest& test) {
  PointTest copy = test;
  std::string text =
      "# A test of a material point as resolved: every default written out, nothing read from other files. "
      "SI "
      "units.\n";
  TomlWriter writer(text, "", copy.materials);
  schema::describe_point_test(writer, copy);
  write_materials(writer, copy.materials);
  return text;
}

}  // namespace tuft

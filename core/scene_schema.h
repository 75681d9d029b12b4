#pragma once
/// The scene language: every key declared once, with unit, range and meaning. A `describe` function walks a
/// struct's keys with a visitor; one visitor reads TOML, one writes it, one prints the reference. Defaults
/// are the values that the structs of core/scene.h are born with.
#include <concepts>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/calibration_file.h"
#include "core/given_value.h"
#include "core/point_test.h"
#include "core/scene.h"

namespace tuft::schema {

/// Allowed values in SI units.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false, high_open = false;

  [[nodiscard]] bool holds(double value) const {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
  }
  /// "above 0 and at most 1"; empty when everything is allowed.
  [[nodiscard]] std::string in_words() const;
};

inline constexpr double unbounded = std::numeric_limits<double>::infinity();
inline constexpr Range any{};
inline constexpr Range positive{0, unbounded, true, false};
inline constexpr Range non_negative{0, unbounded, false, false};
inline constexpr Range at_least_one{1, unbounded, false, false};
inline constexpr Range share{0, 1, true, false};       ///< (0, 1]
inline constexpr Range liggghts_restitution{0.05, 1};  ///< LIGGGHTS takes no other

struct Key {
  std::string_view name, meaning;
  bool required = false;
};
constexpr Key required(std::string_view name, std::string_view meaning) {
  return {name, meaning, true};
}

/// Names and units of the two rows of numbers of a curve. An axis without unit is dimensionless; one has a
/// unit, and where both do it is the same.
struct CurveAxes {
  std::string_view x_name, x_unit, y_name, y_unit;
  Range y_range;
  [[nodiscard]] std::string_view unit() const { return y_unit.empty() ? x_unit : y_unit; }
};

/// Walks over keys. References may be written to (reading) or only looked at.
class KeyVisitor {
 public:
  KeyVisitor() = default;
  KeyVisitor(const KeyVisitor&) = delete;
  KeyVisitor& operator=(const KeyVisitor&) = delete;
  virtual ~KeyVisitor() = default;

  using Visit = std::function<void(KeyVisitor&)>;
  using VisitItem = std::function<void(KeyVisitor&, std::size_t)>;
  using Names = std::span<const std::string_view>;

  virtual void quantity(const Key& key, double& value, std::string_view unit, const Range& range) = 0;
  virtual void number(const Key& key, double& value, const Range& range) = 0;
  virtual void whole(const Key& key, std::int64_t& value, const Range& range) = 0;
  virtual void flag(const Key& key, bool& value) = 0;
  virtual void toggle(const Key& key, Switch& value) = 0;
  virtual void text(const Key& key, std::string& value) = 0;
  virtual void choice(const Key& key, std::string& value, Names names) = 0;
  virtual void quantities(const Key& key, std::array<double, 2>& values, std::string_view unit,
                          const Range& range) = 0;
  /// One quantity or more.
  virtual void quantity_list(const Key& key, std::vector<double>& values, std::string_view unit,
                             const Range& range) = 0;
  virtual void curve(const Key& key, Curve& curve, const CurveAxes& axes) = 0;
  virtual void numbers_by_name(const Key& key, std::map<std::string, double>& values, const Range& range) = 0;
  /// A value whose unit is known only after reading; `wanted` says in words what it is.
  virtual void given(const Key& key, Given& value, std::string_view wanted) = 0;
  /// One or more of them.
  virtual void given_list(const Key& key, std::vector<Given>& values, std::string_view wanted) = 0;
  /// A material, by name in files and by index in structs.
  virtual void material(const Key& key, Index& index) = 0;
  virtual void materials(const Key& key, std::array<Index, 2>& indices) = 0;
  virtual void table(const Key& key, const Visit& visit) = 0;
  virtual void items(const Key& key, std::size_t count, const std::function<void(std::size_t)>& resize,
                     const VisitItem& visit) = 0;
  /// Whether an optional table is to be visited.
  virtual bool wants(const Key& key, bool present) = 0;
  /// Whether to visit the keys of every rig, not only those of the rig at hand.
  [[nodiscard]] virtual bool of_all_rigs() const { return false; }

  template <std::integral T>
  void integer(const Key& key, T& value, const Range& range) {
    auto wide = static_cast<std::int64_t>(value);
    whole(key, wide, range);
    value = static_cast<T>(wide);
  }
  /// An enum whose values count up from 0 in the order of `names`.
  template <class Enum>
  void enumeration(const Key& key, Enum& value, Names names) {
    std::string name(names[static_cast<std::size_t>(value)]);
    choice(key, name, names);
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) value = static_cast<Enum>(i);
  }
  template <class T>
  void optional_table(const Key& key, std::optional<T>& value,
                      const std::function<void(KeyVisitor&, T&)>& visit) {
    if (!wants(key, value.has_value())) return;
    if (!value) value.emplace();
    table(key, [&](KeyVisitor& inside) { visit(inside, *value); });
  }
  void optional_quantity(const Key& key, std::optional<double>& value, std::string_view unit,
                         const Range& range) {
    if (!wants(key, value.has_value())) return;
    if (!value) value = 0;
    quantity(key, *value, unit, range);
  }
  void optional_number(const Key& key, std::optional<double>& value, const Range& range) {
    if (!wants(key, value.has_value())) return;
    if (!value) value = 0;
    number(key, *value, range);
  }
  template <class T>
  void list(const Key& key, std::vector<T>& values, const std::function<void(KeyVisitor&, T&)>& visit) {
    items(
        key, values.size(), [&](std::size_t count) { values.assign(count, T{}); },
        [&](KeyVisitor& inside, std::size_t i) { visit(inside, values[i]); });
  }
};

/// Everything but materials and carpet; `describe_scene` of a file that names a design leaves the carpet out.
void describe_scene(KeyVisitor& keys, Scene& scene,
                    const std::function<void(KeyVisitor&, CarpetDesign&)>& carpet);
void describe_carpet(KeyVisitor& keys, CarpetDesign& carpet);
void describe_material(KeyVisitor& keys, Material& material);
void describe_friction(KeyVisitor& keys, FrictionLaw& law);
void describe_infill(KeyVisitor& keys, InfillChoice& infill);
void describe_rig(KeyVisitor& keys, Rig& rig);
void describe_effects(KeyVisitor& keys, Effects& effects);
/// What a rig loads: a filled carpet, the carpet's material alone, infill alone.
enum class RigKind { turf, component, specimen };
void describe_numerics(KeyVisitor& keys, Numerics& numerics, RigKind kind);
void describe_output(KeyVisitor& keys, Output& output, RigKind kind);
/// Everything of a point test but its materials.
void describe_point_test(KeyVisitor& keys, PointTest& test);

void describe_calibration(KeyVisitor& keys, CalibrationFile& calibration);

/// Every key of a scene, in full ("infill.sph.pitch"; an item of a list as "turf.layers[].depth").
[[nodiscard]] std::vector<std::string> known_keys();

}  // namespace tuft::schema

#pragma once
/// The visitor that reads TOML strictly: unknown keys, wrong types, units and ranges are InputErrors with
/// their place.
#include <toml++/toml.h>
#include <functional>
#include <string>
#include <vector>

#include "core/scene_places.h"
#include "core/scene_schema.h"

namespace tuft::schema {

/// Parses a TOML text; `file` is named in messages. Throws InputError with the line.
[[nodiscard]] toml::table parse_toml(const std::string& text, const std::string& file);

/// What all tables of one document share.
struct Document {
  std::string file;                     ///< for messages
  Places* places = nullptr;             ///< every key read is noted here
  std::vector<std::string> overridden;  ///< keys that --set gave
  bool of_scene = true;  ///< keys of scenes that do not belong here are told from mistyped ones
  /// Index of a material by name, reading its file when need be; `place` is for messages.
  std::function<Index(const std::string& name, const Place& place)> find_material;
  std::vector<std::string> missing;  ///< messages; raised after all keys were seen, so that a mistyped key is
                                     ///< reported as such and not as missing

  [[nodiscard]] std::string where(const toml::node* node, const std::string& key) const;
};

class TomlReader final : public KeyVisitor {
 public:
  /// `shown` is the path of the table as the user wrote it, `path` its place in the scene. A table that was
  /// left out is a null pointer. Without `complete` required keys may be missing: their values are there
  /// already.
  TomlReader(Document& document, const toml::table* table, std::string shown, std::string path,
             bool complete = true)
      : document_(document),
        table_(table),
        shown_(std::move(shown)),
        path_(std::move(path)),
        complete_(complete) {}

  /// Visits, then refuses keys that nobody asked for, then missing ones.
  static void read(Document& document, const toml::table& table, const std::string& shown,
                   const std::string& path, bool complete, const Visit& visit);
  /// A key of this table that is read elsewhere.
  void know(std::string_view name);
  void refuse_unknown_keys() const;
  [[nodiscard]] bool has(std::string_view name) const { return table_ != nullptr && table_->contains(name); }
  /// Keys that are missing from here on have values already.
  void accept_incomplete() { complete_ = false; }

  void quantity(const Key& key, double& value, std::string_view unit, const Range& range) override;
  void number(const Key& key, double& value, const Range& range) override;
  void whole(const Key& key, std::int64_t& value, const Range& range) override;
  void flag(const Key& key, bool& value) override;
  void toggle(const Key& key, Switch& value) override;
  void text(const Key& key, std::string& value) override;
  void choice(const Key& key, std::string& value, Names names) override;
  void quantities(const Key& key, std::array<double, 2>& values, std::string_view unit,
                  const Range& range) override;
  void quantity_list(const Key& key, std::vector<double>& values, std::string_view unit,
                     const Range& range) override;
  void curve(const Key& key, Curve& curve, const CurveAxes& axes) override;
  void numbers_by_name(const Key& key, std::map<std::string, double>& values, const Range& range) override;
  void given(const Key& key, Given& value, std::string_view wanted) override;
  void given_list(const Key& key, std::vector<Given>& values, std::string_view wanted) override;
  void material(const Key& key, Index& index) override;
  void materials(const Key& key, std::array<Index, 2>& indices) override;
  void table(const Key& key, const Visit& visit) override;
  void items(const Key& key, std::size_t count, const std::function<void(std::size_t)>& resize,
             const VisitItem& visit) override;
  bool wants(const Key& key, bool present) override;

 private:
  /// The node of a key, noted as known; null where it was left out.
  const toml::node* find(const Key& key, std::string_view wanted);
  [[nodiscard]] std::string shown(std::string_view name) const;
  [[nodiscard]] std::string path(std::string_view name) const;
  [[noreturn]] void fail(std::string_view name, const toml::node& node, std::string_view problem) const;
  [[nodiscard]] double to_quantity(std::string_view name, const toml::node& node, std::string_view unit,
                                   const Range& range) const;
  [[nodiscard]] double to_number(std::string_view name, const toml::node& node, const Range& range) const;
  [[nodiscard]] Given to_given(std::string_view name, const toml::node& node, std::string_view wanted) const;
  [[nodiscard]] std::string to_text(std::string_view name, const toml::node& node) const;
  [[nodiscard]] Index to_material(std::string_view name, const toml::node& node) const;
  const toml::array& to_pair(std::string_view name, const toml::node& node, std::string_view of) const;

  Document& document_;
  const toml::table* table_;
  std::string shown_, path_;
  bool complete_;
  bool fresh_ = false;  ///< the optional table about to be visited had no values before
  std::vector<std::string> known_;
};

/// A value as text for messages; long ones shortened.
[[nodiscard]] std::string value_text(const toml::node& node);

}  // namespace tuft::schema

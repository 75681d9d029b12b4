#pragma once
/// Where each key of a scene was written, for messages after reading.
#include <map>
#include <string>
#include <string_view>

namespace tuft {

/// One line for the user: where, key, value, what is wrong and what to do.
[[noreturn]] void throw_bad_key(std::string_view where, std::string_view key, std::string_view value,
                                std::string_view problem);

struct Place {
  std::string where;  ///< "file:line", "file", or "--set"
  std::string key;    ///< as the user wrote it
  std::string value;  ///< as the user wrote it
};

class Places {
 public:
  void note(const std::string& path, Place place) { places_[path] = std::move(place); }
  /// Whether the key was written somewhere.
  [[nodiscard]] bool has(const std::string& path) const { return places_.contains(path); }
  /// Place of a key. Of one that was left out: that of the nearest table around it, with no value.
  [[nodiscard]] Place find(const std::string& path) const;
  [[noreturn]] void fail(const std::string& path, std::string_view problem) const;

 private:
  std::map<std::string, Place> places_;  // by full path in the scene
};

}  // namespace tuft

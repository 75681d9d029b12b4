#include "core/scene_overrides.h"

#include <charconv>

#include "core/error.h"
#include "core/scene_places.h"
#include "core/toml_reader.h"

namespace tuft {
namespace {

std::vector<std::string> split_path(const std::string& key) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t dot = key.find('.'); dot != std::string::npos; dot = key.find('.', begin)) {
    parts.push_back(key.substr(begin, dot - begin));
    begin = dot + 1;
  }
  parts.push_back(key.substr(begin));
  return parts;
}

/// The text as a TOML value, or as it stands.
toml::table parse_value(const std::string& text) {
  try {
    toml::table parsed = toml::parse("v = " + text);
    if (parsed.size() == 1 && parsed.contains("v")) return parsed;
  } catch (const toml::parse_error&) {
    // no TOML: plain text
  }
  return toml::table{{"v", text}};
}

/// The child of a table or list that a part of a path names; tables that are not there yet are made.
toml::node& step_into(toml::node& around, const std::string& part, const std::string& key) {
  if (toml::table* table = around.as_table(); table != nullptr) {
    if (!table->contains(part)) table->insert(part, toml::table{});
    return *table->get(part);
  }
  if (toml::array* array = around.as_array(); array != nullptr) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
    if (error != std::errc() || end != part.data() + part.size() || index >= array->size())
      throw_bad_key("--set", key, "",
                    fmt::format("no item {}: the list has {}, counted from 0", part, array->size()));
    return *array->get(index);
  }
  throw_bad_key("--set", key, "",
                fmt::format("nothing lies below this key: its value is {}", schema::value_text(around)));
}

void put(toml::node& around, const std::string& part, toml::node&& value, const std::string& key) {
  value.visit([&](auto&& typed) {
    if (toml::table* table = around.as_table(); table != nullptr) {
      table->insert_or_assign(part, std::move(typed));
      return;
    }
    step_into(around, part, key);  // checks the index
    std::size_t index = 0;
    std::from_chars(part.data(), part.data() + part.size(), index);
    toml::array& array = *around.as_array();
    array.replace(array.cbegin() + static_cast<std::ptrdiff_t>(index), std::move(typed));
  });
}

}  // namespace

std::vector<std::string> apply_overrides(toml::table& scene, const Overrides& overrides) {
  std::vector<std::string> keys;
  for (const auto& [key, text] : overrides) {
    const std::vector<std::string> parts = split_path(key);
    for (const std::string& part : parts)
      if (part.empty())
        throw_bad_key("--set", fmt::format("\"{}\"", key), "", "is no key; write --set table.key=value");
    toml::node* around = &scene;
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) around = &step_into(*around, parts[i], key);
    toml::table value = parse_value(text);
    put(*around, parts.back(), std::move(*value.get("v")), key);
    keys.push_back(key);
  }
  return keys;
}

}  // namespace tuft

#include "core/scene_places.h"

#include <algorithm>

#include "core/error.h"

namespace tuft {

void throw_bad_key(std::string_view where, std::string_view key, std::string_view value,
                   std::string_view problem) {
  std::string line = value.empty() ? fmt::format("{}: {}: {}", where, key, problem)
                                   : fmt::format("{}: {}: {}: {}", where, key, value, problem);
  // The user's own text may hold anything; the message stays one line.
  std::replace_if(
      line.begin(), line.end(), [](unsigned char letter) { return letter < 0x20; }, ' ');
  throw InputError(line);
}

Place Places::find(const std::string& path) const {
  if (const auto found = places_.find(path); found != places_.end()) return found->second;
  for (std::string around = path; !around.empty();) {
    const std::size_t dot = around.rfind('.');
    around = dot == std::string::npos ? std::string() : around.substr(0, dot);
    if (const auto found = places_.find(around); found != places_.end())
      return {found->second.where, path, ""};
  }
  return {"scene", path, ""};
}

void Places::fail(const std::string& path, std::string_view problem) const {
  const Place place = find(path);
  throw_bad_key(place.where, place.key, place.value, problem);
}

}  // namespace tuft

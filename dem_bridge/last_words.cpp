#include "dem_bridge/last_words.h"

#include <algorithm>
#include <sstream>

namespace tuft::dem {
namespace {

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  return text.substr(std::min(text.size(), text.find_first_not_of(' ')), 400);
}

}  // namespace

std::string error_line(const std::string& text) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (line.find("ERROR") != std::string::npos) return one_line(line);
  return {};
}

std::string telling_line(const std::string& text) {
  std::string last = error_line(text);
  if (!last.empty()) return last;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    if (line.find_first_not_of(" \t\r-=*") != std::string::npos) last = line;
  return one_line(last);
}

}  // namespace tuft::dem

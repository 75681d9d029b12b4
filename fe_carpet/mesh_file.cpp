#include "fe_carpet/mesh_file.h"

#include <charconv>
#include <cmath>

#include "core/error.h"

namespace tuft::fe {
namespace {

std::string_view without_plus(std::string_view text) {
  // std::from_chars knows no leading plus; "+-1" must stay wrong.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  return text;
}

}  // namespace

std::string printable(std::string_view text) {
  constexpr std::size_t longest = 60;
  std::string result(text.substr(0, longest));
  for (char& letter : result)
    if (static_cast<unsigned char>(letter) < 0x20 || static_cast<unsigned char>(letter) > 0x7e) letter = '?';
  return text.size() > longest ? result + "..." : result;
}

void fail_in_mesh_file(const std::string& file, std::size_t line, std::string_view problem,
                       std::string_view value, std::string_view advice) {
  const std::string found = value.empty() ? std::string() : fmt::format(": '{}'", printable(value));
  throw_input_error("{}:{}: {}{}; {}", file, line, problem, found, advice);
}

std::optional<FileId> whole_number(std::string_view text) {
  text = without_plus(text);
  FileId value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<double> real_number(std::string_view text) {
  std::string plain(without_plus(text));
  for (char& letter : plain)
    if (letter == 'd' || letter == 'D') letter = 'e';
  double value = 0;
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (error != std::errc() || end != plain.data() + plain.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::string in_lower_case(std::string_view text) {
  std::string result(text);
  for (char& letter : result)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return result;
}

}  // namespace tuft::fe
